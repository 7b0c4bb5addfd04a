// Depths that are pushed lie where near / (near / depth + error) says, and never nearer.
#include "hlod/raster/pushed_depths.h"
#include "tests/hlod/raster/raster_cases.h"

#include <gtest/gtest.h>

namespace pagoda::hlod {
namespace {

TEST(PushedDepths, LieFartherByTheErrorOfTheirNodeRoundedOutwards) {
    test::Cases cases(31);
    for (int i = 0; i < 20000; ++i) {
        const double near = std::pow(10.0, cases.real(-6, 2));
        const double error = near * std::pow(10.0, cases.real(-3, 6));
        const auto depth = static_cast<float>(1.0 / std::pow(10.0, cases.real(0, 8)));
        const float pushes[] = {0.0f, 0.0f, depthPush(error, near)};
        float depths[] = {0.0f, depth, depth};
        const uint32_t ordinals[] = {0, 1, 2};
        pushDepths(depths, ordinals, pushes);
        EXPECT_EQ(depths[0], 0.0f);
        EXPECT_EQ(depths[1], depth);
        const long double away = static_cast<long double>(near) / static_cast<long double>(depth) +
                                 static_cast<long double>(error);
        const long double pushed = static_cast<long double>(near) / away;
        ASSERT_LE(static_cast<long double>(depths[2]), pushed) << i;
        ASSERT_GE(static_cast<long double>(depths[2]), pushed * (1.0L - 1e-6L)) << i;
    }
}

}  // namespace
}  // namespace pagoda::hlod
