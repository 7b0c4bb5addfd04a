// Picks what pays: occlusion by queries (coh), by a depth pyramid (hzb), or none (frustum). Each
// candidate with answers is tried for a few frames and timed; what frustum would cost is told from
// its cut's triangles and the time a triangle took, so that a deep scene never has to be drawn
// whole to find that out; it is tried only where that comes near. The choice is looked at again
// when the scene has changed, more and more seldom while it keeps being confirmed, and never while
// the camera stands still: a still picture stays as it is.
#include "hlod/strategies/strategies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

namespace pagoda::hlod {
namespace {

constexpr int kTrialFrames = 4;      // of a candidate; the first half only fills its memory
constexpr uint64_t kFirstRest = 60;  // frames between two looks
constexpr uint64_t kLongestRest = 960;
constexpr double kChange = 1.25;  // of drawn triangles: look again
constexpr double kNear = 1.5;     // frustum is tried when foretold below so many times the best

class AutoStrategy final : public Strategy {
public:
    explicit AutoStrategy(const StrategyOptions& options)
        : candidates_{{{"coh", makeCohStrategy(options)},
                       {"hzb", makeHzbStrategy(options)},
                       {"frustum", makeFrustumStrategy(options)}}} {}

    void traverse(FrameContext& frame) override {
        learn(frame);
        if (!hasBegun_) begin(frame);
        if (isTrying_ && framesTried_ == kTrialFrames) nextTrial(frame);
        if (!isTrying_ && !frame.isSameView && mustLook()) startTrials(frame);
        Candidate& candidate = candidates_[current_];
        candidate.strategy->traverse(frame);
        frame.record.choice = fmt::format("{}: {}", candidate.name, why_);
        if (isTrying_) ++framesTried_;
        ++framesSinceLook_;
    }

    void forget() override {
        for (Candidate& candidate : candidates_) candidate.strategy->forget();
        hasBegun_ = false;
    }

    [[nodiscard]] bool learnsWhatIsHidden() const override {
        return candidates_[current_].strategy->learnsWhatIsHidden();
    }

private:
    static constexpr size_t kCoh = 0, kHzb = 1, kFrustum = 2;
    struct Candidate {
        const char* name;
        std::unique_ptr<Strategy> strategy;
        double costMs = -1;  // of a frame; below 0: not known
    };

    void begin(FrameContext& frame) {
        hasBegun_ = true;
        rest_ = kFirstRest;
        startTrials(frame);
    }

    // What the last frame cost belongs to the candidate that ran it.
    void learn(const FrameContext& frame) {
        if (!hasBegun_ || frame.lastRecord == nullptr) return;
        const FrameRecord& last = *frame.lastRecord;
        if (last.missingPages > 0) return;  // loading, not drawing
        drawnTriangles_ = static_cast<double>(last.drawnTriangles);
        if (isTrying_ && framesTried_ > kTrialFrames / 2) trialMs_.push_back(last.frameMs);
        if (last.drawnTriangles > 0) {
            const double ms = last.frameMs - last.queryMs - last.streamMs;
            msPerTriangle_ = ms / drawnTriangles_;
        }
    }

    [[nodiscard]] bool mustLook() const {
        if (framesSinceLook_ >= rest_) return true;
        const double ratio = (drawnTriangles_ + 1) / (trianglesAtChoice_ + 1);
        return framesSinceLook_ >= kFirstRest && (ratio > kChange || ratio < 1 / kChange);
    }

    void startTrials(FrameContext& frame) {
        before_ = current_;
        trials_.clear();
        if (frame.sink.counting() != nullptr) trials_.push_back(kCoh);
        if (frame.sink.pyramid() != nullptr) trials_.push_back(kHzb);
        isTrying_ = true;
        framesSinceLook_ = 0;
        if (trials_.empty()) {
            choose(kFrustum, "no answers to be had from this device");
        } else {
            startTrial();
        }
    }

