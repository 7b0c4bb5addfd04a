#include "viewer/window/frozen_cut.h"

namespace pagoda::viewer {

FrozenCut::FrozenCut(const hlod::FrameCut& cut, const hlod::Camera& camera) : camera_(camera) {
    for (const hlod::Node& node : cut.drawn()) {
        drawnBoxes_.push_back(*node.boxModel);
        cache::PageId page = node.page();
        drawn_.insert(page);
        while (page.node != ooc::NodeId::root()) {
            page.node = page.node.parent();
            if (!above_.insert(page).second) break;
        }
    }
    for (const hlod::Node& node : cut.hidden()) hiddenBoxes_.push_back(*node.boxModel);
}

void FrozenCut::traverse(hlod::FrameContext& frame) {
    if (const auto root = frame.tree.root()) walk(frame, *root);
}

void FrozenCut::walk(hlod::FrameContext& frame, const hlod::Node& node) {
    ++frame.record.visitedNodes;
    if (!frame.view.intersectsFrustum(*node.boxModel)) {
        ++frame.record.culledNodes;
        return;
    }
    const cache::PageId page = node.page();
    if (drawn_.contains(page) &&
        frame.sink.want(node, 0.0, hlod::Use::Cut) == cache::PageState::Resident) {
        frame.sink.draw(node, hlod::Use::Cut);
    }
    if (!above_.contains(page)) return;
    // A node that was drawn as a stand-in has others below it that were drawn too.
    if (!drawn_.contains(page)) frame.sink.refine(node);
    const hlod::NodeRange children = frame.tree.children(node);
    for (uint32_t i = 0; i < children.size(); ++i) walk(frame, children[i]);
}

}  // namespace pagoda::viewer
