// node_tree.h: the octree as a strategy walks it: over resident index blocks, checked as it goes.
// A block that is broken, or whose records are not the children they should be, ends refinement
// there. Render thread only. Nodes stay valid as long as the index cache.
#pragma once

#include "cache/index_cache.h"
#include "cache/page_id.h"
#include "ooc/store/database.h"

#include <cstdint>
#include <span>

namespace pagoda::hlod {

// One node of one database of the scene. Cheap to copy.
struct Node {
    const ooc::NodeRecord* record = nullptr;
    uint32_t database = 0;

    [[nodiscard]] cache::PageId page() const { return {database, record->id}; }
    [[nodiscard]] bool isLeaf() const { return record->isLeaf(); }
};

class NodeTree {
public:
    // `lattice` is the database's; `index` outlives the tree.
    NodeTree(const ooc::Lattice& lattice, cache::IndexCache& index, uint32_t database = 0)
        : lattice_(lattice), index_(index), database_(database) {}

    // Throws Error when the root's block cannot be read: there is nothing to draw then.
    [[nodiscard]] Node root();
    // The children's records, side by side; octants first, then extra leaves. Empty for a leaf, and
    // for a node whose children cannot be had (the index cache lists why).
    [[nodiscard]] std::span<const ooc::NodeRecord> children(const Node& node);
    [[nodiscard]] Node node(const ooc::NodeRecord& record) const { return {&record, database_}; }
    [[nodiscard]] Box3d boxModel(const Node& node) const {
        return lattice_.toModel(node.record->box);
    }
    [[nodiscard]] const ooc::Lattice& lattice() const noexcept { return lattice_; }

private:
    ooc::Lattice lattice_;
    cache::IndexCache& index_;
    uint32_t database_;
};

}  // namespace pagoda::hlod
