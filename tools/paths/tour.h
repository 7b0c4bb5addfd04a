// tour.h: a way on foot from place to place: through the part of a floor plan that is most of a
// building, always on spots with room around them.
#pragma once

#include "tools/generate/random.h"
#include "tools/paths/floor_plan.h"

#include <cstdint>
#include <vector>

namespace pagoda::tools {

// Lengths in cells; what they are for people is in inside.cpp.
struct TourStyle {
    double bodyRadius;      // least clearance
    double likedClearance;  // less than that is walked only where the way is short
    double placeClearance;  // a place has at least this much room around it
    double placeOpenness;   // and so much free view on average, at most 5 eye heights each
    double placeSpacing;    // about a room
    double seenRadius;      // places passed so near, in view, count as visited
    double eyeHeight;
};

class Tour {
public:
    // Picks the connected floor that is largest, most enclosed and most divided by walls; empty
    // when there is none larger than a small room. `solid` and `plan` outlive the tour.
    Tour(const Occupancy& solid, const FloorPlan& plan, const TourStyle& style, uint64_t seed,
         Progress& progress);

    [[nodiscard]] bool isEmpty() const noexcept { return places_.size() < 2; }
    // Walks on to another place, one not visited while there are any: appends to way().
    void extend();
    // Spots from neighbour to neighbour.
    [[nodiscard]] const std::vector<uint32_t>& way() const noexcept { return way_; }
    // Spots worth a visit: far from walls for their surroundings.
    [[nodiscard]] const std::vector<uint32_t>& places() const noexcept { return places_; }
    [[nodiscard]] bool isPassable(uint32_t spot) const { return isChosen_[spot]; }
    [[nodiscard]] double floorCells() const noexcept { return floorCells_; }
    // Above the spot's middle, in model units (upright).
    [[nodiscard]] Vec3d eyeAt(uint32_t spot) const;

private:
    void chooseFloor(Progress& progress);
    void choosePlaces();
    // Cells of free view around the spot, on average.
    [[nodiscard]] double openness(uint32_t spot) const;
    [[nodiscard]] double buildingScore(const std::vector<uint32_t>& spots) const;
    [[nodiscard]] std::vector<uint32_t> nextPlaces();
    void markVisited(uint32_t spot);

    const Occupancy& solid_;
    const FloorPlan& plan_;
    TourStyle style_;
    Random random_;
    std::vector<bool> isChosen_;
    double floorCells_ = 0;
    std::vector<uint32_t> places_, way_;
    std::vector<bool> isVisited_;    // a place
    std::vector<uint32_t> placeOf_;  // a spot: which place it is, or kNone
    std::vector<float> cost_;        // of the search that runs; infinite: not reached
    std::vector<uint32_t> from_, reached_;
};

}  // namespace pagoda::tools
