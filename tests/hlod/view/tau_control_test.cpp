// Tau control against steps in demand: no oscillation, no livelock, and back again.
#include "hlod/view/tau_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace pagoda::hlod {
namespace {

constexpr uint64_t kBudget = 1'000'000;

// Bytes of a cut at tau, as surfaces give it: `atOne` at tau 1, never below `least`.
uint64_t demand(double atOne, double tauPx, double least = 0.0) {
    return static_cast<uint64_t>(std::max(atOne / (tauPx * tauPx), least));
}

// Tau of each frame.
std::vector<double> play(TauControl& control, int frames, double atOne, bool isSameView,
                         double least = 0.0) {
    std::vector<double> taus;
    for (int i = 0; i < frames; ++i) {
        const double tauPx = control.effectiveTauPx(1.0);
        taus.push_back(tauPx);
        control.update({.tauPx = 1.0,
                        .demandBytes = demand(atOne, tauPx, least),
                        .budgetBytes = kBudget,
                        .isSameView = isSameView});
    }
    return taus;
}

int turns(const std::vector<double>& taus) {
    int count = 0;
    double direction = 0.0;
    for (size_t i = 1; i < taus.size(); ++i) {
        const double step = taus[i] - taus[i - 1];
        count += step * direction < 0.0;
        if (step != 0.0) direction = step;
    }
    return count;
}

TEST(TauControl, LeavesTauAloneWhileTheCutFits) {
    TauControl control;
    for (const double tau : play(control, 20, 0.9 * kBudget, false)) EXPECT_EQ(tau, 1.0);
    EXPECT_FALSE(control.isMoving());
    EXPECT_TRUE(control.fits());
}

TEST(TauControl, FiftyTimesTheBudgetSettlesInAFewFramesWithoutOscillation) {
    for (const bool isSameView : {true, false}) {
        TauControl control;
        const std::vector<double> taus = play(control, 120, 50.0 * kBudget, isSameView);
        const double right = std::sqrt(50.0 / 0.95);
        EXPECT_LE(demand(50.0 * kBudget, taus[20]), kBudget);  // fits from here on
        for (size_t i = 20; i < taus.size(); ++i) {
            EXPECT_LT(taus[i], 1.6 * right);
            if (isSameView && i > 40) {
                EXPECT_EQ(taus[i], taus[40]);
            }
        }
        if (isSameView) {
            EXPECT_LE(turns(taus), 1);
        }
    }
}

TEST(TauControl, AStillViewComesToRestAtEveryDemand) {
    for (double factor = 1.0; factor < 400.0; factor *= 1.07) {
        TauControl control;
        static_cast<void>(play(control, 100, factor * kBudget, true));
        const std::vector<double> taus = play(control, 50, factor * kBudget, true);
        EXPECT_EQ(taus.front(), taus.back()) << factor;
        EXPECT_FALSE(control.isMoving()) << factor;
        EXPECT_TRUE(control.fits()) << factor;
    }
}

TEST(TauControl, ComesBackWhenTheCutFitsAgain) {
    TauControl control;
    static_cast<void>(play(control, 60, 50.0 * kBudget, true));
    EXPECT_GT(control.effectiveTauPx(1.0), 5.0);
    const std::vector<double> taus = play(control, 200, 0.5 * kBudget, false);
    EXPECT_EQ(taus.back(), 1.0);
    EXPECT_EQ(turns(taus), 0);
}

// From inside a model boxes around the eye leave the cut only at thousands of pixels: bytes fall
// slowly with tau.
TEST(TauControl, SlowlyFallingDemandIsMetInFewFramesWithoutGoingFarTooFar) {
    for (const double steepness : {0.15, 0.3, 0.6, 1.0, 2.0}) {
        TauControl control;
        const auto bytes = [&](double tauPx) {
            return static_cast<uint64_t>(5.0 * kBudget / std::pow(tauPx, steepness));
        };
        std::vector<double> taus;
        for (int i = 0; i < 100; ++i) {
            taus.push_back(control.effectiveTauPx(1.0));
            control.update({.tauPx = 1.0,
                            .demandBytes = bytes(taus.back()),
                            .budgetBytes = kBudget,
                            .isSameView = true});
        }
        const double right = std::pow(5.0 / 0.95, 1.0 / steepness);
        const auto settled = std::find_if(taus.begin(), taus.end(),
                                          [&](double tau) { return bytes(tau) <= kBudget; });
        EXPECT_LE(settled - taus.begin(), 16) << steepness;
        EXPECT_LE(*std::max_element(taus.begin(), taus.end()), 4.0 * right) << steepness;
        EXPECT_LE(turns(taus), 1) << steepness;
        EXPECT_FALSE(control.isMoving()) << steepness;
        EXPECT_TRUE(control.fits()) << steepness;
    }
}

// A strategy learns what is hidden while the camera stands still.
TEST(TauControl, AStillViewThatGetsCheaperComesBack) {
    TauControl control;
    static_cast<void>(play(control, 60, 50.0 * kBudget, true));
    const std::vector<double> taus = play(control, 200, 5.0 * kBudget, true);
    EXPECT_LE(taus.back(), 1.3 * std::sqrt(5.0 / 0.95));
    EXPECT_EQ(turns(taus), 0);
    EXPECT_TRUE(control.fits());
    EXPECT_FALSE(control.isMoving());
}

TEST(TauControl, AStillViewThatWaversComesToRestAllTheSame) {
    TauControl control;
    static_cast<void>(play(control, 60, 50.0 * kBudget, true));
    for (int i = 0; i < 200; ++i) {
        static_cast<void>(play(control, 1, (i % 2 == 0 ? 30.0 : 50.0) * kBudget, true));
    }
    const std::vector<double> taus = play(control, 100, 50.0 * kBudget, true);
    EXPECT_EQ(taus.front(), taus.back());
    EXPECT_TRUE(control.fits());
}

TEST(TauControl, BeingStuckRaisesAlthoughTheCutFits) {
    TauControl control;
    control.update({.tauPx = 1.0,
                    .demandBytes = kBudget / 2,
                    .budgetBytes = kBudget,
                    .isStuck = true,
                    .isSameView = true});
    EXPECT_GT(control.effectiveTauPx(1.0), 1.0);
    EXPECT_TRUE(control.isMoving());
}

TEST(TauControl, RaisesTauZeroToo) {
    TauControl control;
    control.update({.tauPx = 0.0, .demandBytes = 2 * kBudget, .budgetBytes = kBudget});
    EXPECT_GT(control.effectiveTauPx(0.0), 0.0);
}

// One page of nearly the whole budget: no tau makes it smaller.
TEST(TauControl, TheCoarsestCutMayFillTheBudget) {
    TauControl control;
    static_cast<void>(play(control, 200, 50.0 * kBudget, true, 0.99 * kBudget));
    EXPECT_TRUE(control.fits());
    EXPECT_FALSE(control.isMoving());
    TauControl tooLarge;
    static_cast<void>(play(tooLarge, 200, 50.0 * kBudget, true, 1.01 * kBudget));
    EXPECT_FALSE(tooLarge.fits());
}

}  // namespace
}  // namespace pagoda::hlod
