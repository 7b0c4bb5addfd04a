#include "hlod/build/build.h"

#include "hlod/build/intake.h"
#include "hlod/build/node_store.h"
#include "hlod/build/partition.h"
#include "hlod/build/report.h"
#include "hlod/build/resources.h"
#include "hlod/build/survey.h"
#include "hlod/build/tree_builder.h"
#include "ooc/base/error.h"
#include "ooc/base/thread_pool.h"
#include "ooc/store/database_writer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace pagoda::hlod {
namespace {

// One worker's piece: records, unpacked triangles, their numbers, and the nodes in flight.
constexpr uint64_t kWorkerBytes = kPieceTriangles * (64 + 68 + 8) + (uint64_t{24} << 20);
// Everything that does not grow with the number of workers.
constexpr uint64_t kFixedBytes = uint64_t{64} << 20;

std::filesystem::path targetFolder(const BuildOptions& options) {
    const std::filesystem::path parent = options.target.parent_path();
    return parent.empty() ? std::filesystem::path(".") : parent;
}

std::filesystem::path scratchFolder(const BuildOptions& options) {
    return options.scratchFolder.empty() ? targetFolder(options) : options.scratchFolder;
}

size_t workerCount(const BuildOptions& options) {
    const size_t wanted =
        options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    const uint64_t fitting = options.memoryBytes > kFixedBytes + kWorkerBytes
                                 ? (options.memoryBytes - kFixedBytes) / kWorkerBytes
                                 : 1;
    return static_cast<size_t>(std::clamp<uint64_t>(fitting, 1, wanted));
}

// The target is written last: what forbids it is said before hours of work, not after.
void checkTarget(const BuildOptions& options) {
    std::error_code code;
    const auto status = std::filesystem::status(options.target, code);
    if (std::filesystem::is_directory(status)) {
        throw Error(options.target.string(), "", "is a folder", "choose another name");
    }
    if (std::filesystem::exists(status) && !options.force) {
        throw Error(options.target.string(), "", "already exists", "use --force to replace it");
    }
    const std::filesystem::path folder = targetFolder(options);
    if (!std::filesystem::is_directory(folder, code)) {
        throw Error(options.target.string(), "", "cannot create: no folder " + folder.string(),
                    "make the folder first");
    }
    if (::access(folder.c_str(), W_OK | X_OK) != 0) {
        throw Error(options.target.string(), "",
                    "cannot create: " + std::generic_category().message(errno),
                    "check the permissions of " + folder.string() + ", or name another folder");
    }
}

void checkOptions(const BuildOptions& options) {
    if (options.memoryBytes < kMinMemoryBytes) {
        throw Error("", "", "--memory is below the least that a build needs",
                    "give 256MiB or more");
    }
    if (options.inputs.empty())
        throw Error("", "", "no input", "name a mesh file, a folder or a glob");
    checkTarget(options);
    const std::filesystem::path folder = scratchFolder(options);
    std::error_code code;
    if (!std::filesystem::is_directory(folder, code)) {
        throw Error(folder.string(), "", "no such folder", "make it, or name another");
    }
}

std::string inputName(const BuildOptions& options) {
    return options.inputs.size() == 1 ? options.inputs[0].path.string()
                                      : fmt::format("{} inputs", options.inputs.size());
}

// "2 line primitive, 1 point primitive", or nothing.
std::string listed(const std::map<std::string, uint64_t>& counts) {
    std::string list;
    for (const auto& [what, count] : counts) {
        list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, what);
    }
    return list;
}

// Nothing in the input can become a surface: says what there was instead.
[[noreturn]] void refuseEmpty(const std::string& input,
                              const std::map<std::string, uint64_t>& dropped,
                              const std::map<std::string, uint64_t>& ignored) {
    uint64_t lost = 0;
    for (const auto& [reason, count] : dropped) lost += count;
    std::string what =
        lost == 0 ? "no triangles"
                  : fmt::format("no triangle of {} can be used: {}", lost, listed(dropped));
    if (!ignored.empty()) what += "; ignored: " + listed(ignored);
    throw Error(input, "", what, "name a file that holds a surface");
}

