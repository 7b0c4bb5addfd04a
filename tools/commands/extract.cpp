// extract.cpp: `pagoda extract DB -o MESH`: a cut of the hierarchy as a mesh file.
#include "hlod/view/camera.h"
#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "ooc/writers/mesh_writer.h"
#include "tools/session.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda extract plant.pagoda -o plant.glb
  pagoda extract scan.pagoda -o small.ply --triangles 200000
  pagoda extract city.pagoda -o near.obj --tau 1 --camera '{"eye":[0,-40,12],"target":[0,0,5]}'
  pagoda extract hall.pagoda -o corner.stl --box 0,0,0,10,10,4

Without --error, --triangles, --level or --tau: full resolution. --box keeps the triangles whose own
box meets it, whole. Names and materials survive in .glb and .obj. One page is in memory at a time.)";

constexpr size_t kMaxShownFaults = 10;

struct Arguments {
    std::string database, target, camera;
    std::vector<double> box;
    double tauPx = 0, error = 0;
    uint64_t triangles = 0;
    int level = -1;
    bool force = false, json = false;
};

// Which nodes stand for what is below them. All that is set must be met.
struct CutRule {
    std::optional<double> maxError;  // model units
    std::optional<int> maxLevel;     // steps below the root
    std::optional<double> tauPx;
    std::optional<hlod::View> view;
    std::optional<Box3d> box;  // model units

    // Steps below the root in the tree that is drawn: extra leaves are children of their cell.
    [[nodiscard]] static int levelOf(const ooc::NodeRecord& node) {
        return node.id.depth() + (node.id.slot() != 0 ? 1 : 0);
    }
    [[nodiscard]] bool isDrawn(const ooc::NodeRecord& node, const ooc::Lattice& lattice) const {
        if (node.isLeaf()) return true;
        if (maxLevel && levelOf(node) >= *maxLevel) return true;
        if (maxError && node.errorModelUnits <= *maxError) return true;
        return view && view->ssePx(node.errorModelUnits, lattice.toModel(node.box)) <= *tauPx;
    }
};

