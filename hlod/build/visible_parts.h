// visible_parts.h: which triangles of a mesh can be seen from outside it.
// A node is drawn as a stand-in only while the eye is outside its box, so that what no direction
// shows (inner walls, the undersides of bricks) need not take triangles from what is seen.
#pragma once

#include "hlod/build/soup.h"
#include "ooc/base/box.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

// Pixels each triangle covers in parallel projections along the 26 directions to the faces, edges
// and corners of a cube, `resolution` (> 0) pixels along the diagonal of the mesh's box. Two-sided,
// exact to a pixel, and closed: nothing shows between triangles that share an edge. Ties go to the
// lower number. O(triangles + pixels they cover).
[[nodiscard]] std::vector<uint32_t> countVisiblePixels(std::span<const SoupTriangle> triangles,
                                                       int resolution);

// Each line carries two of the 26 directions, seen from either end.
inline constexpr int kViewLines = 13;

// For each pixel, row by row, the number of the triangle nearest to that end; UINT32_MAX: none.
using SeenNumbers = std::array<std::vector<uint32_t>, 2>;

// One projection, `resolution` pixels along the diagonal of `box`, which holds the triangles: two
// sets drawn with one box fit on each other. The rest as above.
[[nodiscard]] SeenNumbers seenAlong(int line, std::span<const SoupTriangle> triangles,
                                    const Box3i& box, int resolution);

}  // namespace pagoda::hlod
