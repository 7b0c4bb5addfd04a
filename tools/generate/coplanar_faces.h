// coplanar_faces.h: finds triangles that lie on each other: same plane (either side), common area.
// Such pairs flicker when drawn, and neither of them is "the" visible one.
#pragma once

#include "ooc/base/box.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace pagoda::tools {

struct CoplanarLimits {
    // The smaller triangle's corners lie within this of the larger one's plane. Generated
    // coordinates are rounded to 1/32768 m, which moves a tilted plane by up to 0.03 mm.
    double planeMetres = 4e-5;
    // Mean width of the common area. Triangles that share an edge, rounded, stay below.
    double widthMetres = 2e-4;
};

struct CoplanarFaces {
    uint64_t triangles = 0;                               // that share area with at least one other
    std::vector<std::pair<uint32_t, uint32_t>> examples;  // the first 100 pairs
};

// All pairs, exactly; each level of triangle sizes has a tree of boxes of its own, so that the cost
// stays near n log n. About 60 bytes a triangle.
[[nodiscard]] CoplanarFaces findCoplanarFaces(std::span<const Vec3f> corners,
                                              const CoplanarLimits& limits = {});

}  // namespace pagoda::tools
