// assemble.h: triangles with corners of their own -> a page's mesh: welded, sorted into parts and
// runs, ordered for the vertex cache and for the codecs.
#pragma once

#include "hlod/build/soup.h"
#include "ooc/node_id.h"
#include "ooc/page_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

// The cell a page belongs to: parts are its octants.
struct CellFrame {
    Vec3i origin{0};  // lattice
    int bits = 0;     // edge = 2^bits
    int extentBits = 0;
};
[[nodiscard]] CellFrame cellFrame(ooc::NodeId cell, int extentBits);

// Welds corners of equal position, colour and normal. `isTranslucent` by material id.
// Deterministic: depends on the order of `triangles` only. Not empty.
[[nodiscard]] ooc::PageMesh assemblePage(std::span<const SoupTriangle> triangles,
                                         const CellFrame& cell,
                                         const std::vector<bool>& isTranslucent);

// The way back: the page's triangles in its order, every corner with its own colour and normal.
[[nodiscard]] std::vector<SoupTriangle> unpackPage(const ooc::PageMesh& mesh);

}  // namespace pagoda::hlod
