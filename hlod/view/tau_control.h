// tau_control.h: raises the allowed error while the cut does not fit into GPU memory, shows it, and
// comes back: smoothly, without thrash and without livelock. Pure state: one call a frame.
#pragma once

#include <cstdint>

namespace pagoda::hlod {

class TauControl {
public:
    struct Frame {
        double tauPx = 1.0;        // asked for
        uint64_t demandBytes = 0;  // of the whole cut at effectiveTauPx()
        uint64_t budgetBytes = 0;
        bool isStuck = false;     // something is missing and nothing can come: gaps, pins
        bool isSameView = false;  // as in the frame before
        bool isLearning = false;  // what is on its way may show that much is hidden: wait for it
        bool isMissing = true;    // not all of the cut is there
    };

    // Of the next frame, once update() has been called; never below what is asked for.
    [[nodiscard]] double effectiveTauPx(double tauPx) const noexcept;
    void update(const Frame& frame);
    // Did the last update() change it, or find that the cut does not fit?
    [[nodiscard]] bool isMoving() const noexcept { return isMoving_; }
    // Did the last frame's cut fit? If not, reading for it would be in vain.
    [[nodiscard]] bool fits() const noexcept { return fits_; }

private:
    void raise(const Frame& frame);
    void forgetWhenCheaper(const Frame& frame);
    void noteSteepness(uint64_t demandBytes, double effectiveTauPx);
    void lower(const Frame& frame);

    double raised_ = 0.0;   // 0: nothing has been raised
    double tooFine_ = 0.0;  // the greatest tau that is known not to fit from here
    double hurry_ = 1.0;
    uint64_t lastRaisedBytes_ = UINT64_MAX;  // demanded when it was raised in the frame before
    double lastRaisedTauPx_ = 0.0;           // then
    double steepness_ = 2.0;                 // ln(bytes) falls by so much for each of ln(tau)
    double restTauPx_ = 0.0;                 // as long as this holds,
    uint64_t restBytes_ = 0;                 // this was the least demanded
    int forgotten_ = 0;                      // times, in this view
    int raises_ = 0;                         // one after the other
    bool isMoving_ = false, fits_ = true;
};

}  // namespace pagoda::hlod
