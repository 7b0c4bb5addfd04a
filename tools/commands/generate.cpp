// generate.cpp: `pagoda generate KIND -o MESH`: test models of any size.
#include "ooc/base/error.h"
#include "ooc/writers/mesh_writer.h"
#include "tools/generate/generator.h"
#include "tools/generate/scene_report.h"
#include "tools/session.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda generate --list
  pagoda generate powerplant -o plant.glb
  pagoda generate torus -o torus.ply --triangles 10000000 --seed 7
  pagoda generate interior -o interior.obj --report

The kind of file follows its extension: .ply, .obj, .glb or .stl. Objects, materials and glass
survive in .obj and .glb. Metres, z up (a .glb is turned to y up, as glTF asks).
--report keeps the whole model in memory (44 bytes a triangle) to measure it.)";

struct Arguments {
    std::string kind, target;
    uint64_t triangles = 0, seed = 1;
    bool force = false, report = false, json = false, list = false;
};

// To the file, to the progress line and, for a report, into memory.
class GenerateSink final : public ooc::TriangleSink {
public:
    GenerateSink(ooc::MeshWriter& writer, CollectedScene* copy, Progress& progress)
        : writer_(writer), copy_(copy), progress_(progress) {}

    uint32_t addObject(const ooc::ObjectInfo& object) override {
        if (copy_ != nullptr) copy_->addObject(object);
        return writer_.addObject(object);
    }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override {
        if (copy_ != nullptr) copy_->addMaterial(material);
        return writer_.addMaterial(material);
    }
    void addTriangles(const ooc::TriangleBatch& batch) override {
        progress_.check();
        if (copy_ != nullptr) copy_->addTriangles(batch);
        writer_.addTriangles(batch);
        triangles += batch.triangleCount();
        progress_.advance(batch.triangleCount());
    }
    void dropped(ooc::DropReason, uint64_t) override {}
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t) override {}

    uint64_t triangles = 0;

private:
    ooc::MeshWriter& writer_;
    CollectedScene* copy_;
    Progress& progress_;
};

void printList() {
    for (const Generator& each : generators()) {
        std::cout << fmt::format("{:<12}{} ({} triangles unless told)\n", each.name,
                                 each.description, formatCount(each.defaultTriangles));
    }
}

void generate(const Arguments& arguments, Session& session) {
    const Generator* generator = findGenerator(arguments.kind);
    const GenerateOptions options{
        .triangles = arguments.triangles > 0 ? arguments.triangles : generator->defaultTriangles,
        .seed = arguments.seed};
    const auto writer = ooc::MeshWriter::create(arguments.target, arguments.force, ooc::UpAxis::Z);
    CollectedScene copy;
    const bool measures = arguments.report || arguments.json;
    GenerateSink sink(*writer, measures ? &copy : nullptr, *session.progress);
    session.progress->beginStage("generate", options.triangles, "triangles");
    const SceneViews views = generator->generate(sink, options);
    const uint64_t bytes = writer->finish();
    if (!measures) {
        std::cout << fmt::format("{}: {} triangles, {}\n", arguments.target,
                                 formatCount(sink.triangles), formatBytes(bytes));
        return;
    }
    session.progress->beginStage("measure", 0, "");
    const SceneReport report = measureScene(copy, views);
    std::cout << (arguments.json ? reportJson(report) : reportText(report));
}

}  // namespace

void addGenerateCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand("generate", "Write a test model of any size");
    command->footer(kExamples);
    command->add_option("kind", arguments->kind, "What to make: see --list");
    command->add_option("-o,--output", arguments->target, "The mesh to write");
    command->add_option("--triangles", arguments->triangles, "How many, within 5%")
        ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 33));
    command->add_option("--seed", arguments->seed, "Another seed, another model of the kind");
    command->add_flag("--report", arguments->report, "Measure the model and print its figures");
    command->add_flag("--json", arguments->json, "The report as JSON");
    command->add_flag("--force", arguments->force, "Replace an existing file");
    command->add_flag("--list", arguments->list, "Print the kinds");
    command->callback([arguments, &session] {
        if (arguments->list) return printList();
        if (arguments->kind.empty()) throw CLI::RequiredError("kind");
        if (arguments->target.empty()) throw CLI::RequiredError("--output");
        if (findGenerator(arguments->kind) == nullptr) {
            throw CLI::ValidationError(
                "kind", "no generator named " + arguments->kind + "; --list names them all");
        }
        generate(*arguments, session);
    });
}

}  // namespace pagoda::tools
