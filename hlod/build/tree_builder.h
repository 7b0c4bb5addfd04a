// tree_builder.h: one piece in memory -> its nodes, bottom up; and the cells above pieces.
// docs/build.md, steps 5 to 8. Free of shared state but for the NodeStore: pieces may be
// built on any number of threads, in any order, and give the same nodes.
#pragma once

#include "hlod/build/assemble.h"
#include "hlod/build/node_store.h"
#include "hlod/build/soup.h"
#include "ooc/lattice.h"

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

struct TreeSettings {
    ooc::Lattice lattice;
    SoupLayout layout;
    uint32_t nodeTriangles = 4096;
    int maxDepth = ooc::kMaxDepth;
    std::vector<bool> isTranslucent;        // by material
    std::vector<uint32_t> materialColours;  // for corners when layout has no colours
};

class TreeBuilder {
public:
    TreeBuilder(const TreeSettings& settings, NodeStore& store)
        : settings_(settings), store_(store) {}

    // `soup`: records of the piece in settings.layout. Builds the whole subtree of `cell`.
    void buildSubtree(ooc::NodeId cell, std::span<const std::byte> soup);
    // Only the extra leaves of a top cell.
    void buildExtraLeaves(ooc::NodeId cell, std::span<const std::byte> soup);
    // A top cell's own node, from its finished children in the store.
    void buildTopNode(ooc::NodeId cell);

    [[nodiscard]] uint64_t bentWedges() const { return bentWedges_.load(); }
    // LevelSnap::kept over all inner nodes.
    [[nodiscard]] uint64_t keptVertices() const { return keptVertices_.load(); }

private:
    struct Subtree {  // what a parent needs of a finished child
        ooc::NodeRecord record;
        std::vector<SoupTriangle> triangles;
        std::vector<SoupTriangle> proxy;  // SimplifyResult::proxy
    };
    using Numbers = std::vector<uint32_t>;

    [[nodiscard]] std::vector<SoupTriangle> unpack(std::span<const std::byte> soup) const;
    [[nodiscard]] CellFrame frameOf(ooc::NodeId cell) const;
    Subtree buildCell(ooc::NodeId cell, std::span<const SoupTriangle> all, Numbers numbers);
    Subtree buildLeaf(ooc::NodeId id, std::span<const SoupTriangle> all, const Numbers& numbers);
    std::vector<Subtree> cutExtraLeaves(ooc::NodeId cell, std::span<const SoupTriangle> all,
                                        const Numbers& numbers);
    Subtree buildInner(ooc::NodeId cell, std::vector<Subtree> children);

    const TreeSettings& settings_;
    NodeStore& store_;
    std::atomic<uint64_t> bentWedges_{0};
    std::atomic<uint64_t> keptVertices_{0};
};

}  // namespace pagoda::hlod