    void startTrial() {
        current_ = trials_.back();
        trials_.pop_back();
        framesTried_ = 0;
        trialMs_.clear();
        why_ = "being tried";
    }

    void nextTrial(FrameContext& frame) {
        std::sort(trialMs_.begin(), trialMs_.end());
        // Nothing was timed while pages were missing: once more.
        if (trialMs_.empty()) {
            framesTried_ = 0;
            return;
        }
        candidates_[current_].costMs = trialMs_[trialMs_.size() / 2];
        if (!trials_.empty()) return startTrial();
        const size_t best = cheapest(current_ == kFrustum);
        if (current_ != kFrustum && isFrustumNear(frame, candidates_[best].costMs)) {
            trials_.push_back(kFrustum);
            return startTrial();
        }
        choose(best, fmt::format("{:.1f} ms a frame; {}", candidates_[best].costMs, others(best)));
    }

    [[nodiscard]] size_t cheapest(bool withFrustum) const {
        size_t best = kCoh;
        double least = -1;
        for (size_t i = 0; i < candidates_.size(); ++i) {
            const double cost = candidates_[i].costMs;
            if (cost < 0 || (i == kFrustum && !withFrustum)) continue;
            if (least < 0 || cost < least) {
                least = cost;
                best = i;
            }
        }
        return best;
    }

    [[nodiscard]] std::string others(size_t best) const {
        std::string text;
        for (size_t i = 0; i < candidates_.size(); ++i) {
            if (i == best || candidates_[i].costMs < 0) continue;
            text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", candidates_[i].name,
                                candidates_[i].costMs);
        }
        return text;
    }

    void choose(size_t candidate, std::string why) {
        isTrying_ = false;
        current_ = candidate;
        rest_ = candidate == before_ ? std::min(2 * rest_, kLongestRest) : kFirstRest;
        trianglesAtChoice_ = drawnTriangles_;
        framesSinceLook_ = 0;
        why_ = std::move(why);
    }

    // Sets what frustum is foretold to cost.
    [[nodiscard]] bool isFrustumNear(FrameContext& frame, double bestMs) {
        const double limit = kNear * bestMs / std::max(msPerTriangle_, 1e-9);
        const double triangles = trianglesOfCut(frame, limit);
        candidates_[kFrustum].costMs = triangles * msPerTriangle_;
        return triangles <= limit;
    }

    // Of the cut at tau inside the frustum, or the first number above `limit`.
    static double trianglesOfCut(FrameContext& frame, double limit) {
        std::vector<Node> pending;
        if (const auto root = frame.tree.root()) pending.push_back(*root);
        double triangles = 0;
        while (!pending.empty() && triangles <= limit) {
            const Node node = pending.back();
            pending.pop_back();
            if (!frame.view.intersectsFrustum(*node.boxModel)) continue;
            const double ssePx = frame.view.ssePx(node.record->errorModelUnits, *node.boxModel);
            const NodeRange children =
                frame.tauPx > 0.0 && ssePx <= frame.tauPx ? NodeRange() : frame.tree.children(node);
            if (children.empty()) triangles += node.record->triangleCount;
            for (uint32_t i = 0; i < children.size(); ++i) pending.push_back(children[i]);
        }
        return triangles;
    }

    std::array<Candidate, 3> candidates_;
    size_t current_ = kCoh, before_ = kCoh;
    bool hasBegun_ = false, isTrying_ = false;
    std::vector<size_t> trials_;  // still to come, last first
    std::vector<double> trialMs_;
    int framesTried_ = 0;
    uint64_t framesSinceLook_ = 0, rest_ = kFirstRest;
    double drawnTriangles_ = 0, trianglesAtChoice_ = 0, msPerTriangle_ = 0;
    std::string why_;
};

}  // namespace

std::unique_ptr<Strategy> makeAutoStrategy(const StrategyOptions& options) {
    return std::make_unique<AutoStrategy>(options);
}

}  // namespace pagoda::hlod
