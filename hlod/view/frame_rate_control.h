// frame_rate_control.h: the allowed error that keeps frames within a time: tau rises while they
// take longer, and comes back when they are quick again. Measured times may belong to frames drawn
// some frames ago, as a GPU's do. Pure state: one call a frame, no clock. A measured frame says
// which tau would have been right: tau_then * (ms / target)^(1/2), for times that fall with the
// square of tau at most, as surfaces give it. tau goes a part of the way to the middle one of the
// last three such answers. Since an answer starts from the tau of its own frame, not from the
// present one, late answers never add up: tau does not overshoot at any latency where times fall no
// faster than that square, and there is no integrator that could wind up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace pagoda::hlod {

class FrameRateControl {
public:
    struct Options {
        double targetMs = 16.0;       // frames shall take no longer; > 0
        uint32_t latencyFrames = 0;   // that a measured time is late
        double greatestTauPx = 64.0;  // coarser than that is no picture: rather a slow frame
    };
    struct Frame {
        double tauPx = 1.0;           // asked for
        double effectiveTauPx = 1.0;  // of the frame just drawn, whoever raised it
        double measuredMs = 0.0;      // of the frame drawn `latencyFrames` before it
        bool isSameView = false;      // as in the frame before
    };

    explicit FrameRateControl(const Options& options);

    // Of the next frame; never below what is asked for, nor above the greatest where that is more.
    [[nodiscard]] double tauPx(double askedTauPx) const noexcept;
    void update(const Frame& frame);
    // Did the last update() change it?
    [[nodiscard]] bool isMoving() const noexcept { return isMoving_; }

private:
    void remember(const Frame& frame, double logThen);
    [[nodiscard]] double wantedLog(double measuredMs, double logTauThen);
    void follow(const Frame& frame, double logWanted, double logNow);

    Options options_;
    double raised_ = 0.0;                 // 0: nothing has been raised
    std::deque<double> drawnLogs_;        // ln of the effective taus of the last frames
    std::array<double, 3> wantedLogs_{};  // the last answers
    size_t answers_ = 0;
    // What was too slow from here: a still view must come to rest between two levels.
    double tooFineLog_;  // ln of the greatest tau
    int failures_ = 0;   // times that finer was tried in vain
    double lastLogMs_ = 0.0, lastLogThen_ = 0.0;
    bool isMoving_ = false, isTrying_ = false;
};

}  // namespace pagoda::hlod
