// records.h: what the store keeps of nodes, objects and materials, as plain structs.
// Bytes on disk: ooc/FORMAT.md.
#pragma once

#include "ooc/base/box.h"
#include "ooc/base/hash.h"
#include "ooc/codecs/page_codec.h"
#include "ooc/lattice.h"
#include "ooc/node_id.h"

#include <bit>
#include <cstdint>
#include <string>

namespace pagoda::ooc {

// What a page leaves out, and how its mesh came to be.
enum NodeFlags : uint16_t {
    kNodeHasColours = 1,  // a colour at every vertex; else one for the page
    kNodeHasNormals = 2,  // else triangles are shaded flat
    kNodeHasTranslucent = 4,
    kNodeHasZippers = 8,
    kNodeSloppy = 16,  // parts could not merge: clustered, not closed against its neighbours
    kNodeStuck = 32,   // more triangles than aimed at: locked borders left too little to simplify
};

// One node, as index blocks hold it. A node's children stand side by side in one block.
struct NodeRecord {
    NodeId id{};
    Box3i box{};                 // tight around its mesh and all below it; lattice points
    double errorModelUnits = 0;  // mesh against the input it stands for, both ways; 0 for a leaf
                                 // but for the snap; never below a child's
    uint16_t childMask = 0;      // bits 0..7: octants; bits 8..11: number of extra leaves
    uint16_t flags = 0;          // NodeFlags
    uint32_t triangleCount = 0, opaqueTriangleCount = 0, vertexCount = 0;
    uint32_t pageBytes = 0;
    uint64_t pageOffset = 0;        // in the file
    uint64_t pageChecksum = 0;      // hash64 of the page's bytes
    uint64_t subtreeTriangles = 0;  // in the leaves below (its own for a leaf)
    uint32_t childBlock = 0;        // where the children's records are
    uint32_t childIndex = 0;        // the first of them in that block

    [[nodiscard]] bool isLeaf() const { return childMask == 0; }
    [[nodiscard]] uint32_t extraLeafCount() const { return (childMask >> 8) & 15u; }
    [[nodiscard]] uint32_t childCount() const {
        return static_cast<uint32_t>(std::popcount(static_cast<unsigned>(childMask & 0xFFu))) +
               extraLeafCount();
    }
    // Of the k-th child record, k < childCount(): octants in rising order, then extra leaves 1, 2,
    // ... A reader that follows childBlock and childIndex must find this id there, or the file
    // lies.
    [[nodiscard]] NodeId childId(uint32_t k) const {
        unsigned octants = childMask & 0xFFu;
        for (; octants != 0; octants &= octants - 1, --k) {
            if (k == 0) return id.child(static_cast<uint32_t>(std::countr_zero(octants)));
        }
        return id.extra(k + 1);
    }
};

struct ObjectRecord {
    std::string name{};
    uint32_t parent = UINT32_MAX;  // UINT32_MAX: none
    uint32_t source = 0;           // index into metadata "sources"
    Box3i box{};                   // of its own triangles, lattice; empty when it has none
    uint64_t triangleCount = 0;    // its own, in the leaves
};

struct MaterialRecord {
    std::string name{};
    uint32_t colour = 0xFFFFFFFFu;  // RGBA8 sRGB
    bool isTranslucent = false;
};

struct Header {
    Lattice lattice{};
    Codec codec = Codec::Meshopt;
    uint64_t nodeCount = 0, leafCount = 0;
    uint32_t levelCount = 0;     // of the tree that is drawn: an extra leaf is one below its cell
    uint64_t triangleCount = 0;  // in the leaves
    OrderFreeSum triangleSum{};  // over the leaves' triangles: triangleHashItem()
    uint32_t nodeTriangles = 0;  // the budget N
    uint64_t objectCount = 0, materialCount = 0;
    uint64_t fileBytes = 0;
};

}  // namespace pagoda::ooc
