#include "tools/paths/open_space.h"

#include "tools/paths/occupancy.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace pagoda::tools {
namespace {

constexpr double kCellsToDiagonal = 110;
constexpr double kRim = 0.4;  // of the diagonal, around the model and above it
constexpr uint8_t kFarthest = 240;

// The 13 neighbours that come before a cell in order of z, y, x, with distances of a 3-4-5 chamfer
// transform (Borgefors, "Distance transformations in arbitrary dimensions", 1984).
struct Neighbour {
    Vec3i offset;
    int thirds;
};

std::vector<Neighbour> neighboursBefore() {
    std::vector<Neighbour> before;
    for (int z = -1; z <= 0; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                if (z == 0 && (y > 0 || (y == 0 && x >= 0))) continue;
                before.push_back({{x, y, z}, 2 + std::abs(x) + std::abs(y) + std::abs(z)});
            }
        }
    }
    return before;
}

std::vector<Neighbour> neighboursAround() {
    std::vector<Neighbour> all = neighboursBefore();
    for (size_t i = 0, count = all.size(); i < count; ++i) {
        all.push_back({-all[i].offset, all[i].thirds});
    }
    return all;
}

}  // namespace

OpenSpace::OpenSpace(const PathScene& scene) : cell_(scene.diagonalModelUnits / kCellsToDiagonal) {
    const double rim = kRim * scene.diagonalModelUnits;
    // Nothing below the model: most stand on the ground.
    origin_ = scene.box.min - Vec3d(rim, rim, 0);
    const Box3d bounds{origin_, scene.box.max + Vec3d(rim)};
    Occupancy solid(bounds, cell_, SIZE_MAX);
    size_ = solid.size();
    scene.progress.beginStage("Reading triangles", scene.database.header().triangleCount,
                              "triangles");
    forEachTriangle(scene.database, scene.upright, 0.5 * cell_, std::nullopt, scene.progress,
                    [&](const Triangle& triangle) { (void)solid.addTriangle(triangle); });
    distance_.assign(
        static_cast<size_t>(size_.x) * static_cast<size_t>(size_.y) * static_cast<size_t>(size_.z),
        kFarthest);
    for (size_t cell = 0; cell < distance_.size(); ++cell) {
        if (solid.isSolid(coordinates(cell))) distance_[cell] = 0;
    }
    measure();
    flood();
}

Vec3i OpenSpace::coordinates(size_t cell) const {
    const auto x = static_cast<size_t>(size_.x), y = static_cast<size_t>(size_.y);
    return {static_cast<int>(cell % x), static_cast<int>(cell / x % y),
            static_cast<int>(cell / x / y)};
}

Vec3d OpenSpace::centreOf(size_t cell) const {
    return origin_ + (Vec3d(coordinates(cell)) + 0.5) * cell_;
}

size_t OpenSpace::cellAt(const Vec3d& point) const {
    const Vec3d cell = glm::floor((point - origin_) / cell_);
    return index(Vec3i(glm::clamp(cell, Vec3d(0.0), Vec3d(size_ - 1))));
}

bool OpenSpace::isOpen(const Vec3d& point) const {
    const Vec3d cell = glm::floor((point - origin_) / cell_);
    const bool isInside = glm::all(glm::greaterThanEqual(cell, Vec3d(0.0))) &&
                          glm::all(glm::lessThan(cell, Vec3d(size_)));
    return isInside && isOpen_[index(Vec3i(cell))];
}

void OpenSpace::measure() {
    const std::vector<Neighbour> before = neighboursBefore();
    const auto lower = [&](size_t cell, int sign) {
        const Vec3i at = coordinates(cell);
        int least = distance_[cell];
        for (const Neighbour& n : before) {
            const Vec3i next = at + sign * n.offset;
            if (contains(next)) least = std::min(least, distance_[index(next)] + n.thirds);
        }
        distance_[cell] = static_cast<uint8_t>(least);
    };
    for (size_t cell = 0; cell < distance_.size(); ++cell) lower(cell, 1);
    for (size_t cell = distance_.size(); cell-- > 0;) lower(cell, -1);
}

