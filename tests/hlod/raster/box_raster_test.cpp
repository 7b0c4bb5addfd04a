// Boxes counted by rays through every pixel, and boxes that must never hide what is in them.
#include "hlod/raster/box_raster.h"
#include "hlod/view/screen_box.h"
#include "tests/hlod/raster/raster_cases.h"

#include <gtest/gtest.h>

#include <limits>

namespace pagoda::hlod {
namespace {

using test::Cases;

constexpr size_t kPixels = size_t{test::kWidthPx} * test::kHeightPx;

// Where the ray enters the box, as depth along the view; infinite for a miss.
double entry(const Vec3d& ray, const Vec3d& low, const Vec3d& high) {
    double in = 0.0, out = std::numeric_limits<double>::max();
    for (int axis = 0; axis < 3; ++axis) {
        if (ray[axis] == 0.0) {
            if (low[axis] > 0.0 || high[axis] < 0.0) return std::numeric_limits<double>::infinity();
            continue;
        }
        const double a = low[axis] / ray[axis], b = high[axis] / ray[axis];
        in = std::max(in, std::min(a, b));
        out = std::min(out, std::max(a, b));
    }
    return in < out ? in : std::numeric_limits<double>::infinity();
}

// Pixels that the grown box shows, when its sides are moved out by `more` of its distance and
// compared with depths that are so much farther.
uint64_t countByRays(const View& view, const Box3d& box, const std::vector<float>& depths,
                     double more) {
    const Vec3d least = box.min - view.eye(), most = box.max - view.eye();
    const double centreDistance = glm::length(0.5 * (least + most));
    const double pixel = 0.5 * 2.0 * view.tanY() / view.camera().heightPx * centreDistance;
    const Vec3d grow = glm::max(Vec3d(pixel), 1e-5 * glm::max(glm::abs(least), glm::abs(most))) +
                       Vec3d(more * (centreDistance + glm::length(most - least)));
    uint64_t count = 0;
    for (int row = 0; row < test::kHeightPx; ++row) {
        for (int column = 0; column < test::kWidthPx; ++column) {
            const double depth =
                entry(test::rayThrough(view, column, row), least - grow, most + grow);
            const size_t at = static_cast<size_t>(row * test::kWidthPx + column);
            count += view.nearModelUnits() / depth * (1.0 + more) >= depths[at] && depth < 1e300;
        }
    }
    return count;
}

std::vector<float> depthsOf(Cases& cases, const View& view) {
    std::vector<float> depths(kPixels);
    const double scale = view.nearModelUnits();
    const bool isEmpty = cases.whole(0, 3) == 0;
    for (float& depth : depths) {
        depth = isEmpty ? 0.0f : static_cast<float>(scale / cases.real(10.0, 1500.0));
    }
    return depths;
}

TEST(BoxRaster, CountsThePixelsWhoseRaysEnterTheGrownBoxBeforeTheDepths) {
    Cases cases(11);
    int counted = 0, exact = 0, shown = 0;
    for (int i = 0; i < 6000; ++i) {
        const View view = cases.view();
        const Box3i lattice = cases.box();
        const Box3d box{Vec3d(lattice.min), Vec3d(lattice.max)};
        if (crossesNear(view, box) || !view.intersectsFrustum(box)) continue;
        const std::vector<float> depths = depthsOf(cases, view);
        BoxRaster raster;
        raster.setDepths(view, depths);
        const uint64_t pixels = raster.visiblePixels(box);
        const uint64_t least = countByRays(view, box, depths, -1e-9);
        const uint64_t most = countByRays(view, box, depths, 1e-9);
        ASSERT_GE(pixels, least) << i;
        if (pixels != kPixels) {
            ASSERT_LE(pixels, most) << i;
        }
        ++counted;
        exact += least == most;
        shown += pixels > 0;
    }
    EXPECT_GT(counted, 2000);
    EXPECT_GT(shown, counted / 3);
    EXPECT_GT(exact, counted * 95 / 100);  // else the bounds say little
}

// The eye a little before a large flat box: growing pushes corners behind it.
TEST(BoxRaster, ABoxRightBeforeTheEyeIsNeverHidden) {
    Cases cases(12);
    int asked = 0;
    for (int i = 0; i < 2000; ++i) {
        Camera camera;
        camera.widthPx = test::kWidthPx;
        camera.heightPx = test::kHeightPx;
        camera.eye = cases.point(100, 900);
        const double tilt = std::pow(10.0, cases.real(-6, 0));
        camera.target = camera.eye + Vec3d(tilt * cases.real(-1, 1), tilt * cases.real(-1, 1), -1);
        const View view(camera, Box3d{Vec3d(0), Vec3d(1024)});
        const double gap = view.nearModelUnits() * std::pow(10.0, cases.real(0, 4));
        const Vec3d half(std::pow(10.0, cases.real(-1, 3)), std::pow(10.0, cases.real(-1, 3)), 0.5);
        const Vec3d centre = camera.eye - Vec3d(0, 0, gap + half.z);
        const Box3d box{centre - half, centre + half};
        if (crossesNear(view, box)) continue;
        ++asked;
        std::vector<float> depths(kPixels, 0.0f);
        BoxRaster raster;
        raster.setDepths(view, depths);
        EXPECT_GE(raster.visiblePixels(box), countByRays(view, box, depths, -1e-9)) << i;
    }
    EXPECT_GT(asked, 100);
}

TEST(BoxRaster, NeverHidesABoxWhoseContentShows) {
    Cases cases(13);
    int asked = 0, showing = 0, hidden = 0;
    for (int i = 0; i < 10000; ++i) {
        const View view = cases.view();
        const SoftwareMesh content = cases.mesh(cases.box(), cases.whole(1, 8));
        const Box3d box = test::tightBox(content);
        if (crossesNear(view, box) || !view.intersectsFrustum(box)) continue;
        TriangleRaster drawn(test::unitLattice());
        drawn.begin(view);
        drawn.draw(cases.mesh({Vec3i(0), Vec3i(1024)}, 5), ooc::NodeId::root());
        BoxRaster raster;
        raster.setDepths(view, drawn.picture().depths);
        const uint64_t before = raster.visiblePixels(box);
        drawn.draw(content, ooc::NodeId::root().child(1));
        const auto& ordinals = drawn.picture().nodeOrdinals;
        const auto shown = static_cast<uint64_t>(std::count(ordinals.begin(), ordinals.end(), 2u));
        ASSERT_GE(before, shown) << i;
        raster.setDepths(view, drawn.picture().depths);
        ASSERT_GE(raster.visiblePixels(box), shown) << i;  // nor behind itself
        ++asked;
        showing += shown > 0;
        hidden += before == 0;
    }
    EXPECT_GT(asked, 4000);
    EXPECT_GT(showing, 1000);
    EXPECT_GT(hidden, 100);
}

}  // namespace
}  // namespace pagoda::hlod
