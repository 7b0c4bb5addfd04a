// index_packing.h: which node's record goes into which index block.
// A block holds subtrees: it begins with the children of one or more nodes of one other block
// (block 0 with the root) and goes on breadth first below them until it is full. So a block is
// needed by one other block only, what is coarse lies in few blocks, and neighbours at the fringe
// share theirs.
#pragma once

#include "ooc/store/records.h"

#include <cstdint>
#include <vector>

namespace pagoda::ooc {

// Numbers into `nodes`, block by block. Fills in childBlock and childIndex of `nodes`, which are
// the root first and the children of each node side by side (DatabaseWriter::Content); throws
// std::logic_error where they are not. Every child's place comes after its parent's.
[[nodiscard]] std::vector<std::vector<uint32_t>> packIndexBlocks(std::vector<NodeRecord>& nodes,
                                                                 uint32_t maxNodesPerBlock);

}  // namespace pagoda::ooc