bool meets(const Box3d& a, const Box3d& b) {
    return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

// The least error at which a cut has at most so many triangles. As errors never fall from child to
// parent, a node is in the cut of error e while its own is <= e and its parent's > e: one walk over
// the index collects these spans. 16 bytes a node.
class ErrorSearch {
public:
    ErrorSearch(const ooc::Database& database, const std::optional<Box3d>& box)
        : lattice_(database.header().lattice), box_(box) {
        ooc::walkIndex(database, *this);
    }

    bool enter(const ooc::NodeRecord& node, ooc::NodeRef ref) {
        if (!isWanted(node)) return false;
        if (ref == ooc::NodeRef{}) add(node, node.isLeaf() ? 0 : node.errorModelUnits, 1);
        return true;
    }
    void children(const ooc::NodeRecord& parent, std::span<const ooc::NodeRecord> below) {
        add(parent, parent.errorModelUnits, 0);
        for (const ooc::NodeRecord& child : below) {
            if (!isWanted(child)) continue;
            // From the child's own error (0: a leaf cannot be refined) up to the parent's.
            add(child, child.isLeaf() ? 0 : child.errorModelUnits, 1);
            add(child, parent.errorModelUnits, -1);
        }
    }
    void fault(uint32_t, const std::string&) {}  // said by the extraction itself

    [[nodiscard]] double leastError(uint64_t maxTriangles, const std::string& path) {
        std::sort(changes_.begin(), changes_.end(),
                  [](const Change& a, const Change& b) { return a.error < b.error; });
        int64_t triangles = 0, least = INT64_MAX;
        for (size_t i = 0; i < changes_.size();) {
            const double error = changes_[i].error;
            for (; i < changes_.size() && changes_[i].error == error; ++i) {
                triangles += changes_[i].triangles;
            }
            if (triangles <= static_cast<int64_t>(maxTriangles)) return error;
            least = std::min(least, triangles);
        }
        throw Error(path, "", fmt::format("the coarsest cut has {} triangles", least),
                    "raise --triangles");
    }

private:
    struct Change {
        double error;
        int64_t triangles;
    };

    [[nodiscard]] bool isWanted(const ooc::NodeRecord& node) const {
        return !box_ || meets(*box_, lattice_.toModel(node.box));
    }
    void add(const ooc::NodeRecord& node, double error, int sign) {
        if (sign != 0) changes_.push_back({error, sign * static_cast<int64_t>(node.triangleCount)});
    }

    const ooc::Lattice& lattice_;
    const std::optional<Box3d>& box_;
    std::vector<Change> changes_;
};

// Pages to batches: one run of a page is one batch.
class PageEmitter {
public:
    PageEmitter(const ooc::Database& database, const CutRule& rule, ooc::MeshWriter& writer)
        : database_(database), rule_(rule), writer_(writer) {}

    uint64_t triangles = 0, nodes = 0;

    void emit(const ooc::PageMesh& mesh) {
        ++nodes;
        size_t first = 0;
        for (const ooc::MeshRun& run : mesh.runs) {
            emitRun(mesh, run, first);
            first += run.triangleCount;
        }
    }

private:
    void emitRun(const ooc::PageMesh& mesh, const ooc::MeshRun& run, size_t first) {
        batch_.clear();
        batch_.object = run.object;
        batch_.material = run.material;
        const ooc::Lattice& lattice = database_.header().lattice;
        const uint32_t plain = database_.materials()[run.material].colour;
        bool hasColours = false, hasNormals = false;
        for (size_t t = first; t < first + run.triangleCount; ++t) {
            std::array<uint32_t, 3> vertices;
            std::array<Vec3d, 3> corners;
            Box3d box;
            for (size_t i = 0; i < 3; ++i) {
                vertices[i] = mesh.indices[3 * t + i];
                corners[i] = lattice.toModel(mesh.positions[vertices[i]]);
                box.extend(corners[i]);
            }
            if (rule_.box && !meets(*rule_.box, box)) continue;
            const Vec3f flat = faceNormal(corners);
            for (size_t i = 0; i < 3; ++i) {
                batch_.positions.push_back(corners[i]);
                batch_.colours.push_back(mesh.colours.empty() ? mesh.constantColour
                                                              : mesh.colours[vertices[i]]);
                const bool isFlat = mesh.normals.empty() || mesh.normals[vertices[i]].isNone();
                batch_.normals.push_back(isFlat ? flat
                                                : ooc::decodeNormal(mesh.normals[vertices[i]]));
                hasNormals |= !isFlat;
                hasColours |= batch_.colours.back() != plain;
            }
        }
        // What the material says already, and normals that any reader works out, stay away.
        if (!hasColours) batch_.colours.clear();
        if (!hasNormals) batch_.normals.clear();
        if (batch_.triangleCount() == 0) return;
        triangles += batch_.triangleCount();
        writer_.addTriangles(batch_);
    }

    static Vec3f faceNormal(const std::array<Vec3d, 3>& corners) {
        const Vec3d cross = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double length = glm::length(cross);
        return length > 0 ? Vec3f(cross / length) : Vec3f(0.0f, 0.0f, 1.0f);
    }

    const ooc::Database& database_;
    const CutRule& rule_;
    ooc::MeshWriter& writer_;
    ooc::TriangleBatch batch_;
};

ooc::UpAxis upAxisOf(const ooc::Database& database) {
    const auto metadata = nlohmann::json::parse(database.metadataJson(), nullptr, false);
    if (!metadata.is_object() || !metadata.contains("up")) return ooc::UpAxis::Unknown;
    const nlohmann::json& up = metadata["up"];
    if (up == "z") return ooc::UpAxis::Z;
    return up == "y" ? ooc::UpAxis::Y : ooc::UpAxis::Unknown;
}

class FaultList {
public:
    explicit FaultList(Progress& progress) : progress_(progress) {}
    void add(const std::string& line) {
        if (count++ < kMaxShownFaults) progress_.warn(line);
    }
    uint64_t count = 0;

private:
    Progress& progress_;
};

void declareTables(const ooc::Database& database, ooc::MeshWriter& writer, FaultList& faults) {
    uint64_t declared = 0;
    for (uint32_t block = 0; block < database.objectBlockCount(); ++block) {
        const auto records = database.readObjectBlock(block);
        if (!records.value) {
            faults.add(
                fmt::format("{}: object block {}: {}", database.path(), block, records.fault));
            continue;
        }
        for (const ooc::ObjectRecord& record : *records.value) {
            writer.addObject({.name = record.name, .parent = record.parent});
            ++declared;
        }
    }
    // Broken blocks cost names, not triangles.
    for (; declared < database.header().objectCount; ++declared) writer.addObject({});
    for (const ooc::MaterialRecord& material : database.materials()) {
        writer.addMaterial({material.name, material.colour, material.isTranslucent});
    }
}

CutRule makeRule(const Arguments& arguments, const ooc::Database& database, bool hasError) {
    CutRule rule;
    if (!arguments.box.empty()) {
        const std::vector<double>& b = arguments.box;
        rule.box = Box3d{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
        if (rule.box->isEmpty()) {
            throw Error("--box", "", "its second corner lies before the first",
                        "give x0,y0,z0,x1,y1,z1");
        }
    }
    if (hasError) rule.maxError = arguments.error;
    if (arguments.level >= 0) rule.maxLevel = arguments.level;
    if (arguments.triangles > 0) {
        rule.maxError =
            ErrorSearch(database, rule.box).leastError(arguments.triangles, database.path());
    }
    if (arguments.tauPx > 0) {
        const auto root = database.readBlock(0);
        if (!root.value)
            throw Error(database.path(), "index block 0", root.fault, "build it again");
        const Box3d box = database.header().lattice.toModel(root.value->nodes.front().box);
        const bool isZUp = upAxisOf(database) == ooc::UpAxis::Z;
        const hlod::UpAxis up = isZUp ? hlod::UpAxis::Z : hlod::UpAxis::Y;
        hlod::Camera camera = hlod::frameBox({}, box, hlod::viewDirection("iso", up), up);
        if (!arguments.camera.empty()) camera = hlod::parseCamera(arguments.camera, camera);
        rule.view.emplace(camera, box);
        rule.tauPx = arguments.tauPx;
    }
    return rule;
}

void extract(const Arguments& arguments, bool hasError, Session& session) {
    const ooc::Database database = ooc::Database::open(arguments.database);
    FaultList faults(*session.progress);
    const CutRule rule = makeRule(arguments, database, hasError);
    const auto writer =
        ooc::MeshWriter::create(arguments.target, arguments.force, upAxisOf(database));
    declareTables(database, *writer, faults);
    PageEmitter emitter(database, rule, *writer);
    const ooc::Lattice& lattice = database.header().lattice;
    session.progress->beginStage("extract", 0, "triangles");
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            session.progress->check();
            if (rule.box && !meets(*rule.box, lattice.toModel(node.box))) return false;
            if (!rule.isDrawn(node, lattice)) return true;
            const ooc::Loaded<ooc::Page> page = database.readPage(node);
            if (!page.value) {
                faults.add(fmt::format("{}: page of node {:x}: {}", database.path(), node.id.value,
                                       page.fault));
                return false;
            }
            emitter.emit(page.value->mesh);
            session.progress->advance(node.triangleCount);
            return false;
        },
        [&](uint32_t block, const std::string& why) {
            faults.add(fmt::format("{}: index block {}: {}", database.path(), block, why));
        });
    const uint64_t bytes = writer->finish();
    if (faults.count > 0) session.exitCode = 1;
    if (arguments.json) {
        const nlohmann::ordered_json json{{"triangles", emitter.triangles},
                                          {"nodes", emitter.nodes},
                                          {"bytes", bytes},
                                          {"faults", faults.count}};
        std::cout << json.dump(2) << '\n';
        return;
    }
    std::cout << fmt::format("{}: {} triangles of {} nodes, {}\n", arguments.target,
                             formatCount(emitter.triangles), formatCount(emitter.nodes),
                             formatBytes(bytes));
    if (faults.count > 0) {
        std::cout << fmt::format("{} faults: what they hold is missing; see `pagoda verify`\n",
                                 formatCount(faults.count));
    }
}

}  // namespace

void addExtractCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand("extract", "Write a cut of a database as a mesh");
    command->footer(kExamples);
    command->add_option("database", arguments->database, "The database")->required();
    command->add_option("-o,--output", arguments->target, "The mesh: .ply, .obj, .glb or .stl")
        ->required();
    CLI::Option* error = command
                             ->add_option("--error", arguments->error,
                                          "Refine until no node's error is above (model units)")
                             ->check(CLI::NonNegativeNumber);
    CLI::Option* triangles =
        command
            ->add_option("--triangles", arguments->triangles,
                         "The cut of least error with at most so many triangles")
            ->check(CLI::PositiveNumber);
    CLI::Option* level = command->add_option("--level", arguments->level, "0 is the root")
                             ->check(CLI::NonNegativeNumber);
    CLI::Option* tau = command
                           ->add_option("--tau", arguments->tauPx,
                                        "Refine until no node's error is above, in pixels")
                           ->check(CLI::PositiveNumber);
    command->add_option("--camera", arguments->camera, "For --tau: JSON as in `render`")
        ->needs(tau);
    error->excludes(triangles)->excludes(level)->excludes(tau);
    triangles->excludes(level)->excludes(tau);
    level->excludes(tau);
    command->add_option("--box", arguments->box, "x0,y0,z0,x1,y1,z1 in model units")
        ->delimiter(',')
        ->expected(6);
    command->add_flag("--force", arguments->force, "Replace an existing file");
    command->add_flag("--json", arguments->json, "What was written as JSON");
    command->callback(
        [arguments, error, &session] { extract(*arguments, error->count() > 0, session); });
}

}  // namespace pagoda::tools