[[noreturn]] void refuseOutliers(const std::string& input, const Survey& survey, uint64_t collapsed,
                                 const Box3d& collapsedBounds) {
    const auto text = [](const Box3d& box) {
        return fmt::format("({:g} {:g} {:g}) to ({:g} {:g} {:g})", box.min.x, box.min.y, box.min.z,
                           box.max.x, box.max.y, box.max.z);
    };
    throw Error(
        input, "",
        fmt::format("{} of {} triangles are smaller than 2^-29 of the extent: they lie in {}, "
                    "the whole spans {}",
                    collapsed, survey.triangles, text(collapsedBounds), text(survey.bounds)),
        "remove the outliers that stretch the bounds, or accept the loss with --precision");
}

// Reads and snaps; makes the lattice finer while too much collapses on it.
Intake takeInAtFineEnoughStep(const BuildOptions& options, InputSet& inputs, const Survey& survey,
                              ooc::Lattice& lattice, Progress& progress) {
    constexpr double kCollapsedShare = 0.001;
    const SoupLayout layout{.hasColours = survey.hasColours, .hasNormals = survey.hasNormals};
    uint64_t collapsed = 0;
    Box3d collapsedBounds;
    for (int refinement = 0;; refinement += 3) {
        const ooc::Lattice before = lattice;
        lattice =
            chooseLattice(survey, inputName(options), options.precisionModelUnits, refinement);
        if (refinement > 0 && lattice == before) {
            refuseOutliers(inputName(options), survey, collapsed, collapsedBounds);
        }
        Intake intake = takeIn(inputs, lattice, layout, scratchFolder(options), progress);
        const auto share = static_cast<double>(intake.collapsed) /
                           static_cast<double>(std::max<uint64_t>(intake.trianglesIn, 1));
        if (share <= kCollapsedShare || options.precisionModelUnits) return intake;
        collapsed = intake.collapsed;
        collapsedBounds = intake.collapsedBounds;
        progress.note(fmt::format("{} triangles are smaller than the lattice step {}: refining it",
                                  intake.collapsed, lattice.step()));
    }
}

void buildPieces(TreeBuilder& builder, const Partition& partition, const SoupLayout& layout,
                 size_t workers, Progress& progress) {
    uint64_t total = 0;
    for (const Piece& piece : partition.pieces) total += piece.triangleCount;
    progress.beginStage("build nodes", total, "triangles");
    ThreadPool pool(workers);
    for (const Piece& piece : partition.pieces) {
        pool.add([&, piece] {
            progress.check();
            std::vector<std::byte> soup(piece.triangleCount * layout.bytes());
            const File& file = partition.files[piece.file];
            file.readAt(piece.firstTriangle * layout.bytes(), soup);
            file.discard(piece.firstTriangle * layout.bytes(), soup.size());
            if (piece.isExtra) {
                builder.buildExtraLeaves(piece.cell, soup);
            } else {
                builder.buildSubtree(piece.cell, soup);
            }
            progress.advance(piece.triangleCount);
        });
    }
    pool.wait();
}

// Deepest first; cells of one depth do not depend on each other.
void buildTop(TreeBuilder& builder, std::vector<ooc::NodeId> cells, size_t workers,
              Progress& progress) {
    progress.beginStage("join pieces", cells.size(), "nodes");
    std::stable_sort(cells.begin(), cells.end(),
                     [](ooc::NodeId a, ooc::NodeId b) { return a.depth() > b.depth(); });
    ThreadPool pool(workers);
    for (size_t begin = 0; begin < cells.size();) {
        size_t end = begin;
        while (end < cells.size() && cells[end].depth() == cells[begin].depth()) {
            pool.add([&, cell = cells[end]] {
                progress.check();
                builder.buildTopNode(cell);
                progress.advance(1);
            });
            ++end;
        }
        pool.wait();
        begin = end;
    }
}

ooc::Header makeHeader(const BuildOptions& options, const ooc::Lattice& lattice,
                       const Intake& intake, const std::vector<ooc::NodeRecord>& nodes) {
    ooc::Header header;
    header.lattice = lattice;
    header.codec = options.codec;
    header.nodeCount = nodes.size();
    header.leafCount = static_cast<uint64_t>(std::count_if(
        nodes.begin(), nodes.end(), [](const ooc::NodeRecord& node) { return node.isLeaf(); }));
    header.triangleCount = intake.accepted;
    header.triangleSum = intake.sum;
    header.nodeTriangles = options.nodeTriangles;
    return header;
}

