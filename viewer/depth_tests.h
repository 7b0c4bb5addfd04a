// depth_tests.h: boxes tested on the CPU against the depths drawn so far. For devices whose depth
// is read as fast as memory (software ones). Render thread only, context current.
#pragma once

#include "hlod/raster/box_raster.h"
#include "hlod/view/visibility.h"
#include "viewer/frame_target.h"

#include <functional>
#include <vector>

namespace pagoda::viewer {

class DepthTests final : public hlod::PyramidVisibility {
public:
    // `flushDraws` draws what is still gathered; called before depths are read.
    explicit DepthTests(std::function<void()> flushDraws) : flushDraws_(std::move(flushDraws)) {}

    // Both outlive the frame.
    void beginFrame(const hlod::View& view, const FrameTarget& target);
    void build() override;
    [[nodiscard]] uint64_t visiblePixels(const Box3d& boxModel) override;

    [[nodiscard]] double msThisFrame() const noexcept { return ms_; }

private:
    std::function<void()> flushDraws_;
    const hlod::View* view_ = nullptr;
    const FrameTarget* target_ = nullptr;
    std::vector<float> depths_;
    hlod::BoxRaster raster_;
    double ms_ = 0.0;
};

}  // namespace pagoda::viewer
