// node_memory.h: what a strategy remembers of nodes from frame to frame, found by slot and checked
// by id: a slot may have got another owner. One thread.
#pragma once

#include "hlod/view/node_tree.h"

#include <vector>

namespace pagoda::hlod {

// `Memory` is default-constructible.
template <typename Memory>
class NodeMemory {
public:
    // Makes place for all slots of the tree. References stay valid until the next call.
    void fit(const NodeTree& tree) {
        if (entries_.size() < tree.slotCount()) entries_.resize(tree.slotCount());
    }
    [[nodiscard]] Memory& operator[](const Node& node) {
        Entry& entry = entries_[node.slot];
        if (entry.page != node.page()) entry = {node.page(), {}};
        return entry.memory;
    }
    // Null when the slot's memory is of another page.
    [[nodiscard]] Memory* find(uint32_t slot, cache::PageId page) {
        if (slot >= entries_.size() || entries_[slot].page != page) return nullptr;
        return &entries_[slot].memory;
    }
    void clear() { entries_.clear(); }

private:
    struct Entry {
        cache::PageId page{UINT32_MAX, {}};
        Memory memory{};
    };
    std::vector<Entry> entries_;
};

}  // namespace pagoda::hlod
