// The plainest strategy and every other one's yardstick: refine while the screen-space error is
// above tau, leave out what lies outside the frustum. Depth first, children in record order.
#include "hlod/strategies/strategies.h"

#include <vector>

namespace pagoda::hlod {
namespace {

class FrustumStrategy final : public Strategy {
public:
    bool traverse(FrameContext& frame) override {
        told_.clear();
        hasRoom_ = true;
        const Node root = frame.tree.root();
        ++frame.record.visitedNodes;
        if (!frame.view.intersectsFrustum(frame.tree.boxModel(root))) {
            ++frame.record.culledNodes;
            return true;
        }
        // A root that cannot be had leaves nothing to stand in: its fault is listed, nothing is
        // drawn.
        static_cast<void>(cover(frame, root));
        if (!hasRoom_) return false;
        for (const Step& step : told_) {
            if (step.isRefined) {
                frame.sink.refine(step.node);
            } else {
                frame.sink.draw(step.node);
            }
        }
        return true;
    }

private:
    struct Step {
        Node node;
        bool isRefined;
    };

    // Appends steps that cover the node's part of the frustum. False, and nothing is appended, when
    // no resident page can: the parent stands in then.
    bool cover(FrameContext& frame, const Node& node) {
        const double ssePx =
            frame.view.ssePx(node.record->errorModelUnits, frame.tree.boxModel(node));
        const bool isFine = node.isLeaf() || (frame.tauPx > 0.0 && ssePx <= frame.tauPx);
        if (!isFine) {
            if (coverByChildren(frame, node)) return true;
            if (!hasRoom_) return false;
        }
        const cache::PageState state = frame.sink.want(node, ssePx);
        hasRoom_ = state != cache::PageState::NoRoom;
        if (state != cache::PageState::Resident) return false;
        if (!isFine) ++frame.record.standIns;
        told_.push_back({node, false});
        return true;
    }

    bool coverByChildren(FrameContext& frame, const Node& node) {
        const auto children = frame.tree.children(node);
        if (children.empty()) return false;
        const size_t begin = told_.size();
        told_.push_back({node, true});
        for (const ooc::NodeRecord& record : children) {
            const Node child = frame.tree.node(record);
            ++frame.record.visitedNodes;
            if (!frame.view.intersectsFrustum(frame.tree.boxModel(child))) {
                ++frame.record.culledNodes;
            } else if (!cover(frame, child)) {
                told_.resize(begin);
                return false;
            }
        }
        return true;
    }

    std::vector<Step> told_;
    bool hasRoom_ = true;
};

}  // namespace

std::unique_ptr<Strategy> makeFrustumStrategy() {
    return std::make_unique<FrustumStrategy>();
}

}  // namespace pagoda::hlod
