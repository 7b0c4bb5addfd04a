#include "tools/opening/surface_sketch.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace pagoda::tools {
namespace {

using Corners = std::array<Vec3d, 3>;

// A unit sphere about `centre`, of 2 * rows^2 triangles.
std::vector<Corners> sphere(int rows, const Vec3d& centre) {
    const auto at = [&](int i, int j) {
        const double u = M_PI * i / rows, v = 2 * M_PI * j / rows;
        return centre + Vec3d(std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), std::cos(u));
    };
    std::vector<Corners> triangles;
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < rows; ++j) {
            triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return triangles;
}

SurfaceSketch sketchOf(const std::vector<Corners>& triangles, SurfaceSketch::Limits limits) {
    SurfaceSketch sketch(limits);
    for (const Corners& t : triangles) sketch.add(t[0], t[1], t[2], 0xFF204060u);
    return sketch;
}

// Of random points of the sphere: the share that lies in no disc and no triangle's disc.
double uncoveredShare(const viewer::Preview& preview, const Vec3d& centre) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    int uncovered = 0;
    constexpr int kPoints = 500;
    for (int i = 0; i < kPoints; ++i) {
        const Vec3d p =
            centre + glm::normalize(Vec3d(normal(random), normal(random), normal(random)));
        double nearest = 1e9;
        for (const viewer::PreviewVertex& disc : preview.discs) {
            nearest = std::min(nearest, glm::distance(p, preview.origin + Vec3d(disc.position)));
        }
        if (nearest > 0.5 * preview.discModelUnits) ++uncovered;
    }
    return double(uncovered) / kPoints;
}

TEST(SurfaceSketch, FewTrianglesStayAsTheyAre) {
    const std::vector<Corners> triangles = sphere(20, {5, 6, 7});
    const SurfaceSketch sketch = sketchOf(triangles, {.cells = 1000, .triangles = 1000});
    const viewer::Preview preview = sketch.picture(false);
    EXPECT_EQ(preview.trianglesSeen, 800u);
    // The two poles have triangles without area, which are smaller than any cell.
    ASSERT_EQ(preview.corners.size() / 3 + preview.discs.size(), 800u);
    size_t met = 0;
    for (size_t i = 0; i < preview.corners.size(); i += 3) {
        for (const Corners& t : triangles) {
            bool isSame = true;
            for (size_t k = 0; k < 3; ++k) {
                const Vec3d corner = preview.origin + Vec3d(preview.corners[i + k].position);
                isSame &= glm::distance(corner, t[k]) < 1e-6;
            }
            met += isSame ? 1 : 0;
        }
        EXPECT_EQ(preview.corners[i].colour, 0xFF204060u);
    }
    EXPECT_GE(met, preview.corners.size() / 3);
}

TEST(SurfaceSketch, StaysWithinItsLimitsAndCoversTheSurface) {
    const SurfaceSketch::Limits limits{.cells = 3000, .triangles = 500};
    const Vec3d centre(1000, -2000, 3000);
    SurfaceSketch sketch(limits);
    for (const Corners& t : sphere(300, centre)) {
        sketch.add(t[0], t[1], t[2], 0xFF204060u);
        ASSERT_LE(sketch.cellCount(), limits.cells);
        ASSERT_LE(sketch.triangleCount(), limits.triangles);
    }
    const viewer::Preview preview = sketch.picture(false);
    EXPECT_GT(preview.discs.size(), limits.cells / 5);
    EXPECT_TRUE(preview.corners.empty());
    const double cell = sketch.cellModelUnits();
    for (const viewer::PreviewVertex& disc : preview.discs) {
        const Vec3d fromCentre = preview.origin + Vec3d(disc.position) - centre;
        // A mean of points of the sphere in one cell is below the sphere by its curvature alone.
        EXPECT_NEAR(glm::length(fromCentre), 1.0, cell * cell + 1e-3);
        EXPECT_GT(std::abs(glm::dot(Vec3d(disc.normal), glm::normalize(fromCentre))), 0.98);
        EXPECT_EQ(disc.colour, 0xFF204060u);
    }
    EXPECT_LT(uncoveredShare(preview, centre), 0.01);
    EXPECT_LT(glm::distance(preview.box.min, centre - 1.0), 0.01);
    EXPECT_LT(glm::distance(preview.box.max, centre + 1.0), 0.01);
}

TEST(SurfaceSketch, ASampleShowsNoGapsWhereTrianglesWereLeftOut) {
    std::mt19937 random(3);
    SurfaceSketch sketch({.cells = 100'000, .triangles = 100'000});
    for (const Corners& t : sphere(400, {})) {
        if (random() % 16 == 0) sketch.add(t[0], t[1], t[2], 0xFFFFFFFFu);
    }
    EXPECT_LT(uncoveredShare(sketch.picture(true), {}), 0.05);
    EXPECT_GT(uncoveredShare(sketch.picture(false), {}), 0.3);
}

TEST(SurfaceSketch, ALargeTriangleAmongManySmallOnesStaysWhole) {
    SurfaceSketch sketch({.cells = 2000, .triangles = 200});
    for (const Corners& t : sphere(100, {})) sketch.add(t[0], t[1], t[2], 0xFFFFFFFFu);
    sketch.add({-5, -5, -2}, {5, -5, -2}, {0, 5, -2}, 0xFF0000FFu);
    for (const bool isSample : {false, true}) {
        const viewer::Preview preview = sketch.picture(isSample);
        ASSERT_EQ(preview.corners.size(), 3u);
        EXPECT_EQ(preview.corners[0].colour, 0xFF0000FFu);
        EXPECT_NEAR(std::abs(preview.corners[0].normal.z), 1.0f, 1e-6f);
    }
}

TEST(SurfaceSketch, PointsAndHugeCoordinatesEndWell) {
    SurfaceSketch sketch({.cells = 100, .triangles = 10});
    sketch.add({1, 1, 1}, {1, 1, 1}, {1, 1, 1}, 0xFFFFFFFFu);
    EXPECT_TRUE(sketch.picture(true).discs.empty());
    sketch.add({0, 0, 0}, {1e-9, 0, 0}, {0, 1e-9, 0}, 0xFFFFFFFFu);
    sketch.add({1e20, 0, 0}, {1e20, 1, 0}, {1e20, 0, 1}, 0xFFFFFFFFu);
    sketch.add({1e300, 0, 0}, {1e300, 1, 0}, {1e300, 0, 1}, 0xFFFFFFFFu);
    const viewer::Preview preview = sketch.picture(false);
    EXPECT_EQ(preview.trianglesSeen, 4u);
    EXPECT_LE(preview.discs.size() + preview.corners.size() / 3, 4u);
}

TEST(SurfaceSketch, TwoSidesOfAThinWallDoNotCancel) {
    SurfaceSketch sketch({.cells = 50, .triangles = 4});
    for (int i = 0; i < 40; ++i) {
        const double x = 0.1 * i;
        sketch.add({x, 0, 0}, {x + 0.1, 0, 0}, {x, 0.1, 0}, 0xFFFFFFFFu);
        sketch.add({x, 0, 1e-4}, {x, 0.1, 1e-4}, {x + 0.1, 0, 1e-4}, 0xFFFFFFFFu);
    }
    for (const viewer::PreviewVertex& disc : sketch.picture(false).discs) {
        EXPECT_NEAR(std::abs(disc.normal.z), 1.0f, 1e-5f);
    }
}

}  // namespace
}  // namespace pagoda::tools
