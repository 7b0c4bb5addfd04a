// The plainest strategy and every other one's yardstick: refine while the screen-space error is
// above tau, leave out what lies outside the frustum. Depth first, children in record order.
#include "hlod/strategies/node_memory.h"
#include "hlod/strategies/strategies.h"

#include <algorithm>
#include <vector>

namespace pagoda::hlod {
namespace {

class FrustumStrategy final : public Strategy {
public:
    void traverse(FrameContext& frame) override {
        ++frame_;
        told_.clear();
        const auto root = frame.tree.root();
        if (!root) return;
        memory_.fit(frame.tree);
        ++frame.record.visitedNodes;
        if (!frame.view.intersectsFrustum(*root->boxModel)) {
            ++frame.record.culledNodes;
            return;
        }
        // A root that cannot be had leaves nothing to stand in: nothing is drawn.
        static_cast<void>(cover(frame, *root, 1.0));
        for (const Step& step : told_) tell(frame.sink, step);
    }
    void forget() override { memory_.clear(); }

private:
    enum class What { Refine, Draw, StandIn };
    struct Step {
        Node node;
        What what;
    };
    struct Memory {
        uint64_t refinedFrame = 0;
    };
    enum class Cover { Whole, Absent, Failed };

    static void tell(FrameSink& sink, const Step& step) {
        if (step.what == What::Refine) {
            sink.refine(step.node);
            sink.keep(step.node);
        } else {
            sink.draw(step.node, step.what == What::Draw ? Use::Cut : Use::StandIn);
        }
    }

    // Pixels of the box's outline, roughly: a ball of its diagonal, not clipped.
    static double roughPixels(const View& view, const Node& node) {
        const Box3d& box = *node.boxModel;
        const double diagonal = glm::length(box.max - box.min);
        const double sidePx = view.ssePx(diagonal, box);
        return std::min(sidePx * sidePx, 1.0 * view.camera().widthPx * view.camera().heightPx);
    }

    // Appends steps that cover the node's part of the frustum; asks for what is absent, all the way
    // down. Not Whole, and nothing is appended, when no resident page can: an ancestor stands in.
    Cover cover(FrameContext& frame, const Node& node, double excess) {
        const double ssePx = frame.view.ssePx(node.record->errorModelUnits, *node.boxModel);
        const double priority = requestPriority(roughPixels(frame.view, node), excess);
        if (!node.isLeaf() && !(frame.tauPx > 0.0 && ssePx <= frame.tauPx)) {
            const double below = frame.tauPx > 0.0 ? ssePx / frame.tauPx : ssePx;
            if (coverByChildren(frame, node, below)) return Cover::Whole;
            return drawSelf(frame, node, priority, What::StandIn);
        }
        return drawSelf(frame, node, priority, What::Draw);
    }

    Cover drawSelf(FrameContext& frame, const Node& node, double priority, What what) {
        const Use use = what == What::Draw ? Use::Cut : Use::StandIn;
        const cache::PageState state = frame.sink.want(node, priority, use);
        if (state == cache::PageState::Resident) {
            told_.push_back({node, what});
            return Cover::Whole;
        }
        return state == cache::PageState::Failed ? Cover::Failed : Cover::Absent;
    }

    bool coverByChildren(FrameContext& frame, const Node& node, double excess) {
        const NodeRange children = frame.tree.children(node, excess);
        if (children.empty()) return false;
        const size_t begin = told_.size();
        told_.push_back({node, What::Refine});
        bool isWhole = true, isFailed = false;
        for (uint32_t i = 0; i < children.size(); ++i) {
            const Node child = children[i];
            ++frame.record.visitedNodes;
            if (!frame.view.intersectsFrustum(*child.boxModel)) {
                ++frame.record.culledNodes;
                continue;
            }
            const Cover covered = cover(frame, child, excess);
            isWhole = isWhole && covered == Cover::Whole;
            isFailed = isFailed || covered == Cover::Failed;
        }
        Memory& memory = memory_[node];
        const bool wasRefined = memory.refinedFrame + 1 == frame_;
        if (!isWhole && (isFailed || !wasRefined ||
                         frame.sink.want(node, 0.0, Use::StandIn) != cache::PageState::Resident)) {
            told_.resize(begin);
            return false;
        }
        memory.refinedFrame = frame_;
        if (!isWhole) told_.push_back({node, What::StandIn});
        return true;
    }

    std::vector<Step> told_;
    NodeMemory<Memory> memory_;
    uint64_t frame_ = 1;  // of this strategy: memories of 0 are of no frame
};

}  // namespace

std::unique_ptr<Strategy> makeFrustumStrategy(const StrategyOptions&) {
    return std::make_unique<FrustumStrategy>();
}

}  // namespace pagoda::hlod
