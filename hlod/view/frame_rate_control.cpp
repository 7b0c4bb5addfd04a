#include "hlod/view/frame_rate_control.h"

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

constexpr double kSteepness = 2.0;  // the fastest that times fall with tau
// Aimed at, of the target; within the band around it (of the natural logarithm of the time) nothing
// moves, so that a picture rests although times vary a little.
constexpr double kAim = 0.9, kBand = 0.1;
// Parts of the way, a frame: slow frames are mended sooner than fine detail comes back.
constexpr double kUp = 0.5, kDown = 0.15;
constexpr double kLeastTauPx = 0.25;  // tau 0 is raised from here
// One measurement moves the answer by no more than this factor of the time.
constexpr double kMostFactor = 16.0;
// What was too slow is not tried again while the view is still, but a few times; all is forgotten
// when times fall although tau stays, since something else has changed then.
constexpr double kNothing = -1e9;
constexpr double kForgetLog = 0.03;  // a frame, while the camera moves or there are tries left
constexpr int kTries = 2;
constexpr double kSameTauLog = 0.01, kChangedLog = 0.4;
constexpr double kLeastStepLog = 0.05;

double logTau(double tauPx) {
    return std::log(std::max(tauPx, kLeastTauPx));
}

}  // namespace

FrameRateControl::FrameRateControl(const Options& options)
    : options_(options), tooFineLog_(kNothing) {
}

double FrameRateControl::tauPx(double askedTauPx) const noexcept {
    return std::max(askedTauPx, raised_);
}

// The middle one of the last three answers: a single slow frame changes nothing.
double FrameRateControl::wantedLog(double measuredMs, double logTauThen) {
    const double excess = std::clamp(std::max(measuredMs, 1e-3) / (kAim * options_.targetMs),
                                     1.0 / kMostFactor, kMostFactor);
    wantedLogs_[answers_++ % wantedLogs_.size()] = logTauThen + std::log(excess) / kSteepness;
    if (answers_ < wantedLogs_.size()) return wantedLogs_[(answers_ - 1) % wantedLogs_.size()];
    std::array<double, 3> sorted = wantedLogs_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[1];
}

void FrameRateControl::update(const Frame& frame) {
    isMoving_ = false;
    const double logNow = logTau(frame.effectiveTauPx);
    drawnLogs_.push_back(logNow);
    if (drawnLogs_.size() <= options_.latencyFrames) return;  // of no frame of ours yet
    const double logThen = drawnLogs_.front();
    drawnLogs_.pop_front();
    remember(frame, logThen);
    follow(frame, wantedLog(frame.measuredMs, logThen), logNow);
}

void FrameRateControl::remember(const Frame& frame, double logThen) {
    const double logMs = std::log(std::max(frame.measuredMs, 1e-3));
    const bool hasChanged =
        std::abs(logThen - lastLogThen_) < kSameTauLog && logMs < lastLogMs_ - kChangedLog;
    lastLogThen_ = logThen;
    lastLogMs_ = logMs;
    if (hasChanged) tooFineLog_ = kNothing;
    if (hasChanged || !frame.isSameView) failures_ = 0;
    if (failures_ < kTries) tooFineLog_ -= kForgetLog;
    if (frame.measuredMs <= options_.targetMs) return;
    tooFineLog_ = std::max(tooFineLog_, logThen);
    failures_ += isTrying_ ? 1 : 0;
    isTrying_ = false;
}

void FrameRateControl::follow(const Frame& frame, double logWanted, double logNow) {
    const double logAsked = logTau(frame.tauPx);
    const double logMost = std::max(logAsked, std::log(options_.greatestTauPx));
    const double excess = kSteepness * (logWanted - logNow);  // of the present time, foretold
    if (std::abs(excess) <= kBand) return;
    double next = logNow + (excess > 0 ? kUp : kDown) * (logWanted - logNow);
    if (excess < 0 && frame.isSameView) {
        next = std::max(next, std::min(logNow, tooFineLog_ + kLeastStepLog));
    }
    next = std::clamp(next, logAsked, logMost);
    const double before = raised_;
    raised_ = next > logAsked ? std::exp(next) : 0.0;
    isMoving_ = raised_ != before;
    isTrying_ = isTrying_ || raised_ < before;
}

}  // namespace pagoda::hlod
