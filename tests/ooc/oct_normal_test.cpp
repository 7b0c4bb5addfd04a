#include "ooc/page_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace pagoda::ooc {
namespace {

TEST(OctNormal, KeepsAnyDirectionWithin0Point7Degrees) {
    // Squares of 1/127 on the octahedron: half a diagonal is 0.0056, stretched by up to sqrt(3) on
    // the sphere, so 0.55 degrees; a little is left for the folds.
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    double worst = 0;
    for (int i = 0; i < 200000; ++i) {
        const Vec3f unit = glm::normalize(Vec3f{normal(random), normal(random), normal(random)});
        const Vec3f back = decodeNormal(encodeNormal(unit));
        EXPECT_NEAR(glm::length(back), 1.0f, 1e-5f);
        worst =
            std::max(worst, std::asin(std::min(1.0, double(glm::length(glm::cross(unit, back))))));
        ASSERT_GT(glm::dot(unit, back), 0.9f) << unit.x << " " << unit.y << " " << unit.z;
    }
    EXPECT_LT(worst * 180 / 3.14159265, 0.7);
}

TEST(OctNormal, KeepsTheSixAxesExactly) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {-1.0f, 1.0f}) {
            Vec3f unit{0.0f};
            unit[axis] = sign;
            EXPECT_LT(glm::length(decodeNormal(encodeNormal(unit)) - unit), 1e-6f);
        }
    }
}

TEST(OctNormal, EncodesWhatItDecodes) {
    for (int u = -127; u <= 127; ++u) {
        for (int v = -127; v <= 127; ++v) {
            const OctNormal normal{static_cast<int8_t>(u), static_cast<int8_t>(v)};
            const Vec3f unit = decodeNormal(normal);
            EXPECT_LT(glm::length(decodeNormal(encodeNormal(unit)) - unit), 1e-5f) << u << " " << v;
        }
    }
}

TEST(OctNormal, SaysNoneForWhatIsNoDirection) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const Vec3f& bad : {Vec3f{0, 0, 0}, Vec3f{kNan, 0, 1}, Vec3f{kInfinity, 0, 0}}) {
        EXPECT_TRUE(encodeNormal(bad).isNone());
    }
    EXPECT_EQ(decodeNormal(OctNormal{}), Vec3f{0.0f});
    EXPECT_FALSE(encodeNormal(Vec3f{0, -1, 0}).isNone());
}

}  // namespace
}  // namespace pagoda::ooc
