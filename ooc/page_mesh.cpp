#include "ooc/page_mesh.h"

#include <algorithm>
#include <cmath>

namespace pagoda::ooc {
namespace {

constexpr float kSteps = 127.0f;

// The upper half of the octahedron is the inner diamond of the square, the lower half its corners.
Vec3f fromSquare(float u, float v) {
    Vec3f normal{u, v, 1.0f - std::abs(u) - std::abs(v)};
    if (normal.z < 0.0f) {
        const float x = normal.x;
        normal.x = std::copysign(1.0f - std::abs(normal.y), x);
        normal.y = std::copysign(1.0f - std::abs(x), v);
    }
    return glm::normalize(normal);
}

}  // namespace

Vec3f decodeNormal(OctNormal normal) {
    if (normal.isNone()) return Vec3f{0.0f};
    return fromSquare(std::max(static_cast<float>(normal.u) / kSteps, -1.0f),
                      static_cast<float>(normal.v) / kSteps);
}

OctNormal encodeNormal(const Vec3f& unit) {
    const float length = std::abs(unit.x) + std::abs(unit.y) + std::abs(unit.z);
    if (!std::isfinite(length) || length == 0.0f) return {};
    float u = unit.x / length, v = unit.y / length;
    if (unit.z < 0.0f) {
        const float x = u;
        u = std::copysign(1.0f - std::abs(v), x);
        v = std::copysign(1.0f - std::abs(x), v);
    }
    // Of the four corners around the exact place the one nearest in angle, not in the square: this
    // halves the worst error (Cigolle et al. 2014, "A Survey of Efficient Representations").
    const Vec3f exact = unit / length;
    OctNormal best;
    float bestDot = -2.0f;
    for (const float cornerU : {std::floor(u * kSteps), std::ceil(u * kSteps)}) {
        for (const float cornerV : {std::floor(v * kSteps), std::ceil(v * kSteps)}) {
            const OctNormal corner{static_cast<int8_t>(cornerU), static_cast<int8_t>(cornerV)};
            const float dot = glm::dot(exact, decodeNormal(corner));
            if (dot > bestDot) {
                bestDot = dot;
                best = corner;
            }
        }
    }
    return best;
}

Box3i PageMesh::box() const {
    Box3i box;
    for (const Vec3i& position : positions) box.extend(position);
    return box;
}

}  // namespace pagoda::ooc