void publish(const BuildOptions& options, const ooc::Lattice& lattice, const InputSet& inputs,
             Intake& intake, const NodeStore& store, BuildReport& report, Progress& progress) {
    std::vector<ooc::NodeRecord> nodes = store.inFileOrder();
    summariseNodes(nodes, report);
    progress.beginStage("write", store.pageBytes(), "B");
    ooc::DatabaseWriter writer(options.target, options.force, store.pageBytes());
    for (ooc::NodeRecord& node : nodes) {
        const std::vector<std::byte> page = store.readPage(node);
        node.pageOffset = writer.addPage(page);
        progress.advance(page.size());
        progress.check();
    }
    ooc::DatabaseWriter::Content content;
    content.header = makeHeader(options, lattice, intake, nodes);
    content.header.levelCount = static_cast<uint32_t>(report.levels.size());
    content.metadataJson = makeMetadata(options, lattice, inputs, report);
    content.nodes = std::move(nodes);
    content.objects = std::move(intake.objects);
    content.materials = std::move(intake.materials);
    report.fileBytes = writer.publish(std::move(content));
}

void sayLeftovers(const BuildOptions& options, Progress& progress) {
    for (const std::filesystem::path& leftover : ooc::findLeftovers(options.target)) {
        progress.note("an earlier build was cut off; removing " + leftover.filename().string());
        std::filesystem::remove(leftover);
    }
}

}  // namespace

BuildReport buildDatabase(const BuildOptions& options, Progress& progress) {
    checkOptions(options);
    sayLeftovers(options, progress);
    const PrivatePeak privatePeak;
    StageClock clock;
    BuildReport report;
    const size_t workers = workerCount(options);

    const ooc::ReaderOptions readerOptions{.scratchFolder = scratchFolder(options),
                                           .memoryBytes = options.memoryBytes,
                                           .maxTriangles = options.maxTriangles};
    InputSet inputs(options.inputs, readerOptions, options.upAxis);
    report.inputBytes = inputs.totalBytes();
    const Survey survey = surveyInputs(inputs, options.watcher, progress);
    clock.mark("survey");
    if (survey.bounds.isEmpty()) refuseEmpty(inputName(options), survey.dropped, survey.ignored);
    ooc::Lattice lattice;
    Intake intake = takeInAtFineEnoughStep(options, inputs, survey, lattice, progress);
    clock.mark("read and snap");
    if (intake.accepted == 0) refuseEmpty(inputName(options), intake.dropped, intake.ignored);
    report.companions = inputs.companions();
    report.trianglesIn = intake.trianglesIn;
    report.triangles = intake.accepted;
    report.dropped = intake.dropped;
    report.ignored = intake.ignored;
    report.objects = intake.objects.size();
    report.materials = intake.materials.size();
    report.latticeStep = lattice.step();

    TreeSettings settings{.lattice = lattice,
                          .layout = intake.layout,
                          .nodeTriangles = options.nodeTriangles,
                          .isTranslucent = intake.isTranslucent,
                          .materialColours = {}};
    for (const ooc::MaterialRecord& material : intake.materials) {
        settings.materialColours.push_back(material.colour);
    }
    Partition partition = partitionTriangles(intake, lattice, scratchFolder(options),
                                             kPieceTriangles, options.nodeTriangles, progress);
    settings.maxDepth = partition.maxDepth;
    clock.mark("sort into cells");

    NodeStore store(scratchFolder(options), options.codec);
    TreeBuilder builder(settings, store);
    buildPieces(builder, partition, settings.layout, workers, progress);
    clock.mark("build nodes");
    buildTop(builder, partition.topCells, workers, progress);
    partition.files.clear();
    clock.mark("join pieces");

    report.bentWedges = builder.bentWedges();
    report.keptVertices = builder.keptVertices();
    report.scratchPeakBytes = partition.scratchBytes + store.pageBytes();
    report.pageBytes = store.pageBytes();
    publish(options, lattice, inputs, intake, store, report, progress);
    clock.mark("write");
    report.stages = clock.stages();
    report.privatePeakBytes = privatePeak.bytes();
    return report;
}

}  // namespace pagoda::hlod
