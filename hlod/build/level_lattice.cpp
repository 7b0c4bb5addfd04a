#include "hlod/build/level_lattice.h"

#include "hlod/build/vertex_table.h"

#include <algorithm>

namespace pagoda::hlod {
namespace {

constexpr double kLeastCosine = 0.5;  // 60 degrees

struct PlaceKey {
    Vec3i position;

    [[nodiscard]] bool operator==(const PlaceKey&) const = default;
    [[nodiscard]] uint64_t hash() const {
        const uint64_t h = mixHash(0x6C62272E, static_cast<uint32_t>(position.x));
        return mixHash(h, static_cast<uint32_t>(position.y) |
                              (uint64_t{static_cast<uint32_t>(position.z)} << 32));
    }
};

struct EdgeKey {
    uint32_t low, high;  // places, the lower number first

    [[nodiscard]] bool operator==(const EdgeKey&) const = default;
    [[nodiscard]] uint64_t hash() const {
        return mixHash(0x27D4EB2F, low | (uint64_t{high} << 32));
    }
};

class Snapper {
public:
    Snapper(std::span<const SoupTriangle> triangles, int shift);

    void holdBorders();
    void chooseTargets(const Box3i& bounds);
    // Keeps vertices where they were until no triangle turns too far: ends, as each round but the
    // last keeps at least one more.
    void keepTriangles();
    void write(std::vector<SoupTriangle>& triangles) const;
    [[nodiscard]] const LevelSnap& counts() const noexcept { return counts_; }

private:
    [[nodiscard]] Vec3i rounded(const Vec3i& point) const;
    void keep(size_t place);
    [[nodiscard]] bool turnsTooFar(const uint32_t* corners) const;

    int shift_;
    VertexTable<PlaceKey> places_;
    std::vector<uint32_t> indices_;  // 3 a triangle, into places
    std::vector<bool> isBorder_;     // by place
    std::vector<Vec3i> targets_;     // by place
    LevelSnap counts_;
};

Snapper::Snapper(std::span<const SoupTriangle> triangles, int shift) : shift_(shift) {
    places_.reset(triangles.size() * 3);
    indices_.reserve(triangles.size() * 3);
    for (const SoupTriangle& triangle : triangles) {
        for (const Vec3i& corner : triangle.corners) indices_.push_back(places_.add({corner}));
    }
    isBorder_.assign(places_.keys().size(), false);
}

void Snapper::holdBorders() {
    VertexTable<EdgeKey> edges;
    edges.reset(indices_.size());
    std::vector<int32_t> balance;
    for (size_t i = 0; i < indices_.size(); ++i) {
        const uint32_t from = indices_[i], to = indices_[i % 3 == 2 ? i - 2 : i + 1];
        const uint32_t edge = edges.add({std::min(from, to), std::max(from, to)});
        if (edge == balance.size()) balance.push_back(0);
        balance[edge] += from < to ? 1 : -1;
    }
    for (size_t edge = 0; edge < balance.size(); ++edge) {
        if (balance[edge] == 0) continue;
        isBorder_[edges.keys()[edge].low] = true;
        isBorder_[edges.keys()[edge].high] = true;
    }
    counts_.borders = static_cast<uint64_t>(std::count(isBorder_.begin(), isBorder_.end(), true));
}

// The nearest point of the level's lattice. Stays in [0, 2^extentBits]: both ends are on it.
Vec3i Snapper::rounded(const Vec3i& point) const {
    const int32_t half = shift_ > 0 ? 1 << (shift_ - 1) : 0;
    return {((point.x + half) >> shift_) << shift_, ((point.y + half) >> shift_) << shift_,
            ((point.z + half) >> shift_) << shift_};
}

void Snapper::chooseTargets(const Box3i& bounds) {
    const std::vector<PlaceKey>& places = places_.keys();
    VertexTable<PlaceKey> taken;
    taken.reset(places.size());
    targets_.resize(places.size());
    for (size_t i = 0; i < places.size(); ++i) {
        targets_[i] = isBorder_[i] ? places[i].position : rounded(places[i].position);
        if (targets_[i] == places[i].position) (void)taken.add(places[i]);
    }
    for (size_t i = 0; i < places.size(); ++i) {
        if (targets_[i] == places[i].position) continue;
        const size_t before = taken.keys().size();
        if (!bounds.contains(targets_[i]) || taken.add({targets_[i]}) < before) {
            keep(i);
        } else {
            ++counts_.moved;
        }
    }
}

void Snapper::keep(size_t place) {
    targets_[place] = places_.keys()[place].position;
    ++counts_.kept;
}

bool Snapper::turnsTooFar(const uint32_t* corners) const {
    const std::vector<PlaceKey>& places = places_.keys();
    const auto normal = [&](const auto& at) {
        const Vec3i a = at(corners[0]);
        return glm::cross(Vec3d(at(corners[1]) - a), Vec3d(at(corners[2]) - a));
    };
    const Vec3d before = normal([&](uint32_t place) { return places[place].position; });
    const double length = glm::length(before);
    if (length == 0) return false;  // a needle has no side to turn
    const Vec3d after = normal([&](uint32_t place) { return targets_[place]; });
    return !(glm::dot(before, after) > kLeastCosine * length * glm::length(after));
}

void Snapper::keepTriangles() {
    const auto isMoved = [&](uint32_t place) {
        return targets_[place] != places_.keys()[place].position;
    };
    for (bool isDone = false; !isDone;) {
        isDone = true;
        for (size_t i = 0; i < indices_.size(); i += 3) {
            const uint32_t* corners = &indices_[i];
            if (std::none_of(corners, corners + 3, isMoved) || !turnsTooFar(corners)) continue;
            for (const uint32_t* corner = corners; corner != corners + 3; ++corner) {
                if (!isMoved(*corner)) continue;
                keep(*corner);
                --counts_.moved;
                isDone = false;
            }
        }
    }
}

void Snapper::write(std::vector<SoupTriangle>& triangles) const {
    for (size_t i = 0; i < triangles.size(); ++i) {
        for (size_t k = 0; k < 3; ++k) triangles[i].corners[k] = targets_[indices_[3 * i + k]];
    }
}

}  // namespace

int levelShift(const CellFrame& cell) {
    return std::max(0, cell.bits - kLevelBits);
}

LevelSnap snapToLevel(std::vector<SoupTriangle>& triangles, const CellFrame& cell,
                      const Box3i& bounds, bool keepBorders) {
    const int shift = levelShift(cell);
    if (shift == 0) return {};
    Snapper snapper(triangles, shift);
    if (keepBorders) snapper.holdBorders();
    snapper.chooseTargets(bounds);
    snapper.keepTriangles();
    snapper.write(triangles);
    return snapper.counts();
}

}  // namespace pagoda::hlod
