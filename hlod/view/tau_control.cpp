#include "hlod/view/tau_control.h"

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

constexpr double kFullShare = 0.95;   // of the budget: pages come in sizes, gaps are not all of use
constexpr double kLeastTauPx = 0.25;  // tau 0 is raised from here
constexpr double kLeastStep = 1.02;
// Grows while one raise follows the other: from inside a model the cut may fit only at thousands of
// pixels, and nothing is read before it does.
constexpr double kGreatestStep = 1.5, kStepGrowth = 1.2, kGreatestStepEver = 4.0;
// Of bytes against error, as surfaces give it; and the least that is believed.
constexpr double kSurfaceSteepness = 2.0, kLeastSteepness = 0.3;
constexpr double kStuckStep = 1.3;  // found after several frames of waiting each time
constexpr double kHurryStep = 1.1;
constexpr double kDownStep = 0.9;
constexpr double kCheaperShare = 0.8;
constexpr int kMostForgotten = 8;
constexpr double kForgetStep = 0.98;  // a frame, of what was too fine, while the camera moves
// Above what any node's error is at the near plane, a millionth of the scene away.
constexpr double kMaxTauPx = 1e12;

double share(const TauControl::Frame& frame) {
    return static_cast<double>(frame.demandBytes) /
           (kFullShare * static_cast<double>(std::max<uint64_t>(frame.budgetBytes, 1)));
}

}  // namespace

double TauControl::effectiveTauPx(double tauPx) const noexcept {
    return std::max(tauPx, raised_);
}

void TauControl::update(const Frame& frame) {
    fits_ = share(frame) <= 1.0 || !frame.isMissing;
    isMoving_ = false;
    if (!frame.isSameView) {
        tooFine_ *= kForgetStep;
        forgotten_ = 0;
    }
    forgetWhenCheaper(frame);
    if (!fits_ && frame.isLearning) {
        isMoving_ = true;
    } else if (!fits_ || frame.isStuck) {
        raise(frame);
    } else {
        lastRaisedBytes_ = UINT64_MAX;
        if (raised_ > 0.0) lower(frame);
    }
}

// A still view gets cheaper while a strategy learns what is hidden: what was too fine may fit then.
// A few times only, so that a strategy that wavers does not take tau along.
void TauControl::forgetWhenCheaper(const Frame& frame) {
    const double effective = effectiveTauPx(frame.tauPx);
    const auto bytes = static_cast<double>(frame.demandBytes);
    const bool isAtRest = effective == restTauPx_;
    if (isAtRest && forgotten_ < kMostForgotten &&
        bytes < kCheaperShare * static_cast<double>(restBytes_)) {
        tooFine_ = 0.0;
        ++forgotten_;
        restBytes_ = frame.demandBytes;
    }
    if (!isAtRest) restBytes_ = frame.demandBytes;
    restTauPx_ = effective;
}

// Bytes fall with the square of the error on surfaces, so its root is the step that would do; where
// they proved to fall less, the step is longer.
void TauControl::raise(const Frame& frame) {
    const double effective = effectiveTauPx(frame.tauPx);
    tooFine_ = std::max(tooFine_, effective);
    if (effective >= kMaxTauPx) {  // the coarsest nodes: at most as they are
        fits_ = frame.demandBytes <= frame.budgetBytes;
        return;
    }
    noteSteepness(frame.demandBytes, effective);
    const double leastStep = frame.isStuck ? kStuckStep : kLeastStep;
    const double greatestStep =
        std::min(kGreatestStep * std::pow(kStepGrowth, raises_), kGreatestStepEver);
    const double step = std::clamp(std::pow(share(frame), 1.0 / steepness_) * hurry_, leastStep,
                                   std::max(leastStep, greatestStep));
    raised_ = std::max(effective, kLeastTauPx) * step;
    ++raises_;
    isMoving_ = true;
}

void TauControl::noteSteepness(uint64_t demandBytes, double effectiveTauPx) {
    const bool isFirst = lastRaisedBytes_ == UINT64_MAX;
    if (isFirst) {
        hurry_ = 1.0;
        steepness_ = kSurfaceSteepness;
        raises_ = 0;
    } else if (demandBytes >= lastRaisedBytes_) {
        // Where a step did nothing, the next is longer: errors jump from level to level.
        hurry_ *= kHurryStep;
    } else if (effectiveTauPx > lastRaisedTauPx_ && lastRaisedTauPx_ > 0.0) {
        hurry_ = 1.0;
        const double fall = std::log(static_cast<double>(lastRaisedBytes_) /
                                     static_cast<double>(std::max<uint64_t>(demandBytes, 1)));
        const double steepness = fall / std::log(effectiveTauPx / lastRaisedTauPx_);
        steepness_ = 0.5 * (steepness_ + std::clamp(steepness, kLeastSteepness, kSurfaceSteepness));
    }
    lastRaisedBytes_ = demandBytes;
    lastRaisedTauPx_ = effectiveTauPx;
}

void TauControl::lower(const Frame& frame) {
    const double lower = std::max(raised_ * kDownStep, frame.tauPx);
    const double ratio = raised_ / std::max(lower, kLeastTauPx);
    const bool wouldFit = share(frame) * ratio * ratio <= 1.0;
    // What was too fine is not tried again: a still view comes to rest.
    if (raised_ > frame.tauPx && (!wouldFit || lower <= tooFine_)) return;
    isMoving_ = raised_ > frame.tauPx;
    raised_ = lower > frame.tauPx ? lower : 0.0;
    if (raised_ <= 0.0) tooFine_ = 0.0;
}

}  // namespace pagoda::hlod
