#include "hlod/build/partition.h"

#include <algorithm>
#include <array>
#include <span>
#include <unordered_map>

namespace pagoda::hlod {
namespace {

constexpr int kGridLevels = 7;  // 2^21 counters of 4 bytes a partition step
constexpr size_t kReadBytes = size_t{4} << 20;
constexpr uint64_t kWriteBufferBytes = uint64_t{32} << 20;  // shared by all pieces of a step

// Morton number, `levels` octants below the cell that spans [.., 2^cellBits), of a point in it.
uint32_t mortonBelow(const Vec3i& point, int cellBits, int levels) {
    uint32_t morton = 0;
    for (int level = 0; level < levels; ++level) {
        morton = (morton << 3) | octantOf(point, cellBits - level);
    }
    return morton;
}

// One step: a cell, counted on a grid `levels` below it, cut into pieces.
struct Step {
    ooc::NodeId cell;
    int cellBits = 0;  // log2 of the cell's edge
    int levels = 0;
    // Triangles homed in the grid or below, by Morton number; and those homed higher, by level.
    std::vector<uint32_t> gridCounts;
    std::array<std::vector<uint32_t>, kGridLevels> homedAt;
    std::array<std::vector<uint64_t>, kGridLevels + 1> totals;
};

struct Target {
    uint32_t piece = UINT32_MAX;
    int level = 0;  // of the piece's cell below the step's cell
};

class Partitioner {
public:
    Partitioner(Intake& intake, const ooc::Lattice& lattice, const std::filesystem::path& folder,
                uint64_t pieceTriangles, uint32_t nodeTriangles, Progress& progress)
        : layout_(intake.layout),
          extentBits_(lattice.extentBits),
          folder_(folder),
          pieceTriangles_(std::max<uint64_t>(pieceTriangles, nodeTriangles)),
          progress_(progress) {
        result_.maxDepth = std::min(ooc::kMaxDepth, lattice.extentBits);
    }

    Partition run(Intake& intake) {
        result_.files.push_back(std::move(intake.spill));
        result_.scratchBytes = intake.accepted * layout_.bytes();
        const Piece whole{.cell = ooc::NodeId::root(), .triangleCount = intake.accepted};
        if (whole.triangleCount > 0) refine(whole);
        return std::move(result_);
    }

private:
    void refine(const Piece& piece);
    [[nodiscard]] Step count(const Piece& piece) const;
    void visit(const Step& step, int level, uint32_t morton, ooc::NodeId cell,
               std::vector<Piece>& found);
    void distribute(const Step& step, const Piece& from, std::vector<Piece>& found);
    template <typename Visit>
    void forEachTriangle(const Piece& piece, Visit&& visit) const;

