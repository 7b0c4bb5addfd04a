#include "hlod/view/node_tree.h"

#include "ooc/base/error.h"

#include <string>

namespace pagoda::hlod {
namespace {

// Do `children` carry the ids that the parent's mask promises? Ids grow with depth, so that no set
// of records, however hostile, can lead a traversal in circles.
bool areChildrenOf(const ooc::NodeRecord& parent, std::span<const ooc::NodeRecord> children) {
    if (parent.id.slot() != 0) return false;
    size_t next = 0;
    for (uint32_t octant = 0; octant < 8; ++octant) {
        if (((parent.childMask >> octant) & 1u) == 0) continue;
        if (parent.id.depth() >= ooc::kMaxDepth) return false;
        if (children[next++].id != parent.id.child(octant)) return false;
    }
    for (uint32_t slot = 1; slot <= parent.extraLeafCount(); ++slot) {
        const ooc::NodeRecord& leaf = children[next++];
        if (leaf.id != parent.id.extra(slot) || !leaf.isLeaf()) return false;
    }
    return true;
}

}  // namespace

std::optional<Node> NodeTree::root() {
    const cache::IndexCache::Block* block = index_.block(0);
    if (block != nullptr && !block->index.nodes.empty()) {
        return NodeRange(*block, 0, 1, database_)[0];
    }
    if (block == nullptr && index_.state(0) == cache::IndexCache::BlockState::Absent) return {};
    const std::string why = index_.faults().empty() ? "it is empty" : index_.faults().front().what;
    throw Error("", "index block 0", "the root of the database cannot be read: " + why,
                "build the database again, or fetch it again; `pagoda verify` lists all that "
                "is broken");
}

NodeRange NodeTree::children(const Node& node, double priority) {
    if (node.record->childCount() == 0) return {};
    return childrenIn(index_.block(node.record->childBlock, priority), node);
}

NodeRange NodeTree::residentChildren(const Node& node) {
    if (node.record->childCount() == 0) return {};
    return childrenIn(index_.peek(node.record->childBlock), node);
}

void NodeTree::prefetchChildren(const Node& node, double priority) {
    if (node.record->childCount() > 0) index_.prefetch(node.record->childBlock, priority);
}

// Checked: what is not as the record says is a fault of the block.
NodeRange NodeTree::childrenIn(const cache::IndexCache::Block* block, const Node& node) {
    if (block == nullptr) return {};
    const ooc::NodeRecord& record = *node.record;
    const uint32_t count = record.childCount();
    const size_t available = block->index.nodes.size();
    if (record.childIndex > available || count > available - record.childIndex) {
        index_.reportFault(record.childBlock, "children are beyond the end of the block");
        return {};
    }
    const auto children = std::span(block->index.nodes).subspan(record.childIndex, count);
    if (!areChildrenOf(record, children)) {
        index_.reportFault(record.childBlock, "children do not belong to their parent");
        return {};
    }
    return {*block, record.childIndex, count, database_};
}

}  // namespace pagoda::hlod
