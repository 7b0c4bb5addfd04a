// verify_page.h: one node's page held against its record, as verify.cpp does it on many threads.
#pragma once

#include "ooc/store/database.h"

#include <string>
#include <vector>

namespace pagoda::ooc {

// Triangles of one object in one leaf.
struct ObjectTally {
    uint32_t object = 0;
    uint64_t triangleCount = 0;
    Box3i box{};
};

struct PageFinding {
    std::string fault;                 // empty: sound
    OrderFreeSum triangleSum{};        // leaves only, as all below
    std::vector<ObjectTally> objects;  // ascending ids
};

// `childrenBox` is the union of the children's boxes, empty for a leaf and where they are not
// known: then an inner node's box is not compared.
[[nodiscard]] PageFinding verifyPage(const Database& database, const NodeRecord& node,
                                     const Box3i& childrenBox);

}  // namespace pagoda::ooc