    SoupLayout layout_;
    int extentBits_;
    std::filesystem::path folder_;
    uint64_t pieceTriangles_;
    Progress& progress_;
    Partition result_;
};

template <typename Visit>
void Partitioner::forEachTriangle(const Piece& piece, Visit&& visit) const {
    const size_t stride = layout_.bytes();
    std::vector<std::byte> buffer(kReadBytes / stride * stride);
    const File& file = result_.files[piece.file];
    uint64_t done = 0;
    while (done < piece.triangleCount) {
        const uint64_t now = std::min<uint64_t>(piece.triangleCount - done, buffer.size() / stride);
        file.readAt((piece.firstTriangle + done) * stride, std::span(buffer).first(now * stride));
        for (uint64_t i = 0; i < now; ++i) visit(buffer.data() + i * stride);
        done += now;
        progress_.advance(now);
        progress_.check();
    }
}

// Cells that cannot be cut, or need not be, stay whole; the others are cut into smaller pieces,
// which are looked at again.
void Partitioner::refine(const Piece& piece) {
    if (piece.triangleCount <= pieceTriangles_ || piece.isExtra ||
        piece.cell.depth() >= result_.maxDepth) {
        result_.pieces.push_back(piece);
        return;
    }
    progress_.beginStage("sort into cells", piece.triangleCount * 2, "triangles");
    Step step = count(piece);
    std::vector<Piece> found;
    visit(step, 0, 0, piece.cell, found);
    distribute(step, piece, found);
    result_.files[piece.file].discard(piece.firstTriangle * layout_.bytes(),
                                      piece.triangleCount * layout_.bytes());  // they have moved
    for (const Piece& next : found) refine(next);
}

Step Partitioner::count(const Piece& piece) const {
    Step step;
    step.cell = piece.cell;
    const int depth = piece.cell.depth();
    step.cellBits = extentBits_ - depth;
    step.levels = std::min(kGridLevels, result_.maxDepth - depth);
    step.gridCounts.assign(size_t{1} << (3 * step.levels), 0);
    for (int level = 0; level < step.levels; ++level) {
        step.homedAt[static_cast<size_t>(level)].assign(size_t{1} << (3 * level), 0);
    }
    forEachTriangle(piece, [&](const std::byte* record) {
        std::array<Vec3i, 3> corners;
        std::memcpy(&corners, record, sizeof corners);
        const uint32_t morton =
            mortonBelow(centroidPoint(corners, extentBits_), step.cellBits, step.levels);
        const int home = homeDepth(corners, extentBits_) - depth;
        if (home >= step.levels) {
            ++step.gridCounts[morton];
        } else {
            const int level = std::max(home, 0);
            ++step.homedAt[static_cast<size_t>(level)][morton >> (3 * (step.levels - level))];
        }
    });
    step.totals[static_cast<size_t>(step.levels)].assign(step.gridCounts.begin(),
                                                         step.gridCounts.end());
    for (int level = step.levels - 1; level >= 0; --level) {
        std::vector<uint64_t>& totals = step.totals[static_cast<size_t>(level)];
        const std::vector<uint64_t>& below = step.totals[static_cast<size_t>(level) + 1];
        totals.resize(below.size() / 8);
        for (size_t i = 0; i < totals.size(); ++i) {
            totals[i] = step.homedAt[static_cast<size_t>(level)][i];
            for (size_t octant = 0; octant < 8; ++octant) totals[i] += below[8 * i + octant];
        }
    }
    return step;
}

void Partitioner::visit(const Step& step, int level, uint32_t morton, ooc::NodeId cell,
                        std::vector<Piece>& found) {
    const uint64_t total = step.totals[static_cast<size_t>(level)][morton];
    if (total == 0) return;
    if (level == step.levels || (total <= pieceTriangles_ && level > 0)) {
        found.push_back({.cell = cell, .triangleCount = total});
        return;
    }
    result_.topCells.push_back(cell);
    if (const uint64_t homed = step.homedAt[static_cast<size_t>(level)][morton]; homed > 0) {
        found.push_back({.cell = cell, .isExtra = true, .triangleCount = homed});
    }
    for (uint32_t octant = 0; octant < 8; ++octant) {
        visit(step, level + 1, morton * 8 + octant, cell.child(octant), found);
    }
}

void Partitioner::distribute(const Step& step, const Piece& from, std::vector<Piece>& found) {
    const size_t stride = layout_.bytes();
    const auto fileNumber = static_cast<uint32_t>(result_.files.size());
    result_.files.push_back(File::createScratch(folder_));
    result_.files.back().reserve(from.triangleCount * stride);
    result_.scratchBytes += from.triangleCount * stride;

    // Where a grid cell's triangles go, and where a top cell keeps its own.
    std::vector<Target> byGrid(step.gridCounts.size());
    std::unordered_map<uint64_t, uint32_t> extraOf;
    uint64_t first = 0;
    const int depth = step.cell.depth();
    for (uint32_t i = 0; i < found.size(); ++i) {
        found[i].file = fileNumber;
        found[i].firstTriangle = first;
        first += found[i].triangleCount;
        if (found[i].isExtra) {
            extraOf.emplace(found[i].cell.path(), i);
            continue;
        }
        const int level = found[i].cell.depth() - depth;
        const uint64_t within = found[i].cell.path() & ((uint64_t{1} << (3 * level)) - 1);
        const size_t span = size_t{1} << (3 * (step.levels - level));
        std::fill_n(byGrid.begin() + static_cast<ptrdiff_t>(within * span), span, Target{i, level});
    }

    const uint64_t bufferBytes =
        std::clamp<uint64_t>(kWriteBufferBytes / std::max<size_t>(found.size(), 1), 4096, 1 << 20);
    std::vector<std::vector<std::byte>> buffers(found.size());
    std::vector<uint64_t> written(found.size(), 0);
    const auto flush = [&](size_t i) {
        result_.files[fileNumber].writeAt(found[i].firstTriangle * stride + written[i], buffers[i]);
        written[i] += buffers[i].size();
        buffers[i].clear();
    };
    forEachTriangle(from, [&](const std::byte* record) {
        std::array<Vec3i, 3> corners;
        std::memcpy(&corners, record, sizeof corners);
        const uint32_t morton =
            mortonBelow(centroidPoint(corners, extentBits_), step.cellBits, step.levels);
        const int home = std::max(homeDepth(corners, extentBits_) - depth, 0);
        const Target& target = byGrid[morton];
        uint32_t number = target.piece;
        if (number == UINT32_MAX || home < target.level) {
            const uint64_t path =
                (step.cell.path() << (3 * home)) | (morton >> (3 * (step.levels - home)));
            number = extraOf.at(path);
        }
        buffers[number].insert(buffers[number].end(), record, record + stride);
        if (buffers[number].size() + stride > bufferBytes) flush(number);
    });
    for (size_t i = 0; i < found.size(); ++i) flush(i);
}

}  // namespace

Partition partitionTriangles(Intake& intake, const ooc::Lattice& lattice,
                             const std::filesystem::path& scratchFolder, uint64_t pieceTriangles,
                             uint32_t nodeTriangles, Progress& progress) {
    return Partitioner(intake, lattice, scratchFolder, pieceTriangles, nodeTriangles, progress)
        .run(intake);
}

}  // namespace pagoda::hlod
