// depth_tests.h: boxes tested against the depths drawn so far: read back and tested on the CPU, for
// devices whose depth is read as fast as memory (software ones), or reduced and tested on the GPU
// (gpu_depth_tests.h). Render thread only, context current.
#pragma once

#include "hlod/raster/box_raster.h"
#include "hlod/view/visibility.h"
#include "viewer/frame_target.h"

#include <functional>
#include <vector>

namespace pagoda::viewer {

// Where the depth pyramid is.
enum class PyramidPlace { Auto, Cpu, Gpu };  // Auto: CPU on a software renderer, else GPU

struct PyramidOptions {
    PyramidPlace place = PyramidPlace::Auto;
    // Push depths back by the errors of the nodes that drew them (hlod/raster/pushed_depths.h).
    bool pushesOccluders = false;
};

class DepthTests : public hlod::PyramidVisibility {
public:
    // `flushDraws` draws what is still gathered; called before depths are taken.
    explicit DepthTests(std::function<void()> flushDraws) : flushDraws_(std::move(flushDraws)) {}

    // `pushes` grow with the frame: of every node ordinal that is drawn by the time of build(), 0
    // of no node first (hlod/raster/pushed_depths.h); null: depths are taken as they are. All
    // outlive the frame.
    void beginFrame(const hlod::View& view, const FrameTarget& target,
                    const std::vector<float>* pushes);
    void build() final;
    void visiblePixels(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) final;

    [[nodiscard]] double msThisFrame() const noexcept { return ms_; }

protected:
    virtual void takeDepths() = 0;
    virtual void test(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) = 0;
    [[nodiscard]] const hlod::View& view() const { return *view_; }
    [[nodiscard]] const FrameTarget& target() const { return *target_; }
    [[nodiscard]] const std::vector<float>* pushes() const { return pushes_; }

private:
    std::function<void()> flushDraws_;
    const hlod::View* view_ = nullptr;
    const FrameTarget* target_ = nullptr;
    const std::vector<float>* pushes_ = nullptr;
    double ms_ = 0.0;
};

class CpuDepthTests final : public DepthTests {
public:
    using DepthTests::DepthTests;

private:
    void takeDepths() override;
    void test(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) override {
        raster_.visiblePixels(boxesModel, pixels);
    }

    std::vector<float> depths_;
    std::vector<uint32_t> nodeOrdinals_;
    hlod::BoxRaster raster_;
};

}  // namespace pagoda::viewer
