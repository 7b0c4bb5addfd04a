// frame_runner.h: runs frames: residency, traversal, drawing and tau control in their order, on any
// device. Window, `render`, `bench`, `stress` and tests share it. How a frame flows: docs/frame.md.
// Render thread only.
#pragma once

#include "cache/streaming.h"
#include "hlod/view/device.h"
#include "hlod/view/late_visibility.h"
#include "hlod/view/prefetch.h"
#include "hlod/view/strategy.h"
#include "hlod/view/tau_control.h"

#include <functional>
#include <optional>

namespace pagoda::hlod {

struct FrameOptions {
    double tauPx = 1.0;                 // 0: the leaves
    uint32_t probeLevels = UINT32_MAX;  // FrameContext
    Clip clip{};                        // another set of hidden objects: the strategy forgets
    NodeWatch* watch = nullptr;         // filled in; outlives the frame
};

class FrameRunner {
public:
    // All outlive it. Answers come `queryLatencyFrames` late.
    FrameRunner(cache::Streaming& streaming, NodeTree& tree, Device& device,
                uint32_t queryLatencyFrames = 0);

    // One live frame: what is absent has stand-ins, and is asked for.
    FrameRecord run(const Camera& camera, Strategy& strategy, const FrameOptions& options);
    // Frames of a still camera until nothing is missing and two of them decide the same, or some
    // more draw the same: the last one, with the counts of what was loaded by all. `onFrame` is
    // called after each. Throws Error when not even the root can be drawn for want of memory. A
    // picture that never comes to rest (which no strategy should allow) ends after
    // kMaxSettleFrames, with isSettled false.
    FrameRecord settle(const Camera& camera, Strategy& strategy, const FrameOptions& options,
                       const std::function<void(const FrameRecord&)>& onFrame = {});

    // The strategy forgets, and what it asked here is not answered any more: before it is done away
    // with, or when what it learnt is no longer true.
    void forget(Strategy& strategy);

    // Reads ahead along the camera's motion (prefetch.h). Off at first.
    void setPrefetch(bool isOn) { doesPrefetch_ = isOn; }
    [[nodiscard]] Prefetcher& prefetcher() noexcept { return prefetcher_; }

    // Blocks until the root's record is there. Throws Error when it cannot be read.
    [[nodiscard]] Node root();
    [[nodiscard]] const FrameCut& cut() const noexcept { return cut_; }
    [[nodiscard]] cache::Streaming& streaming() noexcept { return streaming_; }
    [[nodiscard]] NodeTree& tree() noexcept { return tree_; }
    // Of the whole scene; known since root() or the first frame that drew.
    [[nodiscard]] const Box3d& sceneBoxModel() const noexcept { return sceneBox_; }

    static constexpr int kMaxSettleFrames = 1000;

private:
    class Sink;
    struct Progress {
        uint64_t sent = 0, loaded = 0, uploaded = 0, blocks = 0;
        [[nodiscard]] bool operator==(const Progress&) const = default;
    };
    [[nodiscard]] Progress progress();
    [[nodiscard]] double lastCostMs() const;
    void wantRoot(const Node& root);
    [[nodiscard]] bool isSameView(const Camera& camera, const FrameOptions& options) const {
        return lastCamera_ == camera && lastClip_ == options.clip;
    }
    // May what is missing be sent for?
    [[nodiscard]] bool controlTau(const Camera& camera, const Strategy& strategy,
                                  const FrameOptions& options);
    struct Counts {
        cache::Residency::Counters pages;
        cache::PrefetchCount prefetchedBlocks;
    };
    [[nodiscard]] Counts counts() const;
    void account(FrameRecord& record, const Counts& before);

    cache::Streaming& streaming_;
    NodeTree& tree_;
    Device& device_;
    LateVisibility late_;
    TauControl tauControl_;
    Prefetcher prefetcher_;
    bool doesPrefetch_ = false;
    FrameCut cut_;
    Box3d sceneBox_;
    std::optional<Camera> lastCamera_;
    Clip lastClip_;
    Progress lastProgress_;
    std::optional<FrameRecord> lastRecord_;
    uint64_t lastToldHash_ = 0, lastDrawnHash_ = 0;
    uint64_t uploadedWhenItFitted_ = 0;  // bytes ever, when the cut last did
    bool hasLearnt_ = false;             // since then
    int framesWithoutProgress_ = 0, framesDrawnTheSame_ = 0;
    double frameMs_ = 0.0;  // of the last frame: what a late answer's frame would have taken
};

}  // namespace pagoda::hlod
