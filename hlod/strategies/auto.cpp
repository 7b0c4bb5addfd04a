// Picks what pays: occlusion by queries (coh), by a depth pyramid (hzb), or none (frustum). The
// first two are one traversal with one memory: they are tried in turns, frame by frame, so that a
// moving camera favours neither and nothing has to be learnt again. What frustum would cost is told
// from its cut's triangles and the time a triangle took, so that a deep scene never has to be drawn
// whole to find that out; it is tried only where that comes near. The choice is looked at again
// when the scene has changed, more and more seldom while it keeps being confirmed, and never while
// the camera stands still: a still picture stays as it is.
#include "hlod/strategies/coherent.h"
#include "hlod/strategies/strategies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

namespace pagoda::hlod {
namespace {

constexpr size_t kTurns = 4;          // timed frames of each of those that are tried in turns
constexpr size_t kFrustumFrames = 3;  // timed frames of frustum
constexpr uint64_t kFirstRest = 60;   // frames between two looks
constexpr uint64_t kLongestRest = 960;
constexpr double kChange = 1.25;   // of drawn triangles: look again
constexpr double kNear = 1.5;      // frustum is tried when foretold below so many times the best
constexpr double kWorthIt = 0.97;  // of what the last choice costs: another takes its place

class AutoStrategy final : public Strategy {
public:
    explicit AutoStrategy(const StrategyOptions& options)
        : culling_(CoherentRules{.options = options}), frustum_(makeFrustumStrategy(options)) {}

    void traverse(FrameContext& frame) override {
        learn(frame);
        if (!hasBegun_) {
            hasBegun_ = true;
            rest_ = kFirstRest;
            startTrials(frame);
        } else if (frame.isSameView) {
            // A still picture stays as it is.
        } else if (isTrying_) {
            goOnTrying(frame);
        } else if (mustLook()) {
            startTrials(frame);
        }
        wasSameView_ = frame.isSameView;
        if (current_ == kFrustum) {
            frustum_->traverse(frame);
        } else {
            culling_.usePyramid(current_ == kHzb);
            culling_.traverse(frame);
        }
        frame.record.choice = fmt::format("{}: {}", kNames[current_], why_);
        ++framesSinceLook_;
    }

    void forget() override {
        culling_.forget();
        frustum_->forget();
        hasBegun_ = false;
    }

    [[nodiscard]] bool learnsWhatIsHidden() const override { return current_ != kFrustum; }

private:
    enum Choice : uint8_t { kCoh, kHzb, kFrustum };
    static constexpr std::array kNames = {"coh", "hzb", "frustum"};

    // What the last frame cost belongs to the one that ran it.
    void learn(const FrameContext& frame) {
        if (!hasBegun_ || frame.lastRecord == nullptr) return;
        const FrameRecord& last = *frame.lastRecord;
        // Else it was loading, not only drawing; or it had little to do.
        if (last.missingPages > 0 || wasSameView_) return;
        drawnTriangles_ = static_cast<double>(last.drawnTriangles);
        if (isTrying_) times_[current_].push_back(frame.lastCostMs);
        if (last.drawnTriangles > 0) msPerTriangle_ = frame.lastCostMs / drawnTriangles_;
    }

    [[nodiscard]] bool mustLook() const {
        if (framesSinceLook_ >= rest_) return true;
        const double ratio = (drawnTriangles_ + 1) / (trianglesAtChoice_ + 1);
        return framesSinceLook_ >= kFirstRest && (ratio > kChange || ratio < 1 / kChange);
    }

    void startTrials(FrameContext& frame) {
        before_ = current_;
        hasQueries_ = frame.sink.counting() != nullptr;
        hasPyramid_ = frame.sink.pyramid() != nullptr;
        for (std::vector<double>& times : times_) times.clear();
        costMs_.fill(kUnknown);
        framesSinceLook_ = 0;
        isTrying_ = true;
        why_ = "being tried";
        if (!hasQueries_ && !hasPyramid_) {
            choose(kFrustum, "no answers to be had from this device");
        } else {
            current_ = hasQueries_ ? kCoh : kHzb;
        }
    }

