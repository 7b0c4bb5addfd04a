// soup.h: accepted triangles on the lattice, as they lie in scratch between the stages.
#pragma once

#include "ooc/base/file.h"
#include "ooc/page_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <vector>

namespace pagoda::hlod {

struct SoupTriangle {
    std::array<Vec3i, 3> corners;
    uint32_t object = 0, material = 0;
    std::array<uint32_t, 3> colours{};
    std::array<ooc::OctNormal, 3> normals{};
};

// Which optional parts a record holds: a scene without normals does not pay for them.
struct SoupLayout {
    bool hasColours = false, hasNormals = false;

    [[nodiscard]] size_t bytes() const {
        return 44 + (hasColours ? size_t{12} : 0) + (hasNormals ? size_t{8} : 0);
    }
    void store(const SoupTriangle& triangle, std::byte* out) const {
        std::memcpy(out, &triangle, 44);
        out += 44;
        if (hasColours) {
            std::memcpy(out, triangle.colours.data(), 12);
            out += 12;
        }
        if (hasNormals) std::memcpy(out, triangle.normals.data(), 6);
    }
    [[nodiscard]] SoupTriangle load(const std::byte* in) const {
        SoupTriangle triangle;
        std::memcpy(static_cast<void*>(&triangle), in, 44);
        in += 44;
        if (hasColours) {
            std::memcpy(triangle.colours.data(), in, 12);
            in += 12;
        }
        if (hasNormals) std::memcpy(triangle.normals.data(), in, 6);
        return triangle;
    }
};
static_assert(offsetof(SoupTriangle, colours) == 44);

// A leaf's error in lattice steps: the snap moved each point by at most half a lattice diagonal,
// sqrt(3) / 2.
inline constexpr double kSnapErrorSteps = std::numbers::sqrt3 / 2;

// Three times the centroid, exactly.
[[nodiscard]] inline glm::i64vec3 tripleCentroid(const std::array<Vec3i, 3>& corners) {
    return glm::i64vec3(corners[0]) + glm::i64vec3(corners[1]) + glm::i64vec3(corners[2]);
}

// Exactly no area: two corners equal or all three on a line. Lattice coordinates are at most 2^30,
// so that the products fit 64 bits.
[[nodiscard]] inline bool hasNoArea(const std::array<Vec3i, 3>& corners) {
    const glm::i64vec3 u = glm::i64vec3(corners[1]) - glm::i64vec3(corners[0]);
    const glm::i64vec3 v = glm::i64vec3(corners[2]) - glm::i64vec3(corners[0]);
    return u.y * v.z == u.z * v.y && u.z * v.x == u.x * v.z && u.x * v.y == u.y * v.x;
}

// The lattice point at the centroid, rounded down, inside [0, 2^extentBits).
[[nodiscard]] inline Vec3i centroidPoint(const std::array<Vec3i, 3>& corners, int extentBits) {
    const glm::i64vec3 sum = tripleCentroid(corners);
    const int64_t last = (int64_t{1} << extentBits) - 1;
    return {static_cast<int32_t>(std::min(sum.x / 3, last)),
            static_cast<int32_t>(std::min(sum.y / 3, last)),
            static_cast<int32_t>(std::min(sum.z / 3, last))};
}

// The depth of the smallest cells whose children are still large against the triangle: in deeper
// cells it would be longer than half a child's edge and it stays above as
// an extra leaf. Cells of depth d have edge 2^(extentBits - d); the answer is the least d with edge
// < 4 * longest.
[[nodiscard]] inline int homeDepth(const std::array<Vec3i, 3>& corners, int extentBits) {
    uint64_t longest = 0;
    for (size_t i = 0; i < 3; ++i) {
        const glm::i64vec3 edge = glm::i64vec3(corners[(i + 1) % 3]) - glm::i64vec3(corners[i]);
        longest = std::max(
            longest, static_cast<uint64_t>(edge.x * edge.x + edge.y * edge.y + edge.z * edge.z));
    }
    const int bits = static_cast<int>(std::bit_width(longest - 1)) +
                     4;                         // of 16 * longest - 1, which may need 66 bits
    const int largestFitting = (bits - 1) / 2;  // the largest k with 4^k < 16 * longest
    return std::max(0, extentBits - largestFitting);
}

// Octant of a point in a cell of edge 2^bits (bit 0 x, bit 1 y, bit 2 z).
[[nodiscard]] inline uint32_t octantOf(const Vec3i& point, int cellBits) {
    const int half = cellBits - 1;
    return ((static_cast<uint32_t>(point.x) >> half) & 1u) |
           (((static_cast<uint32_t>(point.y) >> half) & 1u) << 1) |
           (((static_cast<uint32_t>(point.z) >> half) & 1u) << 2);
}

}  // namespace pagoda::hlod
