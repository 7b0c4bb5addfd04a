#include "tools/opening/surface_sketch.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace pagoda::tools {
namespace {

// Cells begin that much smaller than the first triangle: what is too fine coarsens by itself.
constexpr double kFirstCellShare = 1.0 / 16.0;
// Coordinates of cells stay within; beyond, the cells become larger.
constexpr double kMostCells = 1 << 28;
// A cell must have been come to so often on average that what a sample leaves out can be a gap no
// more than once in twenty cells (Poisson: e^-3), which the discs about it close.
constexpr uint64_t kVisitsPerCell = 3;
constexpr uint64_t kFewestParts = 64;
// Of the diagonal: larger triangles are seen as what they are, also where others are missing.
constexpr float kLargeShare = 1.0f / 32.0f;
// A disc about the mean point of a cell reaches the cell's corners from its centre: sqrt(2) cells
// on a flat piece.
constexpr double kDiscCells = 1.42;

uint64_t hashOf(const glm::ivec3& place) {
    uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        hash = (hash ^ static_cast<uint32_t>(place[axis])) * 0x9E3779B97F4A7C15ull;
        hash ^= hash >> 29;
    }
    return hash;
}

float longestSquared(const std::array<Vec3f, 3>& corners) {
    const auto squared = [](const Vec3f& v) { return glm::dot(v, v); };
    return std::max({squared(corners[1] - corners[0]), squared(corners[2] - corners[1]),
                     squared(corners[0] - corners[2])});
}

Vec3f areaNormal(const std::array<Vec3f, 3>& corners) {
    return 0.5f * glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
}

Vec3f unit(const Vec3f& v) {
    const float length = glm::length(v);
    return length > 0.0f && std::isfinite(length) ? v / length : Vec3f(0.0f);
}

Vec3f channels(uint32_t colour) {
    return {static_cast<float>(colour & 255u), static_cast<float>(colour >> 8 & 255u),
            static_cast<float>(colour >> 16 & 255u)};
}

uint32_t packed(const Vec3f& colour) {
    uint32_t result = 0xFF000000u;
    for (int k = 0; k < 3; ++k) {
        result |= static_cast<uint32_t>(std::clamp(colour[k] + 0.5f, 0.0f, 255.0f)) << (8 * k);
    }
    return result;
}

}  // namespace

SurfaceSketch::SurfaceSketch(Limits limits) : limits_(limits) {
    // At most half full, so that a search is short.
    slots_.resize(std::bit_ceil(2 * (limits.cells + 1)));
}

void SurfaceSketch::add(const Vec3d& a, const Vec3d& b, const Vec3d& c, uint32_t colour) {
    if (seen_ == 0) origin_ = a;
    ++seen_;
    for (const Vec3d& corner : {a, b, c}) box_.extend(corner);
    const Triangle triangle{{Vec3f(a - origin_), Vec3f(b - origin_), Vec3f(c - origin_)}, colour};
    const auto longest = static_cast<double>(std::sqrt(longestSquared(triangle.corners)));
    if (cellModelUnits_ == 0.0 && longest > 0.0 && std::isfinite(longest)) {
        cellModelUnits_ = std::exp2(std::floor(std::log2(kFirstCellShare * longest)));
    }
    if (cellModelUnits_ == 0.0) return;  // a point: the next triangle says how large things are
    const Vec3f centre = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0f;
    const auto farthest =
        static_cast<double>(std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)}));
    if (!std::isfinite(farthest)) return;  // beyond float: nothing to look at
    while (farthest > kMostCells * cellModelUnits_) coarsen();
    countVisit(CellPlace(glm::floor(centre * static_cast<float>(1.0 / cellModelUnits_))));
    if (isSmall(triangle)) {
        addToCell(triangle);
    } else {
        triangles_.push_back(triangle);
    }
    makeRoom();
}

bool SurfaceSketch::isSmall(const Triangle& triangle) const {
    const auto cell = static_cast<float>(cellModelUnits_);
    return longestSquared(triangle.corners) <= cell * cell;
}

void SurfaceSketch::addToCell(const Triangle& triangle) {
    const auto inverse = static_cast<float>(1.0 / cellModelUnits_);
    const Vec3f centre =
        (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) * (inverse / 3.0f);
    const Vec3f corner = glm::floor(centre);
    addCell({.place = CellPlace(corner),
             .positions = centre - corner,
             .normals = areaNormal(triangle.corners),
             .colours = channels(triangle.colour),
             .count = 1.0f});
}