    void goOnTrying(FrameContext& frame) {
        if (current_ == kFrustum) {
            // The first frame had its own pages to draw for the first time.
            if (times_[kFrustum].size() <= kFrustumFrames) return;
            costMs_[kFrustum] = median(times_[kFrustum], 1);
            return chooseCheapest();
        }
        const Choice other = current_ == kCoh ? kHzb : kCoh;
        const bool hasOther = hasQueries_ && hasPyramid_;
        const bool isEnough =
            times_[current_].size() >= kTurns && (!hasOther || times_[other].size() >= kTurns);
        if (!isEnough) {
            if (hasOther && times_[other].size() <= times_[current_].size()) current_ = other;
            return;
        }
        if (hasQueries_) costMs_[kCoh] = median(times_[kCoh], 0);
        if (hasPyramid_) costMs_[kHzb] = median(times_[kHzb], 0);
        const Choice best = cheapest();
        if (!isFrustumNear(frame, costMs_[best])) return chooseCheapest();
        current_ = kFrustum;
    }

    [[nodiscard]] static double median(std::vector<double> times, size_t from) {
        const auto begin = times.begin() + static_cast<std::ptrdiff_t>(from);
        const auto middle = begin + (times.end() - begin) / 2;
        std::nth_element(begin, middle, times.end());
        return *middle;
    }

    // Of those that were tried.
    [[nodiscard]] Choice cheapest() const {
        Choice best = before_;
        if (times_[best].empty()) best = hasQueries_ ? kCoh : kHzb;
        for (const Choice other : {kCoh, kHzb, kFrustum}) {
            if (!times_[other].empty() && costMs_[other] < kWorthIt * costMs_[best]) best = other;
        }
        return best;
    }

    void chooseCheapest() {
        const Choice best = cheapest();
        std::string others;
        for (const Choice other : {kCoh, kHzb, kFrustum}) {
            if (other == best || costMs_[other] == kUnknown) continue;
            others += fmt::format("{}{} {:.1f}", others.empty() ? "" : ", ", kNames[other],
                                  costMs_[other]);
        }
        choose(best, fmt::format("{:.1f} ms a frame; {}", costMs_[best], others));
    }

    void choose(Choice choice, std::string why) {
        isTrying_ = false;
        current_ = choice;
        rest_ = choice == before_ ? std::min(2 * rest_, kLongestRest) : kFirstRest;
        trianglesAtChoice_ = drawnTriangles_;
        framesSinceLook_ = 0;
        why_ = std::move(why);
    }

    // Sets what frustum is foretold to cost.
    [[nodiscard]] bool isFrustumNear(FrameContext& frame, double bestMs) {
        const double limit = kNear * bestMs / std::max(msPerTriangle_, 1e-9);
        const double triangles = trianglesOfCut(frame, limit);
        costMs_[kFrustum] = triangles * msPerTriangle_;
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

    static constexpr double kUnknown = -1;

    CoherentStrategy culling_;  // coh and hzb
    std::unique_ptr<Strategy> frustum_;
    Choice current_ = kCoh, before_ = kCoh;
    bool hasBegun_ = false, isTrying_ = false, wasSameView_ = false;
    bool hasQueries_ = false, hasPyramid_ = false;
    std::array<std::vector<double>, 3> times_;  // of this look, by choice
    std::array<double, 3> costMs_ = {kUnknown, kUnknown, kUnknown};
    uint64_t framesSinceLook_ = 0, rest_ = kFirstRest;
    double drawnTriangles_ = 0, trianglesAtChoice_ = 0, msPerTriangle_ = 0;
    std::string why_;
};

}  // namespace

std::unique_ptr<Strategy> makeAutoStrategy(const StrategyOptions& options) {
    return std::make_unique<AutoStrategy>(options);
}

}  // namespace pagoda::hlod
