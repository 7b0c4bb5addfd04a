// What paper 004 states of the sigmoid bias, and what we add, over all s, t and mu.
#include "hlod/strategies/bias.h"

#include <gtest/gtest.h>

namespace pagoda::hlod {
namespace {

constexpr int kSteps = 50;
double share(int i) {
    return static_cast<double>(i) / kSteps;
}

TEST(SigmoidBias, KeepsNothingAllAndTheTurnover) {
    for (int s = 0; s <= kSteps; ++s) {
        for (int t = 0; t <= kSteps; ++t) {
            EXPECT_NEAR(sigmoidBias(1.0, share(s), share(t)), 1.0, 1e-12);
            EXPECT_NEAR(sigmoidBias(share(t), share(s), share(t)), share(t),
                        t == 0 ? share(s) + 1e-12 : 1e-12);
            if (t > 0) {
                EXPECT_NEAR(sigmoidBias(0.0, share(s), share(t)), 0.0, 1e-12);
            }
        }
    }
}

TEST(SigmoidBias, IsTheShareItselfWithoutBlending) {
    for (int t = 0; t <= kSteps; ++t) {
        for (int i = 0; i <= kSteps; ++i) EXPECT_EQ(sigmoidBias(share(i), 0.0, share(t)), share(i));
    }
}

TEST(SigmoidBias, NeverFallsWithTheShareAndNeverJumps) {
    constexpr int kFine = 2000;
    for (const double s : {0.0, 0.3, 1.0}) {
        for (const double t : {0.0, 0.02, 0.25, 0.5, 0.9, 1.0}) {
            for (int i = 0; i < kFine; ++i) {
                const double a = sigmoidBias(1.0 * i / kFine, s, t);
                const double b = sigmoidBias((i + 1.0) / kFine, s, t);
                EXPECT_GE(b, a);
                EXPECT_LE(b - a, (1.0 + s) / kFine + 1e-12);  // slope
                EXPECT_GE(a, 0.0);
                EXPECT_LE(b, 1.0 + 1e-12);
            }
        }
    }
}

TEST(SigmoidBias, KeepsMoreDetailWithAnEarlierTurnover) {
    for (int s = 0; s <= kSteps; ++s) {
        for (int i = 0; i <= kSteps; ++i) {
            for (int t = 0; t < kSteps; ++t) {
                EXPECT_GE(sigmoidBias(share(i), share(s), share(t)) + 1e-12,
                          sigmoidBias(share(i), share(s), share(t + 1)));
            }
        }
    }
}

}  // namespace
}  // namespace pagoda::hlod
