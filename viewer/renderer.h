// renderer.h: takes a camera, a scene and budgets; gives a picture and a frame record. Window,
// `render`, `bench` and tests share it. How a frame flows: docs/frame.md. Render thread only,
// context current.
#pragma once

#include "cache/index_cache.h"
#include "cache/residency.h"
#include "hlod/view/frame_cut.h"
#include "hlod/view/frame_record.h"
#include "hlod/view/strategy.h"
#include "viewer/frame_target.h"
#include "viewer/mesh_store.h"
#include "viewer/node_drawer.h"

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace pagoda::viewer {

struct RenderOptions {
    double tauPx = 1.0;  // 0: the leaves
    Background background;
    Vec3f worldUp{0, 1, 0};  // where the sky is
};

class Renderer {
public:
    struct Budgets {
        uint64_t hostBytes = uint64_t{256} << 20;
        uint64_t gpuBytes = uint64_t{1} << 30;  // at least 1 MiB
    };

    // `source` outlives it. Throws Error when the root cannot be read or memory is short.
    Renderer(const ooc::Lattice& lattice, cache::PageSource& source, Budgets budgets);

    [[nodiscard]] Box3d sceneBox();

    // One frame of the strategy's cut. When it does not fit the GPU budget, tau is raised until it
    // does (record.effectiveTauPx). Pages and blocks that fail are listed in record.faults;
    // ancestors stand in.
    hlod::FrameRecord render(const hlod::Camera& camera, hlod::Strategy& strategy,
                             const RenderOptions& options);
    // All leaves inside the frustum, streamed once (those with translucent triangles twice): pages
    // are drawn and dropped whenever they fill the GPU budget, so memory does not grow with the
    // model. A leaf that fails is listed and missing. `onBatch` is called after each batch.
    hlod::FrameRecord renderReference(const hlod::Camera& camera, const RenderOptions& options,
                                      const std::function<void()>& onBatch = {});

    // The last frame's picture; fills in record.coveredPixels.
    [[nodiscard]] Picture read(hlod::FrameRecord& record);

private:
    class Sink;

    void beginFrame(const hlod::View& view, const RenderOptions& options);
    [[nodiscard]] bool traverse(const hlod::View& view, hlod::Strategy& strategy,
                                hlod::FrameRecord& record);
    void drawFrame(const hlod::View& view, std::span<const hlod::Node> nodes,
                   hlod::FrameRecord& record, const std::function<void()>& onBatch);
    void drawOpaque(std::span<const hlod::Node> nodes, hlod::FrameRecord& record,
                    const std::function<void()>& onBatch);
    void drawZippers(hlod::FrameRecord& record);
    void drawTranslucent(const hlod::View& view, std::span<const hlod::Node> nodes,
                         hlod::FrameRecord& record, const std::function<void()>& onBatch);
    void drawInBatches(std::span<const hlod::Node> nodes, std::span<const uint32_t> order,
                       const std::function<void(std::span<const DrawItem>)>& draw,
                       const std::function<void()>& onBatch);
    void finish(hlod::FrameRecord& record, const cache::Residency::Counters& before);

    MeshStore store_;
    cache::Residency residency_;
    cache::IndexCache index_;
    hlod::NodeTree tree_;
    NodeProgram program_;
    NodeDrawer drawer_;
    std::unique_ptr<FrameTarget> target_;
    hlod::FrameCut cut_;
    std::vector<ooc::NodeId> ordinals_;  // node of ordinal i + 1
    double nearModelUnits_ = 1.0;
    uint64_t frameIndex_ = 0;
    std::vector<std::string> drawFaults_;  // of this frame, beside those of residency and index
};

}  // namespace pagoda::viewer
