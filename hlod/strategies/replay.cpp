#include "hlod/strategies/replay.h"

namespace pagoda::hlod {

ReplayStrategy::ReplayStrategy(const FrameCut& cut) {
    const auto addAncestors = [&](cache::PageId page) {
        while (page.node != ooc::NodeId::root()) {
            page.node = page.node.parent();
            if (!above_.insert(page).second) return;
        }
    };
    for (const Node& node : cut.drawn()) addAncestors(node.page());
    for (const Node& node : cut.hidden()) {
        addAncestors(node.page());
        hidden_.insert(node.page());
    }
    for (const Node& node : cut.drawn()) {
        (above_.contains(node.page()) ? overdrawn_ : drawn_).insert(node.page());
    }
}

void ReplayStrategy::traverse(FrameContext& frame) {
    if (const auto root = frame.tree.root()) walk(frame, *root, false);
}

void ReplayStrategy::walk(FrameContext& frame, const Node& node, bool isBelowHidden) {
    if (!frame.view.intersectsFrustum(*node.boxModel)) return;
    const cache::PageId page = node.page();
    const bool isHidden = isBelowHidden || hidden_.contains(page);
    const double ssePx = frame.view.ssePx(node.record->errorModelUnits, *node.boxModel);
    const bool isFine = node.isLeaf() || (frame.tauPx > 0.0 && ssePx <= frame.tauPx);
    if (drawn_.contains(page) || (isHidden && isFine)) {
        if (frame.sink.want(node, 0.0, Use::Cut) == cache::PageState::Resident) {
            frame.sink.draw(node, Use::Cut);
        }
        return;
    }
    if (!isHidden && !above_.contains(page)) return;
    frame.sink.refine(node);
    const NodeRange children = frame.tree.children(node);
    for (uint32_t i = 0; i < children.size(); ++i) walk(frame, children[i], isHidden);
}

}  // namespace pagoda::hlod
