#include "viewer/depth_tests.h"

#include "hlod/raster/pushed_depths.h"
#include "viewer/stopwatch.h"

namespace pagoda::viewer {

void DepthTests::beginFrame(const hlod::View& view, const FrameTarget& target,
                            const std::vector<float>* pushes) {
    view_ = &view;
    target_ = &target;
    pushes_ = pushes;
    ms_ = 0.0;
}

void DepthTests::build() {
    flushDraws_();
    Stopwatch watch;
    takeDepths();
    ms_ += watch.lapMs();
}

void DepthTests::visiblePixels(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) {
    Stopwatch watch;
    test(boxesModel, pixels);
    ms_ += watch.lapMs();
}

void CpuDepthTests::takeDepths() {
    target().readDepths(depths_);
    if (pushes() != nullptr) {
        target().readNodeOrdinals(nodeOrdinals_);
        hlod::pushDepths(depths_, nodeOrdinals_, *pushes());
    }
    raster_.setDepths(view(), depths_);
}

}  // namespace pagoda::viewer
