// Boxes on the screen against rays: pixels of their outline, and the near plane.
#include "hlod/view/screen_box.h"
#include "tests/hlod/raster/raster_cases.h"

#include <gtest/gtest.h>

namespace pagoda::hlod {
namespace {

using test::Cases;

bool hits(const Vec3d& ray, const Vec3d& low, const Vec3d& high) {
    double in = 0.0, out = 1e300;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = low[axis] / ray[axis], b = high[axis] / ray[axis];
        in = std::max(in, std::min(a, b));
        out = std::min(out, std::max(a, b));
    }
    return in < out;
}

TEST(ScreenBox, PixelsOfTheOutlineAreThoseWhoseRaysMeetTheBox) {
    Cases cases(31);
    constexpr int kSamples = 4;  // along each side of a pixel
    int compared = 0;
    for (int i = 0; i < 1500; ++i) {
        const View view = cases.view();
        const Box3i lattice = cases.box();
        const Box3d box{Vec3d(lattice.min) - 0.01, Vec3d(lattice.max) + 0.01};
        if (crossesNear(view, box) || !view.intersectsFrustum(box)) continue;
        const Vec3d low = box.min - view.eye(), high = box.max - view.eye();
        double samples = 0, border = 0;
        bool last = false;
        for (int row = 0; row < kSamples * test::kHeightPx; ++row) {
            for (int column = 0; column < kSamples * test::kWidthPx; ++column) {
                const double x = 2.0 * (column + 0.5) / (kSamples * test::kWidthPx) - 1.0;
                const double y = 2.0 * (row + 0.5) / (kSamples * test::kHeightPx) - 1.0;
                const bool isHit = hits(
                    view.forward() + x * view.tanX() * view.right() + y * view.tanY() * view.up(),
                    low, high);
                samples += isHit;
                border += isHit != last;
                last = isHit;
            }
        }
        const double pixels = samples / (kSamples * kSamples);
        // A sample at the border stands for itself at most; slopes along rows are not counted.
        const double slack = 1.0 + (2.0 * border + 4.0 * test::kWidthPx) / (kSamples * kSamples);
        ASSERT_NEAR(boxPixels(view, box), pixels, slack) << i;
        ++compared;
    }
    EXPECT_GT(compared, 500);
}

TEST(ScreenBox, ABoxCrossesNearWhenACornerIsNotBehindThePlane) {
    Cases cases(32);
    int crossing = 0;
    for (int i = 0; i < 20000; ++i) {
        const View view = cases.view();
        const Box3i lattice = cases.box();
        const Box3d box{Vec3d(lattice.min), Vec3d(lattice.max)};
        double nearest = 1e300;
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d p((corner & 1) != 0 ? box.max.x : box.min.x,
                          (corner & 2) != 0 ? box.max.y : box.min.y,
                          (corner & 4) != 0 ? box.max.z : box.min.z);
            nearest = std::min(nearest, glm::dot(view.forward(), p - view.eye()));
        }
        if (std::abs(nearest - view.nearModelUnits()) < 1e-9) continue;
        ASSERT_EQ(crossesNear(view, box), nearest < view.nearModelUnits()) << i;
        crossing += crossesNear(view, box);
    }
    EXPECT_GT(crossing, 1000);
}

TEST(ScreenBox, TheRectangleHoldsTheOutline) {
    Cases cases(33);
    for (int i = 0; i < 3000; ++i) {
        const View view = cases.view();
        const Box3i lattice = cases.box();
        const Box3d box{Vec3d(lattice.min), Vec3d(lattice.max)};
        if (crossesNear(view, box)) continue;
        const ScreenRect rect = screenRect(view, box);
        const double area =
            rect.isEmpty() ? 0.0 : (rect.maxX - rect.minX) * (rect.maxY - rect.minY);
        ASSERT_LE(boxPixels(view, box), area + 1e-6) << i;
        ASSERT_GT(rect.nearestModelUnits, 0.0);
    }
}

}  // namespace
}  // namespace pagoda::hlod
