// node_tree.h: the octree as a strategy walks it: over resident index blocks, checked as it goes.
// A block that is absent is asked for; one that is broken, or whose records are not the children
// they should be, ends refinement there. Render thread only. Nodes are valid within one frame.
#pragma once

#include "cache/index_cache.h"
#include "cache/page_id.h"
#include "ooc/store/database.h"

#include <cstdint>
#include <optional>

namespace pagoda::hlod {

// One node of one database of the scene. Cheap to copy.
struct Node {
    const ooc::NodeRecord* record = nullptr;
    const Box3d* boxModel = nullptr;
    uint32_t database = 0;
    uint32_t slot = 0;  // small; its own while its index block is resident (compare `page()`)

    [[nodiscard]] cache::PageId page() const { return {database, record->id}; }
    [[nodiscard]] bool isLeaf() const { return record->isLeaf(); }
};

// The children of a node, side by side: octants first, then extra leaves.
class NodeRange {
public:
    NodeRange() = default;
    NodeRange(const cache::IndexCache::Block& block, uint32_t first, uint32_t count,
              uint32_t database)
        : block_(&block), first_(first), count_(count), database_(database) {}

    [[nodiscard]] uint32_t size() const noexcept { return count_; }
    [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
    [[nodiscard]] Node operator[](uint32_t i) const {
        return {&block_->index.nodes[first_ + i], &block_->boxesModel[first_ + i], database_,
                block_->firstSlot + first_ + i};
    }

private:
    const cache::IndexCache::Block* block_ = nullptr;
    uint32_t first_ = 0, count_ = 0, database_ = 0;
};

class NodeTree {
public:
    // `lattice` is the database's; `index` outlives the tree.
    NodeTree(const ooc::Lattice& lattice, cache::IndexCache& index, uint32_t database = 0)
        : lattice_(lattice), index_(index), database_(database) {}

    // Nothing while its block is on its way. Throws Error when that cannot be read: there is
    // nothing to draw then.
    [[nodiscard]] std::optional<Node> root();
    // Empty for a leaf, and for a node whose children cannot be had: their block is on its way
    // (`priority` as in FrameSink::want), or broken (the index cache lists why).
    [[nodiscard]] NodeRange children(const Node& node, double priority = 0.0);
    // The same, but what is not there is not asked for, and what is there is not used.
    [[nodiscard]] NodeRange residentChildren(const Node& node);
    // Asks for the block of its children, if that is absent, after everything that is wanted.
    void prefetchChildren(const Node& node, double priority);
    [[nodiscard]] const ooc::Lattice& lattice() const noexcept { return lattice_; }
    // Slots of nodes are below this.
    [[nodiscard]] uint32_t slotCount() const noexcept { return index_.slotCount(); }

private:
    [[nodiscard]] NodeRange childrenIn(const cache::IndexCache::Block* block, const Node& node);

    ooc::Lattice lattice_;
    cache::IndexCache& index_;
    uint32_t database_;
};

}  // namespace pagoda::hlod
