// partition.h: cuts the Morton order of all triangles into pieces that fit in memory, and moves
// every triangle to its piece in scratch. docs/build.md, step 4.
//
// A piece is the whole subtree of one cell, with at most `pieceTriangles` triangles unless the cell
// has the greatest depth. Cells above pieces are the top: built last, from the pieces' finished
// roots. A triangle too long for the children of a top cell (homeDepth) stays there, in a piece of
// its own kind and of any size. Pieces, and the order of triangles in them, which is the input's,
// depend on the input alone, never on the memory budget or the number of threads.
#pragma once

#include "hlod/build/intake.h"
#include "ooc/node_id.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace pagoda::hlod {

// Fits the least memory budget (256 MiB): 64 bytes a triangle, twice for the two threads of the
// least machine, beside one node's working set each.
inline constexpr uint64_t kPieceTriangles = uint64_t{1} << 19;

struct Piece {
    ooc::NodeId cell;
    bool isExtra = false;  // only the extra leaves of `cell`, which is a top cell
    uint64_t firstTriangle = 0, triangleCount = 0;  // in `file`
    uint32_t file = 0;
};

struct Partition {
    std::vector<File> files;
    std::vector<Piece> pieces;          // Morton order, extra leaves before children; none empty
    std::vector<ooc::NodeId> topCells;  // parents before children
    int maxDepth = 0;                   // of any cell: min(kMaxDepth, extentBits)
    uint64_t scratchBytes = 0;
};

// Consumes the spill of `intake`. `pieceTriangles` (kPieceTriangles, but for tests) counts for no
// less than `nodeTriangles`. No triangles give no pieces.
[[nodiscard]] Partition partitionTriangles(Intake& intake, const ooc::Lattice& lattice,
                                           const std::filesystem::path& scratchFolder,
                                           uint64_t pieceTriangles, uint32_t nodeTriangles,
                                           Progress& progress);

}  // namespace pagoda::hlod
