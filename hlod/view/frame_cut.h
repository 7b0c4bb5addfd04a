// frame_cut.h: what one frame draws, refines and hides.
// Zipper rule: the strip of a pair (A, B) is drawn <=> refined(A) xor refined(B). A leaf
// that is drawn counts as refined; a node below a drawn one does not. Each strip is stored with
// both nodes, so drawing it from the refined side, where refined() of the neighbour is false, draws
// it once. Only nodes that have zippers are kept as refined. One thread.
#pragma once

#include "hlod/view/node_tree.h"

#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

namespace pagoda::hlod {

class FrameCut {
public:
    void clear();
    // The node's children (or what they refine to) stand for it in this frame.
    void refine(const Node& node);
    void draw(const Node& node, bool isStandIn = false);
    void hide(const Node& node);

    // In the order they were drawn. A stand-in may be the ancestor of others.
    [[nodiscard]] std::span<const Node> drawn() const noexcept { return drawn_; }
    [[nodiscard]] std::span<const uint8_t> drawnAsStandIn() const noexcept { return isStandIn_; }
    // Together with what is drawn these cover all that meets the frustum.
    [[nodiscard]] std::span<const Node> hidden() const noexcept { return hidden_; }
    // Of nodes that have zippers.
    [[nodiscard]] bool refined(cache::PageId node) const { return refined_.contains(node); }
    // Nodes whose zippers to unrefined neighbours are drawn.
    [[nodiscard]] std::span<const Node> zipped() const noexcept { return zipped_; }
    // Of what is drawn, whatever the order: equal for frames that draw the same nodes.
    [[nodiscard]] uint64_t drawnHash() const noexcept { return drawnHash_; }
    // Of all that was refined, drawn and hidden, in its order: equal for frames in which a strategy
    // took the same decisions, so that the next one will do the same.
    [[nodiscard]] uint64_t toldHash() const noexcept { return toldHash_; }

private:
    void tell(const Node& node, uint64_t what);

    std::vector<Node> drawn_, hidden_, zipped_;
    std::vector<uint8_t> isStandIn_;
    std::unordered_set<cache::PageId, cache::PageIdHash> refined_;
    uint64_t drawnHash_ = 0, toldHash_ = 0;
};

}  // namespace pagoda::hlod