void SurfaceSketch::addCell(const Cell& cell) {
    const size_t mask = slots_.size() - 1;
    size_t slot = hashOf(cell.place) & mask;
    while (slots_[slot] != 0 && cells_[slots_[slot] - 1].place != cell.place) {
        slot = (slot + 1) & mask;
    }
    if (slots_[slot] == 0) {
        cells_.push_back(cell);
        slots_[slot] = static_cast<uint32_t>(cells_.size());
        return;
    }
    Cell& into = cells_[slots_[slot] - 1];
    into.positions += cell.positions;
    // Two sides of a thin wall must not cancel: light falls on either side alike.
    into.normals += glm::dot(into.normals, cell.normals) < 0.0f ? -cell.normals : cell.normals;
    into.colours += cell.colours;
    into.count += cell.count;
}

void SurfaceSketch::countVisit(const CellPlace& place) {
    const glm::uvec3 differing = glm::uvec3(place) ^ glm::uvec3(lastPlace_);
    ++visits_[static_cast<size_t>(std::bit_width(differing.x | differing.y | differing.z))];
    lastPlace_ = place;
}

void SurfaceSketch::coarsen() {
    cellModelUnits_ *= 2.0;
    // Below zero and above they never meet: the last number stays what it is.
    visits_[0] += visits_[1];
    std::copy(visits_.begin() + 2, visits_.end() - 1, visits_.begin() + 1);
    visits_[visits_.size() - 2] = 0;
    for (int axis = 0; axis < 3; ++axis) lastPlace_[axis] >>= 1;
    std::vector<Cell> finer;
    finer.swap(cells_);
    cells_.reserve(limits_.cells + 1);
    std::fill(slots_.begin(), slots_.end(), 0u);
    for (Cell& cell : finer) {
        const CellPlace parent(cell.place.x >> 1, cell.place.y >> 1, cell.place.z >> 1);
        const Vec3f corner(cell.place - parent * 2);
        cell.positions = 0.5f * (cell.positions + cell.count * corner);
        cell.place = parent;
        addCell(cell);
    }
    const auto smallBegin = std::partition(triangles_.begin(), triangles_.end(),
                                           [&](const Triangle& t) { return !isSmall(t); });
    // There is room: a move is followed by coarser cells until all fit, and slots are twice as
    // many.
    std::vector<Triangle> small(smallBegin, triangles_.end());
    triangles_.erase(smallBegin, triangles_.end());
    for (const Triangle& triangle : small) {
        addToCell(triangle);
        if (cells_.size() > limits_.cells) coarsen();
    }
}

void SurfaceSketch::makeRoom() {
    if (cells_.size() > limits_.cells) coarsen();
    if (triangles_.size() <= limits_.triangles) return;
    // Some more than needed, so that the next one does not call for it again.
    while (triangles_.size() > limits_.triangles - limits_.triangles / 4) coarsen();
}

// Cells, and triangles that will become some.
uint64_t SurfaceSketch::partCount() const {
    const auto large = kLargeShare * static_cast<float>(glm::length(box_.max - box_.min));
    const auto small = std::count_if(triangles_.begin(), triangles_.end(), [&](const Triangle& t) {
        return longestSquared(t.corners) <= large * large;
    });
    return cells_.size() + static_cast<uint64_t>(small);
}

bool SurfaceSketch::hasGaps() const {
    const uint64_t visits = std::accumulate(visits_.begin() + 1, visits_.end(), uint64_t{0});
    return partCount() > std::max(kFewestParts, visits / kVisitsPerCell);
}

viewer::Preview SurfaceSketch::picture(bool isSample) const {
    assert(seen_ > 0);
    if (isSample && hasGaps()) {
        SurfaceSketch coarser = *this;
        while (coarser.hasGaps()) coarser.coarsen();
        return coarser.picture(false);
    }
    viewer::Preview preview;
    preview.origin = origin_;
    preview.box = box_;
    preview.trianglesSeen = seen_;
    preview.discModelUnits = kDiscCells * cellModelUnits_;
    preview.discs.reserve(cells_.size());
    for (const Cell& cell : cells_) {
        const Vec3f place = Vec3f(cell.place) + cell.positions / cell.count;
        preview.discs.push_back({static_cast<float>(cellModelUnits_) * place, unit(cell.normals),
                                 packed(cell.colours / cell.count)});
    }
    preview.corners.reserve(3 * triangles_.size());
    for (const Triangle& triangle : triangles_) {
        const Vec3f normal = unit(areaNormal(triangle.corners));
        for (const Vec3f& corner : triangle.corners) {
            preview.corners.push_back({corner, normal, packed(channels(triangle.colour))});
        }
    }
    return preview;
}

}  // namespace pagoda::tools
