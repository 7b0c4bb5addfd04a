// renderer.h: takes a camera, a scene and budgets; gives a picture and a frame record. Window,
// `render`, `bench` and tests share it. How a frame flows: docs/frame.md. Render thread only,
// context current.
#pragma once

#include "cache/clock.h"
#include "cache/disk_loads.h"
#include "cache/streaming.h"
#include "hlod/view/frame_runner.h"
#include "viewer/gl_device.h"

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace pagoda::viewer {

struct RenderOptions {
    double tauPx = 1.0;  // 0: the leaves
    Background background{};
    Vec3f worldUp{0, 1, 0};  // where the sky is
    hlod::Clip clip{};       // what is left out
    hlod::NodeWatch* watch = nullptr;
};

// How the run time is set up.
struct RendererOptions {
    uint64_t hostBytes = uint64_t{256} << 20;  // at least 4 MiB
    uint64_t gpuBytes = uint64_t{1} << 30;     // at least 1 MiB
    uint64_t uploadBytesPerFrame = 0;          // 0: no bound
    uint32_t queryLatencyFrames = 0;
    PyramidOptions pyramid{};
    bool doesPrefetch = false;  // along the camera's motion
    hlod::PrefetchReasons prefetchReasons = hlod::PrefetchReasons().set();
    cache::DiskProfile disk{};      // simulated in front of the real one
    cache::Clock* clock = nullptr;  // outlives the renderer; null: the wall's
    size_t loaderThreads = 2;
    cache::LoadQueue* loads = nullptr;  // outlives the renderer; null: its own threads and `disk`
};

class Renderer {
public:
    // `source` outlives it. Throws Error when the root cannot be read or memory is short.
    Renderer(const ooc::Lattice& lattice, const cache::PageSource& source,
             const RendererOptions& options);

    [[nodiscard]] Box3d sceneBox() const { return runner_.sceneBoxModel(); }

    // One live frame: ancestors stand in for what is absent. When the cut does not fit the GPU
    // budget, tau rises until it does (record.effectiveTauPx). Pages and blocks that fail are
    // listed in record.faults; ancestors stand in for good.
    hlod::FrameRecord renderLive(const hlod::Camera& camera, hlod::Strategy& strategy,
                                 const RenderOptions& options);
    // The settled frame: waits until all that it wants is there (FrameRunner::settle).
    hlod::FrameRecord render(const hlod::Camera& camera, hlod::Strategy& strategy,
                             const RenderOptions& options,
                             const std::function<void(const hlod::FrameRecord&)>& onFrame = {});
    // All leaves inside the frustum, streamed once (those with translucent triangles twice): pages
    // are drawn and dropped whenever they fill the GPU budget, so memory does not grow with the
    // model. A leaf that fails is listed and missing. `onBatch` is called after each batch. Drops
    // what is resident.
    hlod::FrameRecord renderReference(const hlod::Camera& camera, const RenderOptions& options,
                                      const std::function<void()>& onBatch = {});

    // Another simulated disk for what is read from now on. False, and nothing changes, when none
    // stands in front of the real one.
    [[nodiscard]] bool setDisk(const cache::DiskProfile& disk);

    // The last frame's picture; fills in record.coveredPixels and fallbackPixels.
    [[nodiscard]] Picture read(hlod::FrameRecord& record);
    [[nodiscard]] hlod::FrameRunner& runner() noexcept { return runner_; }
    [[nodiscard]] GlDevice& device() noexcept { return device_; }

private:
    cache::WallClock wallClock_;
    cache::Clock& clock_;
    const cache::PageSource& source_;
    GlDevice device_;
    cache::DiskLoads* disk_ = nullptr;            // of `ownLoads_`; null: as it is
    std::unique_ptr<cache::LoadQueue> ownLoads_;  // null: the options' are used
    cache::Streaming streaming_;
    hlod::NodeTree tree_;
    hlod::FrameRunner runner_;
};

}  // namespace pagoda::viewer
