#include "hlod/view/frame_runner.h"

#include "ooc/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>

namespace pagoda::hlod {
namespace {

// Without progress for so many frames, what is missing will not come by waiting.
constexpr int kStuckFrames = 3;
// Predictions may come and go for ever while what is drawn is the same: so many frames of it will
// do. Measured: what changed the picture once more did so within three.
constexpr int kSteadyFrames = 6;
// Above what any picture's pixels give.
constexpr double kRootPriority = 1e18;
// A strategy that still changes its mind when nothing has been missing for so many frames will not
// come to rest.
constexpr int kRestlessFrames = 24;
// Visible pixels x excess error, at most so many times the pixels (measured: docs/decisions.md).
constexpr double kMaxExcess = 4.0;

double nowMs() {
    return std::chrono::duration<double, std::milli>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

double processCpuMs() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

}  // namespace

double requestPriority(double visiblePx, double excessError) {
    return visiblePx * std::clamp(excessError, 1.0, kMaxExcess);
}

// Hears the strategy: pages go to the cache, draws to the device, all of it into the cut.
class FrameRunner::Sink final : public FrameSink {
public:
    Sink(FrameRunner& runner, FrameRecord& record, NodeWatch* watch)
        : runner_(runner),
          residency_(runner.streaming_.residency()),
          record_(record),
          watch_(watch) {}

    cache::PageState state(const Node& node) const override {
        return residency_.state(node.page(), node.slot);
    }
    cache::PageState want(const Node& node, double priority, Use use) override {
        if (isWatched(node)) {
            watch_->wantedFrame = record_.frameIndex;
            watch_->priority = priority;
        }
        const cache::PageState state =
            residency_.want({node.page(), *node.record, priority, node.slot}, use == Use::StandIn);
        if (runner_.doesPrefetch_) {
            runner_.prefetcher_.noteWant(node, state == cache::PageState::Resident);
        }
        return state;
    }
    void keep(const Node& node) override { residency_.keep(node.page(), node.slot); }
    void refine(const Node& node) override {
        if (isWatched(node)) watch_->refinedFrame = record_.frameIndex;
        runner_.cut_.refine(node);
        if (runner_.doesPrefetch_) runner_.prefetcher_.noteRefined(node);
        // A refined node is not drawn, but its zippers to unrefined neighbours are.
        if ((node.record->flags & ooc::kNodeHasZippers) != 0) want(node, 0.0, Use::Cut);
    }
    void draw(const Node& node, Use use) override {
        if (isWatched(node)) {
            (use == Use::Cut ? watch_->drawnFrame : watch_->standInFrame) = record_.frameIndex;
        }
        runner_.cut_.draw(node, use == Use::StandIn);
        record_.standIns += use == Use::StandIn;
        if (runner_.doesPrefetch_ && use == Use::Cut) runner_.prefetcher_.noteDrawn(node);
        runner_.device_.draw(node);
    }
    void hide(const Node& node) override {
        if (isWatched(node)) watch_->hiddenFrame = record_.frameIndex;
        runner_.cut_.hide(node);
        if (runner_.doesPrefetch_) runner_.prefetcher_.noteHidden(node);
        ++record_.hiddenNodes;
    }
    CountingVisibility* counting() override {
        return runner_.device_.counting() != nullptr ? &runner_.late_ : nullptr;
    }
    PyramidVisibility* pyramid() override { return runner_.device_.pyramid(); }

private:
    [[nodiscard]] bool isWatched(const Node& node) const {
        return watch_ != nullptr && watch_->page == node.page();
    }

