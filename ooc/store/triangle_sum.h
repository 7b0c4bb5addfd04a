// triangle_sum.h: the fingerprint of one accepted triangle. Count and sum of
// all accepted triangles go into the header; verify recomputes both from the leaves' pages, so that
// none is lost or doubled.
#pragma once

#include "ooc/base/box.h"
#include "ooc/base/hash.h"

#include <cstdint>
#include <span>

namespace pagoda::ooc {

// Corners as lattice points in winding order, any of them first: the item starts with the least.
// Attributes are not part of it. 44 bytes little-endian: 9 int32, object, material.
inline void addTriangle(OrderFreeSum& sum, const Vec3i& a, const Vec3i& b, const Vec3i& c,
                        uint32_t object, uint32_t material) {
    const auto less = [](const Vec3i& p, const Vec3i& q) {
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
    };
    const Vec3i* corners[3] = {&a, &b, &c};
    if (less(b, a) && !less(c, b)) {
        corners[0] = &b, corners[1] = &c, corners[2] = &a;
    } else if (less(c, a) && less(c, b)) {
        corners[0] = &c, corners[1] = &a, corners[2] = &b;
    }
    int32_t item[11];
    for (int i = 0; i < 3; ++i) {
        for (int axis = 0; axis < 3; ++axis) item[3 * i + axis] = (*corners[i])[axis];
    }
    item[9] = static_cast<int32_t>(object);
    item[10] = static_cast<int32_t>(material);
    sum.add(std::as_bytes(std::span(item)));
}

}  // namespace pagoda::ooc
