#include "tools/paths/floor_plan.h"

#include "ooc/base/error.h"

#include <cmath>
#include <cstdlib>
#include <span>

namespace pagoda::tools {
namespace {

constexpr Vec3i kAround[8] = {{1, 0, 0},  {1, 1, 0},   {0, 1, 0},  {-1, 1, 0},
                              {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}, {1, -1, 0}};

uint64_t tileKey(int x, int y) {
    return static_cast<uint64_t>(static_cast<uint32_t>(x)) << 32 | static_cast<uint32_t>(y);
}

}  // namespace

FloorPlan::FloorPlan(const Occupancy& solid, const WalkerCells& walker, size_t maxSpots,
                     Progress& progress)
    : step_(walker.step) {
    const std::vector<Vec3i> blocks = solid.sortedBlocks();
    progress.beginStage("Finding floors", blocks.size(), "blocks");
    for (size_t i = 0; i < blocks.size();) {
        size_t end = i;
        while (end < blocks.size() && blocks[end].x == blocks[i].x && blocks[end].y == blocks[i].y)
            ++end;
        addTile(solid, std::span(blocks).subspan(i, end - i), walker);
        if (cells_.size() > maxSpots) {
            throw Error("", "", "there is too much floor for one walk at this eye height",
                        "choose a part with --box, or give a larger --eye-height");
        }
        progress.check();
        progress.advance(end - i);
        i = end;
    }
    measureClearance();
}

void FloorPlan::addTile(const Occupancy& solid, std::span<const Vec3i> blocks,
                        const WalkerCells& walker) {
    Tile tile{};
    const Vec3i corner = blocks.front() * kTile;
    const size_t before = cells_.size();
    std::vector<const Occupancy::Block*> column;
    for (const Vec3i& block : blocks) column.push_back(solid.findBlock(block));
    for (int c = 0; c < kTile * kTile; ++c) {
        tile[static_cast<size_t>(c)] = static_cast<uint32_t>(cells_.size());
        int below = INT32_MIN / 2;  // the last solid cell
        for (size_t b = 0; b < blocks.size(); ++b) {
            unsigned bits = (*column[b])[static_cast<size_t>(c)];
            for (; bits != 0; bits &= bits - 1) {
                const int z = blocks[b].z * kTile + std::countr_zero(bits);
                const int room = z - below - 1;
                if (room >= walker.height && room <= walker.ceiling) {
                    cells_.push_back({corner.x + c % kTile, corner.y + c / kTile, below + 1});
                }
                below = z;
            }
        }
    }
    tile.back() = static_cast<uint32_t>(cells_.size());
    if (cells_.size() > before) tiles_.emplace(tileKey(blocks[0].x, blocks[0].y), tile);
}

uint32_t FloorPlan::find(const Vec3i& cell) const {
    const auto tile = tiles_.find(tileKey(cell.x >> 3, cell.y >> 3));
    if (tile == tiles_.end()) return kNone;
    const size_t column = static_cast<size_t>((cell.x & 7) | (cell.y & 7) << 3);
    uint32_t best = kNone;
    int bestAway = step_ + 1;
    for (uint32_t spot = tile->second[column]; spot < tile->second[column + 1]; ++spot) {
        const int away = std::abs(cells_[spot].z - cell.z);
        if (away >= bestAway) continue;
        best = spot;
        bestAway = away;
    }
    return best;
}

std::array<uint32_t, 8> FloorPlan::neighbours(uint32_t spot) const {
    std::array<uint32_t, 8> found;
    for (size_t i = 0; i < 8; ++i) found[i] = find(cells_[spot] + kAround[i]);
    return found;
}

// Distances of 5 along and 7 across, as in chamfer transforms, by a queue of buckets.
void FloorPlan::measureClearance() {
    constexpr size_t kMost = 250;
    clearance_.assign(cells_.size(), static_cast<uint8_t>(kMost));
    std::vector<std::vector<uint32_t>> waiting(kMost + 1);
    const auto lower = [&](uint32_t spot, size_t distance) {
        if (distance >= clearance_[spot]) return;
        clearance_[spot] = static_cast<uint8_t>(distance);
        waiting[distance].push_back(spot);
    };
    for (uint32_t spot = 0; spot < cells_.size(); ++spot) {
        for (const uint32_t next : neighbours(spot)) {
            if (next == kNone) lower(spot, 2);
        }
    }
    for (size_t distance = 0; distance < kMost; ++distance) {
        for (size_t i = 0; i < waiting[distance].size(); ++i) {
            const uint32_t spot = waiting[distance][i];
            if (clearance_[spot] != distance) continue;
            const std::array<uint32_t, 8> next = neighbours(spot);
            for (size_t n = 0; n < 8; ++n) {
                if (next[n] != kNone) lower(next[n], distance + (n % 2 == 0 ? 5 : 7));
            }
        }
        waiting[distance] = {};
    }
}

}  // namespace pagoda::tools
