#include "viewer/depth_tests.h"

#include "viewer/stopwatch.h"

namespace pagoda::viewer {

void DepthTests::beginFrame(const hlod::View& view, const FrameTarget& target) {
    view_ = &view;
    target_ = &target;
    ms_ = 0.0;
}

void DepthTests::build() {
    flushDraws_();
    Stopwatch watch;
    target_->readDepths(depths_);
    raster_.setDepths(*view_, depths_);
    ms_ += watch.lapMs();
}

uint64_t DepthTests::visiblePixels(const Box3d& boxModel) {
    Stopwatch watch;
    const uint64_t pixels = raster_.visiblePixels(boxModel);
    ms_ += watch.lapMs();
    return pixels;
}

}  // namespace pagoda::viewer