// From the highest corner, which the rim keeps free.
void OpenSpace::flood() {
    isOpen_.assign(distance_.size(), false);
    std::vector<size_t> open{distance_.size() - 1};
    isOpen_.back() = true;
    while (!open.empty()) {
        const Vec3i at = coordinates(open.back());
        open.pop_back();
        for (int axis = 0; axis < 3; ++axis) {
            for (const int step : {-1, 1}) {
                Vec3i next = at;
                next[axis] += step;
                if (!contains(next)) continue;
                const size_t cell = index(next);
                if (isOpen_[cell] || distance(cell) < kClearCells) continue;
                isOpen_[cell] = true;
                open.push_back(cell);
            }
        }
    }
}

// Steps by the distance field (Hart, "Sphere tracing", 1996); a cell's distance counts from its
// centre and may be an eighth too long, hence less than all of it.
double OpenSpace::freeLength(const Vec3d& from, const Vec3d& direction, double maxLength) const {
    for (double length = 0; length < maxLength;) {
        const Vec3d cell = glm::floor((from + length * direction - origin_) / cell_);
        if (glm::any(glm::lessThan(cell, Vec3d(0.0))) ||
            glm::any(glm::greaterThanEqual(cell, Vec3d(size_)))) {
            return maxLength;
        }
        const double free = distance(index(Vec3i(cell)));
        if (free == 0) return length;
        length += cell_ * std::max(0.5, 0.85 * free - 1);
    }
    return maxLength;
}

bool OpenSpace::isBeside(size_t cell, int reach) const {
    const Vec3i at = coordinates(cell);
    for (int side = 0; side < 4; ++side) {
        const int sign = side < 2 ? 1 : -1;
        for (int k = 1; k <= reach; ++k) {
            Vec3i next = at;
            next[side % 2] += sign * k;
            if (contains(next) && distance_[index(next)] == 0) return true;
        }
    }
    return false;
}

std::vector<Vec3d> OpenSpace::way(size_t from, size_t to, double liked) const {
    static const std::vector<Neighbour> kAround = neighboursAround();
    using Entry = std::pair<float, size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    std::vector<float> cost(distance_.size(), std::numeric_limits<float>::infinity());
    std::vector<uint8_t> via(distance_.size(), 255);
    // A*: no way is shorter than 0.94 of the straight line, as a 3-4-5 chamfer measures it.
    const Vec3d end(coordinates(to));
    const auto rest = [&](size_t cell) {
        return static_cast<float>(0.94 * glm::length(Vec3d(coordinates(cell)) - end));
    };
    cost[from] = 0;
    open.emplace(rest(from), from);
    std::vector<bool> isDone(distance_.size(), false);
    while (!open.empty() && open.top().second != to) {
        const size_t cell = open.top().second;
        const float here = cost[cell];
        open.pop();
        if (isDone[cell]) continue;
        isDone[cell] = true;
        const Vec3i at = coordinates(cell);
        for (size_t i = 0; i < kAround.size(); ++i) {
            const Vec3i next = at + kAround[i].offset;
            if (!contains(next) || !isOpen_[index(next)]) continue;
            const double off = std::abs(distance(index(next)) - liked) / liked;
            const double weight = 1 + std::min(off, 2.0);
            const float total = here + static_cast<float>(kAround[i].thirds / 3.0 * weight);
            if (total >= cost[index(next)]) continue;
            cost[index(next)] = total;
            via[index(next)] = static_cast<uint8_t>(i);
            open.emplace(total + rest(index(next)), index(next));
        }
    }
    std::vector<Vec3d> way{centreOf(to)};
    for (size_t cell = to; cell != from;) {
        cell = index(coordinates(cell) - kAround[via[cell]].offset);
        way.push_back(centreOf(cell));
    }
    std::reverse(way.begin(), way.end());
    return way;
}

}  // namespace pagoda::tools
