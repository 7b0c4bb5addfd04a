#include "hlod/view/tau_control.h"

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

constexpr double kFullShare = 0.95;   // of the budget: pages come in sizes, gaps are not all of use
constexpr double kLeastTauPx = 0.25;  // tau 0 is raised from here
constexpr double kLeastStep = 1.02, kGreatestStep = 1.5;
constexpr double kStuckStep = 1.3;  // found after several frames of waiting each time
constexpr double kHurryStep = 1.1;
constexpr double kDownStep = 0.9;
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
    fits_ = share(frame) <= 1.0;
    isMoving_ = false;
    if (!frame.isSameView) tooFine_ *= kForgetStep;
    if (!fits_ || frame.isStuck) {
        raise(frame);
    } else {
        lastRaisedBytes_ = UINT64_MAX;
        if (raised_ > 0.0) lower(frame);
    }
}

// Bytes fall with the square of the error on surfaces, so its root is the step that would do.
void TauControl::raise(const Frame& frame) {
    const double effective = effectiveTauPx(frame.tauPx);
    tooFine_ = std::max(tooFine_, effective);
    if (effective >= kMaxTauPx) {  // the coarsest nodes: at most as they are
        fits_ = frame.demandBytes <= frame.budgetBytes;
        return;
    }
    // Where a step did nothing, the next is longer: errors jump from level to level.
    hurry_ = frame.demandBytes >= lastRaisedBytes_ ? hurry_ * kHurryStep : 1.0;
    lastRaisedBytes_ = frame.demandBytes;
    const double leastStep = frame.isStuck ? kStuckStep : kLeastStep;
    const double step = std::clamp(std::sqrt(share(frame)) * hurry_, leastStep, kGreatestStep);
    raised_ = std::max(effective, kLeastTauPx) * step;
    isMoving_ = true;
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
