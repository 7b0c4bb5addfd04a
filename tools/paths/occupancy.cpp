#include "tools/paths/occupancy.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pagoda::tools {
namespace {

constexpr int kBlockShift = 3;
constexpr int kMaxCells = 1 << 24;  // along an axis: block coordinates take 21 bits

uint64_t keyOf(const Vec3i& block) {
    return static_cast<uint64_t>(block.x) << 42 | static_cast<uint64_t>(block.y) << 21 |
           static_cast<uint64_t>(block.z);
}

Vec3i blockOf(uint64_t key) {
    constexpr uint64_t kMask = (uint64_t{1} << 21) - 1;
    return {static_cast<int>(key >> 42), static_cast<int>(key >> 21 & kMask),
            static_cast<int>(key & kMask)};
}

size_t columnOf(const Vec3i& cell) {
    return static_cast<size_t>((cell.x & 7) | (cell.y & 7) << 3);
}

// Separating axes of a triangle and a box (Akenine-Moller, "Fast 3D triangle-box overlap
// testing", 2001), corners relative to the box's centre.
bool isSeparated(const Triangle& t, const Vec3d& half, const Vec3d& axis) {
    const double a = glm::dot(t[0], axis), b = glm::dot(t[1], axis), c = glm::dot(t[2], axis);
    const double reach = glm::dot(half, glm::abs(axis));
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
}

bool overlaps(const Triangle& t, const Vec3d& normal, const Vec3d& half) {
    // The plane first: it rules out most boxes.
    if (isSeparated(t, half, normal)) return false;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = std::min({t[0][axis], t[1][axis], t[2][axis]});
        const double high = std::max({t[0][axis], t[1][axis], t[2][axis]});
        if (low > half[axis] || high < -half[axis]) return false;
    }
    for (const Vec3d& e : {t[1] - t[0], t[2] - t[1], t[0] - t[2]}) {
        if (isSeparated(t, half, {0, -e.z, e.y}) || isSeparated(t, half, {e.z, 0, -e.x}) ||
            isSeparated(t, half, {-e.y, e.x, 0})) {
            return false;
        }
    }
    return true;
}

}  // namespace

Occupancy::Occupancy(const Box3d& bounds, double cellModelUnits, size_t maxBlocks)
    : origin_(bounds.min), cell_(cellModelUnits), maxBlocks_(maxBlocks) {
    const Vec3d cells = glm::ceil((bounds.max - bounds.min) / cell_);
    size_ = Vec3i(glm::clamp(cells, Vec3d(1.0), Vec3d(kMaxCells)));
    isFull_ = glm::any(glm::greaterThan(cells, Vec3d(kMaxCells)));
}

Vec3i Occupancy::cellAt(const Vec3d& point) const {
    const Vec3d cell = glm::floor((point - origin_) / cell_);
    return Vec3i(glm::clamp(cell, Vec3d(-kMaxCells), Vec3d(2 * kMaxCells)));
}

bool Occupancy::addTriangle(const Triangle& triangle) {
    Box3d box;
    for (const Vec3d& corner : triangle) box.extend(corner);
    // A triangle that lies on a border between cells touches both.
    const Vec3d slack(1e-6 * cell_);
    const Vec3i first = glm::max(cellAt(box.min - slack), Vec3i(0));
    const Vec3i last = glm::min(cellAt(box.max + slack), size_ - 1);
    if (!isFull_ && glm::all(glm::lessThanEqual(first, last))) {
        const Vec3d normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
        addRange({triangle, normal}, first, last);
    }
    return !isFull_;
}

// Halves the range until it is a cell, leaving out halves that the triangle does not reach.
void Occupancy::addRange(const Facet& facet, const Vec3i& first, const Vec3i& last) {
    if (isFull_ || !touches(facet, first, last)) return;
    const Vec3i extent = last - first;
    if (extent == Vec3i(0)) return setSolid(first);
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                     : extent.y >= extent.z                       ? 1
                                                                  : 2;
    Vec3i lowLast = last, highFirst = first;
    lowLast[axis] = first[axis] + extent[axis] / 2;
    highFirst[axis] = lowLast[axis] + 1;
    addRange(facet, first, lowLast);
    addRange(facet, highFirst, last);
}

