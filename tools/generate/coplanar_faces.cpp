#include "tools/generate/coplanar_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pagoda::tools {
namespace {

using Box3f = Box3<float>;
using Point = glm::dvec2;

constexpr size_t kLeafTriangles = 8;
constexpr size_t kMaxExamples = 100;

bool touches(const Box3f& a, const Box3f& b) {
    return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

uint64_t spread(uint64_t value) {  // 16 bits to every third
    value &= 0xFFFF;
    value = (value | value << 16) & 0x00FF0000FF0000FFull;
    value = (value | value << 8) & 0xF00F00F00F00F00Full;
    value = (value | value << 4) & 0x30C30C30C30C30C3ull;
    return (value | value << 2) & 0x9249249249249249ull;
}

// A convex polygon of at most 6 corners: what is left of a triangle cut by another.
struct Polygon {
    std::array<Point, 8> corners;
    size_t count = 0;
};

Polygon cutBy(const Polygon& polygon, const Point& a, const Point& b) {
    const auto side = [&](const Point& p) {
        return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    };
    Polygon kept;
    for (size_t i = 0; i < polygon.count; ++i) {
        const Point& p = polygon.corners[i];
        const Point& q = polygon.corners[(i + 1) % polygon.count];
        const double sp = side(p), sq = side(q);
        if (sp >= 0) kept.corners[kept.count++] = p;
        if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) {
            kept.corners[kept.count++] = p + (q - p) * (sp / (sp - sq));
        }
    }
    return kept;
}

double meanWidth(const Polygon& polygon) {
    double area = 0, longest = 0;
    for (size_t i = 0; i < polygon.count; ++i) {
        const Point& p = polygon.corners[i];
        const Point& q = polygon.corners[(i + 1) % polygon.count];
        area += (p.x * q.y - p.y * q.x) / 2;
        for (size_t j = i + 1; j < polygon.count; ++j) {
            longest = std::max(longest, glm::distance(p, polygon.corners[j]));
        }
    }
    return longest > 0 ? std::abs(area) / longest : 0;
}

class Finder {
public:
    Finder(std::span<const Vec3f> corners, const CoplanarLimits& limits)
        : corners_(corners), limits_(limits), isShared_(corners.size() / 3, false) {}

    CoplanarFaces find() {
        sortTriangles();
        for (Level& level : levels_) buildTree(level);
        for (size_t level = 0; level < levels_.size(); ++level) joinLevel(level);
        result_.triangles =
            static_cast<uint64_t>(std::count(isShared_.begin(), isShared_.end(), true));
        return std::move(result_);
    }

private:
    struct Level {                  // triangles of about one size
        size_t begin = 0, end = 0;  // in order_
        std::vector<Box3f> boxes;   // a complete binary tree over the leaves, root at 1
        size_t leafCount = 0;       // a power of two
    };

    [[nodiscard]] Box3f boxOf(uint32_t triangle) const {
        Box3f box;
        for (size_t i = 0; i < 3; ++i) box.extend(corners_[3 * triangle + i]);
        const float grow = static_cast<float>(limits_.planeMetres);
        box.min -= grow;
        box.max += grow;
        return box;
    }

    void sortTriangles() {
        Box3f all;
        for (const Vec3f& corner : corners_) all.extend(corner);
        const Vec3f size = all.max - all.min;
        const float scale = 65535.0f / std::max({size.x, size.y, size.z, 1e-6f});
        std::vector<std::pair<uint64_t, uint32_t>> keys(corners_.size() / 3);
        for (uint32_t t = 0; t < keys.size(); ++t) {
            const Box3f box = boxOf(t);
            const Vec3f extent = box.max - box.min;
            const int sizeClass = std::ilogb(std::max({extent.x, extent.y, extent.z})) + 32;
            const Vec3f at = ((box.min + box.max) * 0.5f - all.min) * scale;
            const uint64_t morton = spread(static_cast<uint64_t>(at.x)) |
                                    spread(static_cast<uint64_t>(at.y)) << 1 |
                                    spread(static_cast<uint64_t>(at.z)) << 2;
            keys[t] = {static_cast<uint64_t>(std::clamp(sizeClass, 0, 63)) << 48 | morton, t};
        }
        std::sort(keys.begin(), keys.end());
        order_.resize(keys.size());
        for (size_t i = 0; i < keys.size(); ++i) {
            order_[i] = keys[i].second;
            if (i == 0 || keys[i].first >> 48 != keys[i - 1].first >> 48) {
                levels_.emplace_back().begin = i;
            }
            levels_.back().end = i + 1;
        }
    }

