// cluster.h: vertex clustering for nodes whose parts cannot merge by edge collapse.
// Rossignac and Borrel 1993 (one representative a grid cell), with quadric-optimal representatives
// (Lindstrom 2000), mean colours, and two repairs of what clustering loses: rods, and a shrinking
// outline.
#pragma once

#include "hlod/build/simplify.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

// Representatives lie inside what they stand for, so outlines shrink by a part of a cell. Unshrunk
// pushes rims, edges and corners out again: for meshes that are drawn, not for those that are
// clustered again.
enum class Outline { AsClustered, Unshrunk };

// At most `budget` (> 0) triangles of the finest uniform grid that keeps to it: cells of whole
// steps from 2, their size within 2%, or coarser with 96% of the budget used. Each of its corners
// lies in its cell (AsClustered) and has the mean colour there, weighted by area. Opaque and
// translucent surfaces never share a cell. Empty when nothing spans three cells, and no rod two, at
// such a size.
[[nodiscard]] std::vector<SoupTriangle> clusterToBudget(std::span<const SoupTriangle> triangles,
                                                        uint32_t budget, int extentBits,
                                                        const std::vector<bool>& isTranslucent,
                                                        Outline outline);

}  // namespace pagoda::hlod