bool Occupancy::touches(const Facet& facet, const Vec3i& first, const Vec3i& last) const {
    const Vec3d low = cellMin(first), high = cellMin(last + 1);
    const Vec3d centre = 0.5 * (low + high);
    const Vec3d half = 0.5 * (high - low) + 2e-6 * cell_;  // over addTriangle()'s slack
    const Triangle& t = facet.corners;
    return overlaps({t[0] - centre, t[1] - centre, t[2] - centre}, facet.normal, half);
}

void Occupancy::setSolid(const Vec3i& cell) {
    const uint64_t key = keyOf(cell >> kBlockShift);
    if (key != lastKey_ || blocks_.empty()) {
        const auto [found, isNew] = indexOf_.emplace(key, static_cast<uint32_t>(blocks_.size()));
        if (isNew && blocks_.size() >= maxBlocks_) {
            indexOf_.erase(found);
            isFull_ = true;
            return;
        }
        if (isNew) blocks_.push_back({});
        lastKey_ = key;
        lastBlock_ = found->second;
    }
    blocks_[lastBlock_][columnOf(cell)] |= static_cast<uint8_t>(1u << (cell.z & 7));
}

const Occupancy::Block* Occupancy::findBlock(const Vec3i& block) const {
    const auto found = indexOf_.find(keyOf(block));
    return found == indexOf_.end() ? nullptr : &blocks_[found->second];
}

bool Occupancy::isSolid(const Vec3i& cell) const {
    const bool isInside =
        glm::all(glm::greaterThanEqual(cell, Vec3i(0))) && glm::all(glm::lessThan(cell, size_));
    if (!isInside) return false;
    const Block* const block = findBlock(cell >> kBlockShift);
    return block != nullptr && ((*block)[columnOf(cell)] >> (cell.z & 7) & 1) != 0;
}

bool Occupancy::isSolidAround(const Vec3i& cell, int margin) const {
    for (int z = -margin; z <= margin; ++z) {
        for (int y = -margin; y <= margin; ++y) {
            for (int x = -margin; x <= margin; ++x) {
                if (isSolid(cell + Vec3i(x, y, z))) return true;
            }
        }
    }
    return false;
}

double Occupancy::freeLength(const Vec3d& from, const Vec3d& direction, double maxLength) const {
    // Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", 1987.
    Vec3i cell = cellAt(from), step(0);
    Vec3d next(INFINITY), stride(INFINITY);
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0) continue;
        step[axis] = direction[axis] > 0 ? 1 : -1;
        const double border = cellMin(cell + (step[axis] + 1) / 2)[axis];
        next[axis] = (border - from[axis]) / direction[axis];
        stride[axis] = cell_ / std::abs(direction[axis]);
    }
    double length = 0;
    while (!isSolid(cell)) {
        const int axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
        length = next[axis];
        if (length >= maxLength) return maxLength;
        next[axis] += stride[axis];
        cell[axis] += step[axis];
    }
    return std::max(length, 0.0);
}

double Occupancy::viewLength(const Vec3d& from, const Vec3d& direction, double maxLength) const {
    const double length = freeLength(from, direction, 5 * maxLength);
    return length < 5 * maxLength ? std::min(length, maxLength) : 0.3 * maxLength;
}

bool Occupancy::isClear(const Vec3d& from, const Vec3d& to, int marginCells) const {
    const double length = glm::length(to - from);
    if (isSolidAround(cellAt(from), marginCells) || isSolidAround(cellAt(to), marginCells)) {
        return false;
    }
    if (length == 0) return true;
    const Vec3d direction = (to - from) / length;
    if (marginCells == 0) return freeLength(from, direction, length) >= length;
    const int steps = static_cast<int>(std::ceil(2 * length / cell_));
    for (int i = 1; i < steps; ++i) {
        if (isSolidAround(cellAt(glm::mix(from, to, static_cast<double>(i) / steps)),
                          marginCells)) {
            return false;
        }
    }
    return true;
}

std::vector<Vec3i> Occupancy::sortedBlocks() const {
    std::vector<uint64_t> keys;
    keys.reserve(indexOf_.size());
    for (const auto& [key, index] : indexOf_) keys.push_back(key);
    std::sort(keys.begin(), keys.end());
    std::vector<Vec3i> sorted;
    sorted.reserve(keys.size());
    for (const uint64_t key : keys) sorted.push_back(blockOf(key));
    return sorted;
}

}  // namespace pagoda::tools
