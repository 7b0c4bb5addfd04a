// frozen_cut.h: the visible set of one frame, held while the eye goes elsewhere: what was drawn is
// drawn, what was hidden or outside the frustum is not. Render thread only.
#pragma once

#include "hlod/view/frame_cut.h"
#include "hlod/view/strategy.h"

#include <unordered_set>
#include <vector>

namespace pagoda::viewer {

class FrozenCut final : public hlod::Strategy {
public:
    // `cut` of the last frame, as `camera` saw it. Keeps ids and boxes only.
    FrozenCut(const hlod::FrameCut& cut, const hlod::Camera& camera);

    void traverse(hlod::FrameContext& frame) override;

    [[nodiscard]] const hlod::Camera& camera() const noexcept { return camera_; }
    [[nodiscard]] const std::vector<Box3d>& drawnBoxes() const noexcept { return drawnBoxes_; }
    [[nodiscard]] const std::vector<Box3d>& hiddenBoxes() const noexcept { return hiddenBoxes_; }

private:
    using PageSet = std::unordered_set<cache::PageId, cache::PageIdHash>;
    void walk(hlod::FrameContext& frame, const hlod::Node& node);

    hlod::Camera camera_;
    PageSet drawn_, above_;
    std::vector<Box3d> drawnBoxes_, hiddenBoxes_;
};

}  // namespace pagoda::viewer
