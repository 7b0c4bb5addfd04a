// floor_plan.h: where a person can stand under a roof, and how far from the next wall.
// A spot is a free cell above a solid one, with room for a body above it and a ceiling within
// reach. Spots in neighbouring columns are neighbours when a step leads from one to the other.
// Read-only once made: any thread.
#pragma once

#include "ooc/base/progress.h"
#include "tools/paths/occupancy.h"

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pagoda::tools {

// A person, in cells.
struct WalkerCells {
    int height = 15;    // free above the floor
    int step = 2;       // up or down between neighbouring columns
    int ceiling = 170;  // a floor without anything so far above it is outdoors
};

class FloorPlan {
public:
    static constexpr uint32_t kNone = UINT32_MAX;

    // About 20 bytes a spot. Throws Error when there are more than `maxSpots`.
    FloorPlan(const Occupancy& solid, const WalkerCells& walker, size_t maxSpots,
              Progress& progress);

    [[nodiscard]] size_t size() const noexcept { return cells_.size(); }
    [[nodiscard]] const Vec3i& cell(uint32_t spot) const { return cells_[spot]; }
    // The spot of that column nearest to height z, at most a step away; kNone when there is none.
    [[nodiscard]] uint32_t find(const Vec3i& cell) const;
    // The 8 neighbours, kNone where there is none; even places share an edge, odd ones a corner.
    [[nodiscard]] std::array<uint32_t, 8> neighbours(uint32_t spot) const;
    // Cells on the floor to the nearest place that is none (wall, table, edge), at most 50.
    [[nodiscard]] double clearance(uint32_t spot) const { return clearance_[spot] / 5.0; }

private:
    static constexpr int kTile = Occupancy::kBlockCells;
    using Tile = std::array<uint32_t, kTile * kTile + 1>;  // where each column's spots begin

    void addTile(const Occupancy& solid, std::span<const Vec3i> blocks, const WalkerCells& walker);
    void measureClearance();

    int step_;
    std::vector<Vec3i> cells_;        // by tile, column, height
    std::vector<uint8_t> clearance_;  // fifths of a cell
    std::unordered_map<uint64_t, Tile> tiles_;
};

}  // namespace pagoda::tools
