#include "hlod/build/soup.h"

#include <gtest/gtest.h>

#include <random>

namespace pagoda::hlod {
namespace {

TEST(Soup, homeDepthIsTheFirstDepthWhoseCellsAreSmallerThanFourTimesTheLongestEdge) {
    std::mt19937 random(1);
    for (int round = 0; round < 20000; ++round) {
        const int extentBits = 1 + static_cast<int>(random() % 30);
        const uint32_t mask =
            (uint32_t{1} << (1 + random() % static_cast<uint32_t>(extentBits))) - 1;
        std::array<Vec3i, 3> corners;
        for (Vec3i& corner : corners) {
            for (int axis = 0; axis < 3; ++axis)
                corner[axis] = static_cast<int32_t>(random() & mask);
        }
        if (hasNoArea(corners)) continue;
        long double longest = 0;
        for (size_t i = 0; i < 3; ++i) {
            const Vec3d edge = Vec3d(corners[i]) - Vec3d(corners[(i + 1) % 3]);
            longest = std::max(longest, static_cast<long double>(edge.x) * edge.x +
                                            static_cast<long double>(edge.y) * edge.y +
                                            static_cast<long double>(edge.z) * edge.z);
        }
        int expected = 0;
        while (!(std::ldexp(1.0L, 2 * (extentBits - expected)) < 16 * longest)) ++expected;
        ASSERT_EQ(homeDepth(corners, extentBits), expected);
    }
}

TEST(Soup, noAreaIsExactAtTheEdgeOfTheLattice) {
    const int32_t far = 1 << 30;
    EXPECT_TRUE(
        hasNoArea({Vec3i{0, 0, 0}, Vec3i{far, far, far}, Vec3i{far / 2, far / 2, far / 2}}));
    EXPECT_FALSE(
        hasNoArea({Vec3i{0, 0, 0}, Vec3i{far, far, far}, Vec3i{far / 2, far / 2, far / 2 + 1}}));
    EXPECT_FALSE(hasNoArea({Vec3i{0, 0, 0}, Vec3i{far, 0, 0}, Vec3i{0, 1, 0}}));
    EXPECT_TRUE(hasNoArea({Vec3i{1, 2, 3}, Vec3i{1, 2, 3}, Vec3i{5, 5, 5}}));
}

TEST(Soup, recordsKeepWhatTheLayoutHolds) {
    SoupTriangle triangle;
    triangle.corners = {Vec3i{1, 2, 3}, Vec3i{-4, 5, 6}, Vec3i{7, 8, 1 << 30}};
    triangle.object = 11;
    triangle.material = 12;
    triangle.colours = {1, 2, 3};
    triangle.normals = {ooc::OctNormal{1, 2}, ooc::OctNormal{3, 4}, ooc::OctNormal{5, 6}};
    for (const bool colours : {false, true}) {
        for (const bool normals : {false, true}) {
            const SoupLayout layout{colours, normals};
            std::vector<std::byte> bytes(layout.bytes());
            layout.store(triangle, bytes.data());
            const SoupTriangle back = layout.load(bytes.data());
            EXPECT_EQ(back.corners, triangle.corners);
            EXPECT_EQ(back.object, 11u);
            EXPECT_EQ(back.material, 12u);
            EXPECT_EQ(back.colours == triangle.colours, colours);
            EXPECT_EQ(back.normals == triangle.normals, normals);
        }
    }
}

}  // namespace
}  // namespace pagoda::hlod
