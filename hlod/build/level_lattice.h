// level_lattice.h: rounds what a coarse node may round to the coarser lattice of its level.
// The lattice of a level is the global one with 2^levelShift() times its step: coarser lattices are
// subsets of the finer. Border vertices, which other nodes hold too, stay where they are.
#pragma once

#include "hlod/build/assemble.h"
#include "hlod/build/soup.h"

#include <cstdint>
#include <vector>

namespace pagoda::hlod {

// Steps of a level's lattice are 2^levelShift() finest steps: a cell has 2^kLevelBits of them a
// side, or the finest where that has fewer. Follows from the depth alone.
inline constexpr int kLevelBits = 12;
[[nodiscard]] int levelShift(const CellFrame& cell);

struct LevelSnap {
    uint64_t borders = 0;  // vertices with an edge that is not walked as often both ways: fixed
    uint64_t moved = 0;    // vertices that were off their level's lattice and are on it now
    uint64_t kept = 0;     // vertices left off it: see below
};

// Moves every vertex of one node's triangles, all wedges at its place together, to the nearest
// point of the level's lattice, unless
// - it is a border vertex (with `keepBorders`; clustered nodes have none to keep),
// - the point lies outside of `bounds`: the model's box must not grow by it,
// - another vertex of the node stands there already or came first, or
// - a triangle would turn by more than 60 degrees or lose its area.
// So no two places become one and no edge, hence no cut, opens or becomes complex: the surface
// keeps its connections, only its places change. Deterministic: depends on the order of
// `triangles` only.
LevelSnap snapToLevel(std::vector<SoupTriangle>& triangles, const CellFrame& cell,
                      const Box3i& bounds, bool keepBorders);

}  // namespace pagoda::hlod
