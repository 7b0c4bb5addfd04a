// occupancy.h: which cells of a regular grid some triangle touches, kept for such cells only.
// Conservative: a cell is solid when any triangle reaches its closed box, so that a straight line
// through free cells meets no triangle.
#pragma once

#include "tools/paths/triangle_stream.h"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pagoda::tools {

class Occupancy {
public:
    static constexpr int kBlockCells = 8;  // along an edge
    // A byte a column of 8 cells, its bits rising with z; columns in order x + 8 y.
    using Block = std::array<uint8_t, kBlockCells * kBlockCells>;

    // The grid's cell 0 begins at bounds.min. Memory is about 130 bytes a block of 8 x 8 x 8 cells
    // that is touched, at most `maxBlocks` of them.
    Occupancy(const Box3d& bounds, double cellModelUnits, size_t maxBlocks);

    // What lies outside the bounds is left out. False, now and from then on, when the block limit
    // is reached. O(cells touched).
    bool addTriangle(const Triangle& triangle);

    [[nodiscard]] bool isSolid(const Vec3i& cell) const;
    // No cell that the segment passes through (within `marginCells` cells across it) is solid.
    [[nodiscard]] bool isClear(const Vec3d& from, const Vec3d& to, int marginCells = 0) const;
    // Length of the free way from `from` along the unit vector `direction`, at most `maxLength`.
    [[nodiscard]] double freeLength(const Vec3d& from, const Vec3d& direction,
                                    double maxLength) const;

    // The same as a view: a direction in which nothing comes for 5 times that is sky, and counts
    // 0.3 of it.
    [[nodiscard]] double viewLength(const Vec3d& from, const Vec3d& direction,
                                    double maxLength) const;

    [[nodiscard]] double cellSize() const noexcept { return cell_; }
    [[nodiscard]] const Vec3i& size() const noexcept { return size_; }  // cells along each axis
    [[nodiscard]] Vec3i cellAt(const Vec3d& point) const;
    [[nodiscard]] Vec3d cellMin(const Vec3i& cell) const { return origin_ + Vec3d(cell) * cell_; }

    // Block coordinates of all blocks, sorted by x, then y, then z.
    [[nodiscard]] std::vector<Vec3i> sortedBlocks() const;
    [[nodiscard]] const Block* findBlock(const Vec3i& block) const;

private:
    struct Facet {
        const Triangle& corners;
        Vec3d normal;  // of any length
    };
    void addRange(const Facet& facet, const Vec3i& first, const Vec3i& last);
    void setSolid(const Vec3i& cell);
    [[nodiscard]] bool touches(const Facet& facet, const Vec3i& first, const Vec3i& last) const;
    [[nodiscard]] bool isSolidAround(const Vec3i& cell, int margin) const;

    Vec3d origin_;
    double cell_;
    Vec3i size_;
    size_t maxBlocks_;
    bool isFull_ = false;
    std::unordered_map<uint64_t, uint32_t> indexOf_;
    std::vector<Block> blocks_;
    uint64_t lastKey_ = 0;  // of the block written last: the next cell is mostly in it too
    uint32_t lastBlock_ = 0;
};

}  // namespace pagoda::tools