    void buildTree(Level& level) {
        const size_t count = level.end - level.begin;
        level.leafCount = 1;
        while (level.leafCount * kLeafTriangles < count) level.leafCount *= 2;
        level.boxes.assign(2 * level.leafCount, Box3f{});
        for (size_t i = 0; i < count; ++i) {
            level.boxes[level.leafCount + i / kLeafTriangles].extend(
                boxOf(order_[level.begin + i]));
        }
        for (size_t node = level.leafCount - 1; node > 0; --node) {
            level.boxes[node] = level.boxes[2 * node];
            level.boxes[node].extend(level.boxes[2 * node + 1]);
        }
    }

    // Every triangle of the level against those of its own and of the larger ones.
    void joinLevel(size_t own) {
        const Level& level = levels_[own];
        for (size_t i = level.begin; i < level.end; ++i) {
            const uint32_t triangle = order_[i];
            const Box3f box = boxOf(triangle);
            for (size_t other = own; other < levels_.size(); ++other) {
                visit(levels_[other], 1, box, [&](size_t position) {
                    if (other == own && position <= i) return;
                    testPair(order_[position], triangle);
                });
            }
        }
    }

    template <typename Visit>
    void visit(const Level& level, size_t node, const Box3f& box, Visit&& each) const {
        if (!touches(level.boxes[node], box)) return;
        if (node < level.leafCount) {
            visit(level, 2 * node, box, each);
            visit(level, 2 * node + 1, box, each);
            return;
        }
        const size_t begin = level.begin + (node - level.leafCount) * kLeafTriangles;
        const size_t end = std::min(begin + kLeafTriangles, level.end);
        for (size_t position = begin; position < end; ++position) each(position);
    }

    void testPair(uint32_t larger, uint32_t smaller) {
        const Vec3d a(corners_[3 * larger]), b(corners_[3 * larger + 1]),
            c(corners_[3 * larger + 2]);
        const Vec3d cross = glm::cross(b - a, c - a);
        const double length = glm::length(cross);
        if (length < 1e-12) return;
        const Vec3d normal = cross / length;
        Vec3d local[3];
        for (size_t i = 0; i < 3; ++i) {
            local[i] = Vec3d(corners_[3 * smaller + i]) - a;
            if (std::abs(glm::dot(local[i], normal)) > limits_.planeMetres) return;
        }
        const Vec3d u = glm::normalize(b - a), v = glm::cross(normal, u);
        Polygon polygon{.corners = {}, .count = 3};
        for (size_t i = 0; i < 3; ++i) {
            polygon.corners[i] = {glm::dot(local[i], u), glm::dot(local[i], v)};
        }
        const Point pa{0, 0}, pb{glm::dot(b - a, u), 0}, pc{glm::dot(c - a, u), glm::dot(c - a, v)};
        polygon = cutBy(cutBy(cutBy(polygon, pa, pb), pb, pc), pc, pa);
        if (polygon.count < 3 || meanWidth(polygon) < limits_.widthMetres) return;
        isShared_[larger] = isShared_[smaller] = true;
        if (result_.examples.size() < kMaxExamples) result_.examples.emplace_back(larger, smaller);
    }

    std::span<const Vec3f> corners_;
    CoplanarLimits limits_;
    std::vector<uint32_t> order_;
    std::vector<Level> levels_;
    std::vector<bool> isShared_;
    CoplanarFaces result_;
};

}  // namespace

CoplanarFaces findCoplanarFaces(std::span<const Vec3f> corners, const CoplanarLimits& limits) {
    return Finder(corners, limits).find();
}

}  // namespace pagoda::tools
