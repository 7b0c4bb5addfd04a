// Tau that follows a target frame time, against a plant whose times are known: no oscillation after
// a step, bounded overshoot, nothing that winds up, late answers, levels, noise.
#include "hlod/view/frame_rate_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace pagoda::hlod {
namespace {

constexpr double kTargetMs = 16.0;

// Frame times against tau: `cost` ms at tau 1, falling with its `steepness`th power.
struct Plant {
    double cost = 16.0, steepness = 2.0, fixedMs = 0.0;
    bool hasLevels = false;  // tau counts as the power of two below it
    std::function<double()> noise = [] { return 1.0; };

    double ms(double tauPx) const {
        const double tau = hasLevels ? std::exp2(std::floor(std::log2(tauPx))) : tauPx;
        return (fixedMs + cost / std::pow(tau, steepness)) * noise();
    }
};

struct Trace {
    std::vector<double> taus, times;
};

class Loop {
public:
    explicit Loop(uint32_t latencyFrames)
        : control_({.targetMs = kTargetMs, .latencyFrames = latencyFrames}),
          waiting_(latencyFrames, 0.0) {}

    Trace run(const Plant& plant, int frames, bool isSameView = true) {
        Trace trace;
        for (int i = 0; i < frames; ++i) {
            const double tauPx = control_.tauPx(1.0);
            trace.taus.push_back(tauPx);
            trace.times.push_back(plant.ms(tauPx));
            waiting_.push_back(trace.times.back());
            control_.update({.tauPx = 1.0,
                             .effectiveTauPx = tauPx,
                             .measuredMs = waiting_[waiting_.size() - 1 - latency()],
                             .isSameView = isSameView});
        }
        return trace;
    }
    bool isMoving() const { return control_.isMoving(); }
    size_t latency() const { return latencyFrames_; }
    Loop& withLatency(size_t frames) {
        latencyFrames_ = frames;
        return *this;
    }

private:
    FrameRateControl control_;
    std::vector<double> waiting_;
    size_t latencyFrames_ = 0;
};

Loop loopWith(uint32_t latencyFrames) {
    Loop loop(latencyFrames);
    loop.withLatency(latencyFrames);
    return loop;
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

size_t framesUntilWithinTenPercent(const std::vector<double>& times) {
    size_t settled = times.size();
    while (settled > 0 && std::abs(times[settled - 1] / times.back() - 1) <= 0.1) --settled;
    return settled;
}

TEST(FrameRateControl, LeavesTauAloneWhileFramesAreQuick) {
    Loop loop = loopWith(0);
    for (const double tau : loop.run({.cost = 8.0}, 50).taus) EXPECT_EQ(tau, 1.0);
    EXPECT_FALSE(loop.isMoving());
}

TEST(FrameRateControl, AStepOfFourNeitherOscillatesNorOvershootsAtAnyLatency) {
    for (const uint32_t latency : {0u, 1u, 3u, 8u, 16u}) {
        for (const double steepness : {0.5, 1.0, 1.5, 2.0}) {
            Loop loop = loopWith(latency);
            static_cast<void>(loop.run({.cost = 15.0, .steepness = steepness}, 60));
            const Plant slow{.cost = 60.0, .steepness = steepness};
            const Trace up = loop.run(slow, 400);
            EXPECT_EQ(turns(up.taus), 0) << latency << " " << steepness;
            EXPECT_LE(up.times.back(), kTargetMs) << latency << " " << steepness;
            EXPECT_GE(up.times.back(), 0.75 * kTargetMs) << latency << " " << steepness;
            EXPECT_FALSE(loop.isMoving());
            const Trace down = loop.run({.cost = 15.0, .steepness = steepness}, 600);
            EXPECT_EQ(turns(down.taus), 0) << latency << " " << steepness;
            EXPECT_LE(*std::max_element(down.times.begin(), down.times.end()), kTargetMs);
        }
    }
}

TEST(FrameRateControl, SettlesWithinTheLatencyAndAFewFrames) {
    for (const uint32_t latency : {0u, 8u}) {
        Loop loop = loopWith(latency);
        static_cast<void>(loop.run({.cost = 15.0}, 60));
        EXPECT_LE(framesUntilWithinTenPercent(loop.run({.cost = 60.0}, 300).times), latency + 8u);
    }
}

// Steeper than surfaces are: tau goes too far, and comes back.
TEST(FrameRateControl, OvershootIsBoundedWhereTimesFallFasterThanForeseen) {
    Loop loop = loopWith(8);
    static_cast<void>(loop.run({.cost = 15.0, .steepness = 3.0}, 60));
    const Trace up = loop.run({.cost = 60.0, .steepness = 3.0}, 600);
    EXPECT_LE(*std::max_element(up.taus.begin(), up.taus.end()), 1.5 * up.taus.back());
    EXPECT_LE(up.times.back(), kTargetMs);
    EXPECT_FALSE(loop.isMoving());
}

// No tau makes these frames quick: tau stays at its greatest, and is back soon after.
TEST(FrameRateControl, NothingWindsUpWhileTheTargetIsOutOfReach) {
    Loop loop = loopWith(8);
    const Trace stuck = loop.run({.cost = 1.0, .fixedMs = 100.0}, 5000);
    EXPECT_NEAR(stuck.taus.back(), 64.0, 1e-9);
    const Trace back = loop.run({.cost = 8.0}, 200);
    EXPECT_EQ(back.taus.back(), 1.0);
    EXPECT_EQ(turns(back.taus), 0);
}

// Between two levels there is no tau that gives the target: the coarser one is kept.
TEST(FrameRateControl, AStillViewRestsBetweenLevels) {
    for (double cost = 17.0; cost < 400.0; cost *= 1.13) {
        Loop loop = loopWith(2);
        const Plant plant{.cost = cost, .hasLevels = true};
        static_cast<void>(loop.run(plant, 600));
        const Trace rest = loop.run(plant, 100);
        EXPECT_EQ(rest.taus.front(), rest.taus.back()) << cost;
        EXPECT_EQ(turns(rest.taus), 0) << cost;
        EXPECT_LE(rest.times.back(), kTargetMs) << cost;
    }
}

TEST(FrameRateControl, OneSlowFrameChangesNothing) {
    Loop loop = loopWith(0);
    static_cast<void>(loop.run({.cost = 60.0}, 100));
    const double before = loop.run({.cost = 60.0}, 1).taus.back();
    static_cast<void>(loop.run({.cost = 2000.0}, 1));
    for (const double tau : loop.run({.cost = 60.0}, 10).taus) EXPECT_EQ(tau, before);
}

TEST(FrameRateControl, NoiseOfFivePercentMovesTauLittle) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal(1.0, 0.05);
    Loop loop = loopWith(2);
    Plant plant{.cost = 60.0};
    plant.noise = [&] { return std::max(0.5, normal(random)); };
    static_cast<void>(loop.run(plant, 200, false));
    const Trace rest = loop.run(plant, 1000, false);
    const auto [least, most] = std::minmax_element(rest.taus.begin(), rest.taus.end());
    EXPECT_LE(*most / *least, 1.15);
}

TEST(FrameRateControl, RaisesTauZeroToo) {
    FrameRateControl control({.targetMs = 10.0});
    for (int i = 0; i < 5; ++i) {
        control.update({.tauPx = 0.0, .effectiveTauPx = control.tauPx(0.0), .measuredMs = 40.0});
    }
    EXPECT_GT(control.tauPx(0.0), 0.25);
}

}  // namespace
}  // namespace pagoda::hlod
