// replay.h: draws the cut that another strategy drew in a frame, without culling: the truth that
// its pixels are held against, zippers and all. What it hid is drawn by its own cut at tau. Nodes
// that were drawn although something below them was drawn or hidden too (RARN, stand-ins) are left
// out. Not in the table of strategies.
#pragma once

#include "hlod/view/frame_cut.h"
#include "hlod/view/strategy.h"

#include <unordered_set>

namespace pagoda::hlod {

class ReplayStrategy final : public Strategy {
public:
    // Keeps ids only.
    explicit ReplayStrategy(const FrameCut& cut);
    void traverse(FrameContext& frame) override;

    // Nodes that the cut drew and the replay does not.
    [[nodiscard]] const std::unordered_set<cache::PageId, cache::PageIdHash>& overdrawn() const {
        return overdrawn_;
    }

private:
    using PageSet = std::unordered_set<cache::PageId, cache::PageIdHash>;
    void walk(FrameContext& frame, const Node& node, bool isBelowHidden);

    PageSet drawn_, hidden_, above_, overdrawn_;
};

}  // namespace pagoda::hlod
