#include "hlod/build/build.h"
#include "ooc/base/error.h"
#include "tools/session.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <fstream>
#include <iostream>
#include <memory>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda build scan.ply -o scan.pagoda
  pagoda build hall.glb pipes.obj@up=z,unit=mm,move=0:0:4.5 -o plant.pagoda
  pagoda build parts/ 'more/*.stl' -o all.pagoda --memory 4GiB --report build.json

INPUT is a file, a folder or a quoted glob, with an optional suffix
  @up=y|z,unit=FACTOR|mm|cm|m|km|in|ft,move=X:Y:Z,matrix=16 numbers by row
Kinds: PLY, OBJ, STL, OFF, glTF, GLB, Draco (.drc).)";

struct Arguments {
    std::vector<std::string> inputs;
    std::string target, memory = "1GiB", scratch, codec = "meshopt", up, report;
    double precision = 0;
    uint32_t threads = 0, nodeTriangles = 4096;
    uint64_t maxTriangles = uint64_t{1} << 33;
    bool force = false;
};

hlod::BuildOptions toOptions(const Arguments& arguments) {
    hlod::BuildOptions options;
    options.inputs = hlod::expandInputs(arguments.inputs);
    options.target = arguments.target;
    options.force = arguments.force;
    options.memoryBytes = parseBytes(arguments.memory);
    options.threads = arguments.threads;
    options.scratchFolder = arguments.scratch;
    if (arguments.precision > 0) options.precisionModelUnits = arguments.precision;
    options.codec = *ooc::codecByName(arguments.codec);
    options.nodeTriangles = arguments.nodeTriangles;
    options.maxTriangles = arguments.maxTriangles;
    if (!arguments.up.empty())
        options.upAxis = arguments.up == "y" ? ooc::UpAxis::Y : ooc::UpAxis::Z;
    return options;
}

void printSummary(const hlod::BuildReport& report, const std::string& target) {
    std::cout << fmt::format(
        "{}: {} triangles in {} nodes, {} levels, {} ({:.2f} bytes a triangle)\n", target,
        formatCount(report.triangles), formatCount(report.nodes), report.levels.size(),
        formatBytes(report.fileBytes),
        static_cast<double>(report.fileBytes) / static_cast<double>(report.triangles));
    for (const auto& [reason, count] : report.dropped) {
        std::cout << fmt::format("dropped: {} ({})\n", formatCount(count), reason);
    }
    for (const auto& [what, count] : report.ignored) {
        std::cout << fmt::format("ignored: {} ({})\n", formatCount(count), what);
    }
    if (report.sloppyNodes > 0) {
        std::cout << fmt::format("clustered (parts could not merge, not closed): {} of {} nodes\n",
                                 formatCount(report.sloppyNodes), formatCount(report.nodes));
    }
}

void writeReport(const hlod::BuildReport& report, const std::string& path) {
    std::ofstream out(path, std::ios::trunc);
    out << hlod::toJson(report) << '\n';
    if (!out.flush())
        throw Error(path, "", "cannot write the report", "check the path and the disk");
}

}  // namespace

void addBuildCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand("build", "Make a database from mesh files");
    command->footer(kExamples);
    command->add_option("inputs", arguments->inputs, "Files, folders or globs")->required();
    command->add_option("-o,--output", arguments->target, "The database to make (NAME.pagoda)")
        ->required();
    command->add_flag("--force", arguments->force, "Replace an existing target");
    command
        ->add_option("--memory", arguments->memory,
                     "Private memory to stay within (256MiB or more)")
        ->capture_default_str();
    command->add_option("--threads", arguments->threads, "Workers (0: one a core)")
        ->capture_default_str();
    command->add_option("--scratch", arguments->scratch,
                        "Folder for temporary files (default: the target's)");
    command->add_option("--precision", arguments->precision,
                        "Lattice step in model units, rounded down to a power of two (default: "
                        "from extent and detail)");
    command->add_option("--codec", arguments->codec, "How pages are packed")
        ->check(CLI::IsMember({"meshopt", "draco", "raw"}))
        ->capture_default_str();
    command
        ->add_option("--node-triangles", arguments->nodeTriangles,
                     "The most triangles a node holds")
        ->check(CLI::Range(64u, 21845u))
        ->capture_default_str();
    command
        ->add_option("--max-triangles", arguments->maxTriangles,
                     "Refuse inputs that expand beyond this")
        ->capture_default_str();
    command
        ->add_option("--up", arguments->up,
                     "Up axis of the database (default: the first input's, else z)")
        ->check(CLI::IsMember({"y", "z"}));
    command->add_option("--report", arguments->report,
                        "Write stage times, bytes, peaks and counts as JSON");
    command->callback([arguments, &session] {
        const hlod::BuildReport report =
            hlod::buildDatabase(toOptions(*arguments), *session.progress);
        printSummary(report, arguments->target);
        if (!arguments->report.empty()) writeReport(report, arguments->report);
    });
}

}  // namespace pagoda::tools
