// frame_cut.h: the nodes that one frame draws and the nodes it refines.
// Zipper rule: the strip of a pair (A, B) is drawn <=> refined(A) xor refined(B). A leaf
// that is drawn counts as refined; a node below a drawn one does not. Each strip is stored with
// both nodes, so drawing it from the refined side, where refined() of the neighbour is false, draws
// it once. One thread; O(log nodes) a call.
#pragma once

#include "hlod/view/node_tree.h"

#include <map>
#include <span>
#include <vector>

namespace pagoda::hlod {

class FrameCut {
public:
    void clear();
    // The node's children (or what they refine to) stand for it in this frame.
    void refine(const Node& node);
    void draw(const Node& node);

    [[nodiscard]] bool refined(cache::PageId node) const { return refined_.contains(node); }
    // In the order they were drawn.
    [[nodiscard]] std::span<const Node> drawn() const noexcept { return drawn_; }
    // Nodes whose zippers to unrefined neighbours are drawn, by page id.
    [[nodiscard]] const std::map<cache::PageId, Node>& refinedNodes() const noexcept {
        return refined_;
    }

private:
    std::vector<Node> drawn_;
    std::map<cache::PageId, Node> refined_;
};

}  // namespace pagoda::hlod