    FrameRunner& runner_;
    cache::Residency& residency_;
    FrameRecord& record_;
    NodeWatch* watch_;
};

FrameRunner::FrameRunner(cache::Streaming& streaming, NodeTree& tree, Device& device,
                         uint32_t queryLatencyFrames)
    : streaming_(streaming), tree_(tree), device_(device), late_(queryLatencyFrames) {
}

Node FrameRunner::root() {
    while (true) {
        streaming_.beginFrame();
        const auto root = tree_.root();
        streaming_.endFrame();
        if (root) {
            sceneBox_ = *root->boxModel;
            return *root;
        }
        static_cast<void>(streaming_.waitForArrival());
    }
}

FrameRunner::Progress FrameRunner::progress() {
    const cache::Residency::Counters& counters = streaming_.residency().counters();
    return {streaming_.requests().counters().sent, counters.loadedPages + counters.failedPages,
            counters.uploadedPages, streaming_.index().loadedBlocks()};
}

void FrameRunner::forget(Strategy& strategy) {
    strategy.forget();
    late_.abandonAll();
}

double FrameRunner::lastCostMs() const {
    if (!lastRecord_) return 0.0;
    return (device_.drawsOnCpu() ? lastRecord_->cpuMs : lastRecord_->frameMs) +
           lastRecord_->simulatedStallMs;
}

FrameRecord FrameRunner::run(const Camera& camera, Strategy& strategy,
                             const FrameOptions& options) {
    const double beginMs = nowMs(), beginCpuMs = processCpuMs();
    const Counts before = counts();
    FrameRecord record;
    streaming_.beginFrame();
    record.frameIndex = streaming_.frameIndex();
    record.tauPx = options.tauPx;
    record.effectiveTauPx = tauControl_.effectiveTauPx(options.tauPx);
    cut_.clear();
    if (const auto root = tree_.root()) {
        sceneBox_ = *root->boxModel;
        wantRoot(*root);
    }
    const View view(camera, sceneBox_, options.clip);
    if (lastClip_.hidden != options.clip.hidden) forget(strategy);
    record.streamMs = nowMs() - beginMs;

    const double traverseBeginMs = nowMs();
    device_.beginFrame(view);
    late_.beginFrame(device_.counting());
    Sink sink(*this, record, options.watch);
    FrameContext frame{view,
                       tree_,
                       record.effectiveTauPx,
                       record.frameIndex,
                       sink,
                       record,
                       lastRecord_ ? &*lastRecord_ : nullptr,
                       isSameView(camera, options),
                       options.probeLevels,
                       lastCostMs(),
                       options.watch};
    if (doesPrefetch_) prefetcher_.beginFrame(record.frameIndex, tree_);
    strategy.traverse(frame);
    const double traversedMs = nowMs();
    device_.endFrame(cut_, record);
    // What the device did until here is its own.
    record.traverseMs =
        std::max(0.0, traversedMs - traverseBeginMs - record.queryMs - record.drawMs);
    const double drawnMs = nowMs();
    record.drawMs += drawnMs - traversedMs;

    const bool maySend = controlTau(camera, strategy, options);
    if (doesPrefetch_) {
        prefetcher_.run(view, sceneBox_, record.effectiveTauPx, tree_, streaming_.residency());
        record.prefetchOff = prefetcher_.offText();
    }
    streaming_.endFrame(!maySend);
    record.streamMs += nowMs() - drawnMs;
    record.simulatedStallMs = static_cast<double>(late_.stalledFrames()) * frameMs_;
    frameMs_ = record.frameMs = nowMs() - beginMs;
    record.cpuMs = processCpuMs() - beginCpuMs;
    record.widthPx = camera.widthPx;
    record.heightPx = camera.heightPx;
    account(record, before);
    const bool isComplete = record.missingPages == 0 && !tauControl_.isMoving();
    const bool drawsTheSame =
        isSameView(camera, options) && isComplete && lastDrawnHash_ == cut_.drawnHash();
    framesDrawnTheSame_ = drawsTheSame ? framesDrawnTheSame_ + 1 : 0;
    // A stand-in may hide what it stands for, which is not asked for then: until the next frame.
    const bool decidesTheSame = lastToldHash_ == cut_.toldHash() && record.standIns == 0;
    // Answers to what was asked before may still be on their way.
    const bool isAnswered = framesDrawnTheSame_ > static_cast<int>(late_.latencyFrames());
    // Who learns nothing from what was drawn draws the same whenever all that it wants is there.
    const bool isPlain = isComplete && record.standIns == 0 && !strategy.learnsWhatIsHidden();
    record.isSettled = isPlain || (drawsTheSame && isAnswered &&
                                   (decidesTheSame || framesDrawnTheSame_ >= kSteadyFrames));
    lastCamera_ = camera;
    lastClip_ = options.clip;
    lastToldHash_ = cut_.toldHash();
    lastDrawnHash_ = cut_.drawnHash();
    lastRecord_ = record;
    return record;
}

// Always there, whatever is drawn: what turns visible in a new view has a stand-in then.
void FrameRunner::wantRoot(const Node& root) {
    static_cast<void>(
        streaming_.residency().want({root.page(), *root.record, kRootPriority}, false));
}

// On a cold start nothing hides anything, and the cut is many times what it will be: tau waits as
// long as pages come, at most one budget's worth, nearest and largest first.
bool FrameRunner::controlTau(const Camera& camera, const Strategy& strategy,
                             const FrameOptions& options) {
    const bool isMissing = streaming_.missing() > 0;
    // Since the last frame's look: what arrives between frames counts.
    const Progress now = progress();
    const bool isIdle = streaming_.requests().sentCount() == 0 && now == lastProgress_;
    lastProgress_ = now;
    framesWithoutProgress_ = isMissing && isIdle ? framesWithoutProgress_ + 1 : 0;
    const bool isStuck = framesWithoutProgress_ >= kStuckFrames;
    if (isStuck) framesWithoutProgress_ = 0;
    const cache::Residency& residency = streaming_.residency();
    const uint64_t budgetBytes = residency.gpuBudgetBytes();
    const uint64_t uploadedBytes = residency.counters().bytesUploaded;
    if (tauControl_.fits()) {
        uploadedWhenItFitted_ = uploadedBytes;
        hasLearnt_ = false;
    }
    hasLearnt_ = hasLearnt_ || isStuck || uploadedBytes - uploadedWhenItFitted_ >= budgetBytes;
    const bool isLearning = isMissing && strategy.learnsWhatIsHidden() && !hasLearnt_;
    tauControl_.update({options.tauPx, residency.demandBytes(), budgetBytes, isStuck,
                        isSameView(camera, options), isLearning, isMissing});
    return tauControl_.fits() || isLearning;
}

FrameRunner::Counts FrameRunner::counts() const {
    return {streaming_.residency().counters(), streaming_.prefetchedBlocks()};
}

void FrameRunner::account(FrameRecord& record, const Counts& countsBefore) {
    const cache::Residency& residency = streaming_.residency();
    const cache::Residency::Counters& after = residency.counters();
    const cache::Residency::Counters& before = countsBefore.pages;
    record.missingPages = streaming_.missing();
    record.demandBytes = residency.demandBytes();
    record.loadedPages = after.loadedPages - before.loadedPages;
    record.bytesRead = after.bytesRead - before.bytesRead;
    record.bytesUploaded = after.bytesUploaded - before.bytesUploaded;
    record.evictedPages = after.evictedPages - before.evictedPages;
    record.reloadedPages = after.reloadedPages - before.reloadedPages;
    for (size_t i = 0; i < record.prefetch.size(); ++i) {
        record.prefetch[i] = after.prefetch[i].since(before.prefetch[i]);
    }
    record.prefetchedBlocks = streaming_.prefetchedBlocks().since(countsBefore.prefetchedBlocks);
    record.indexBlocks = streaming_.index().blockCount();
    record.indexBytes = streaming_.indexBytes();
    record.gpuBytes = residency.gpuUsedBytes();
    record.hostBytes = streaming_.hostBytes();
    for (const cache::BlockFault& fault : streaming_.index().faults()) {
        record.faults.push_back(fmt::format("index block {}: {}", fault.block, fault.what));
    }
    for (const cache::PageFault& fault : residency.faults()) {
        record.faults.push_back(
            fmt::format("page of node {:#x}: {}", fault.id.node.value, fault.what));
    }
}

FrameRecord FrameRunner::settle(const Camera& camera, Strategy& strategy,
                                const FrameOptions& options,
                                const std::function<void(const FrameRecord&)>& onFrame) {
    FrameRecord record;
    const Counts before = counts();
    int completeFrames = 0;
    // Who waits anyway reads least: what is nearer is there before what it may hide is asked for.
    // A live frame must find nothing to do afterwards.
    uint32_t probeLevels = 1;
    for (int i = 0; i < kMaxSettleFrames && completeFrames < kRestlessFrames; ++i) {
        record = run(camera, strategy, {options.tauPx, probeLevels, options.clip, options.watch});
        if (onFrame) onFrame(record);
        const bool hasLooked = probeLevels == options.probeLevels || !strategy.learnsWhatIsHidden();
        if (record.isSettled && hasLooked) break;
        if (record.isSettled) probeLevels = options.probeLevels;
        // Nothing on its way: either the next frame asks for more, or tau control must act.
        if (record.missingPages > 0) {
            bool isMoreToCome = streaming_.waitForArrival();
            // What was sent for is read whatever the next frame wants: who learns from frames, and
            // would cancel no more of it, waits for all.
            while (isMoreToCome && strategy.learnsWhatIsHidden() &&
                   streaming_.requests().sentCount() > 0) {
                isMoreToCome = streaming_.waitForArrival();
            }
        }
        const bool isComplete = record.missingPages == 0 && !tauControl_.isMoving();
        completeFrames = isComplete ? completeFrames + 1 : 0;
    }
    record.faults.clear();
    account(record, before);
    return record;
}

}  // namespace pagoda::hlod
