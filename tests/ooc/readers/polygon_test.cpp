#include "ooc/readers/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace pagoda::ooc {
namespace {

using Triangle = PolygonCutter::Triangle;

// Newell's area vector: the truth about an outline, whatever its cut.
Vec3d areaVector(std::span<const Vec3d> outline) {
    Vec3d sum(0);
    for (size_t k = 0; k < outline.size(); ++k) {
        sum += glm::cross(outline[k] - outline[0], outline[(k + 1) % outline.size()] - outline[0]);
    }
    return sum * 0.5;
}

double sumOfAreas(std::span<const Vec3d> outline, std::span<const Triangle> triangles) {
    double sum = 0;
    for (const Triangle& t : triangles) {
        sum +=
            glm::length(glm::cross(outline[t[1]] - outline[t[0]], outline[t[2]] - outline[t[0]])) /
            2;
    }
    return sum;
}

// Every edge of the outline once in its sense, every other edge once each way.
void expectCutOfOutline(size_t n, std::span<const Triangle> triangles) {
    ASSERT_EQ(triangles.size(), n - 2);
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (const Triangle& t : triangles) {
        for (size_t k = 0; k < 3; ++k) {
            ASSERT_LT(t[k], n);
            ++edges[{t[k], t[(k + 1) % 3]}];
        }
    }
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1) << edge.first << "-" << edge.second;
        const bool isOutline = edge.second == (edge.first + 1) % n;
        EXPECT_EQ(edges.contains({edge.second, edge.first}), !isOutline);
    }
}

TEST(PolygonCutter, CutsAConcaveQuadAlongTheDiagonalInside) {
    const std::vector<Vec3d> arrow = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {1, 1, 0}};
    PolygonCutter cutter;
    for (size_t shift = 0; shift < 4; ++shift) {  // whichever corner comes first
        std::vector<Vec3d> outline;
        for (size_t k = 0; k < 4; ++k) outline.push_back(arrow[(k + shift) % 4]);
        const auto triangles = cutter.cut(outline);
        expectCutOfOutline(4, triangles);
        EXPECT_DOUBLE_EQ(sumOfAreas(outline, triangles), 1.0);
    }
}

TEST(PolygonCutter, CoversRandomStarsInAnyPlaneExactlyOnce) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.1, 1.0);
    PolygonCutter cutter;
    for (int round = 0; round < 200; ++round) {
        const auto n = 4 + static_cast<size_t>(round) % 60;
        const Vec3d u = glm::normalize(Vec3d(unit(random), unit(random) - 0.5, unit(random) - 0.5));
        const Vec3d w = glm::normalize(glm::cross(u, Vec3d(unit(random) - 0.5, unit(random), 0.3)));
        const Vec3d v = glm::cross(w, u);
        const Vec3d far(2.68e6, 1.25e6, -4.0e5);  // as national coordinates are
        std::vector<Vec3d> star;
        for (size_t k = 0; k < n; ++k) {
            const double angle =
                2 * 3.14159265358979 * static_cast<double>(k) / static_cast<double>(n);
            const double radius = 100 * unit(random);
            star.push_back(far + radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
        const auto triangles = cutter.cut(star);
        expectCutOfOutline(n, triangles);
        const double area = glm::length(areaVector(star));
        EXPECT_NEAR(sumOfAreas(star, triangles), area, 1e-5 * area) << "round " << round;
    }
}

TEST(PolygonCutter, CutsASpiralThatOnlyEarClippingGetsRight) {
    std::vector<Vec3d> spiral;
    constexpr int kSteps = 100;
    for (int k = 0; k < kSteps; ++k)
        spiral.push_back({k * 0.2 * std::cos(k * 0.3), k * 0.2 * std::sin(k * 0.3), 0});
    for (int k = kSteps - 1; k >= 0; --k) {
        const double r = k * 0.2 + 1.0;
        spiral.push_back({r * std::cos(k * 0.3), r * std::sin(k * 0.3), 0});
    }
    PolygonCutter cutter;
    const auto triangles = cutter.cut(spiral);
    expectCutOfOutline(spiral.size(), triangles);
    const double area = glm::length(areaVector(spiral));
    EXPECT_NEAR(sumOfAreas(spiral, triangles), area, 1e-9 * area);
}

TEST(PolygonCutter, LeavesNoTriangleWithoutAreaWhereCornersAreStraight) {
    const std::vector<Vec3d> square = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0},
                                       {2, 2, 0}, {1, 2, 0}, {0, 2, 0}};
    PolygonCutter cutter;
    const auto triangles = cutter.cut(square);
    expectCutOfOutline(6, triangles);
    for (const Triangle& t : triangles) {
        EXPECT_GT(sumOfAreas(square, std::span(&t, 1)), 0.1);
    }
    EXPECT_DOUBLE_EQ(sumOfAreas(square, triangles), 4.0);
}

TEST(PolygonCutter, GivesTwoLessThanCornersWhateverTheOutlineIs) {
    const double nan = std::nan("");
    const std::vector<std::vector<Vec3d>> outlines = {
        {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},             // crosses itself
        {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},  // a point
        {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},             // a line
        {{0, 0, 0}, {1, 0, 0}, {nan, 1, 0}, {0, 1, 0}},
        {{0, 0, 0}, {1e300, 0, 0}, {1e300, 1e300, 0}, {0, 1e300, 0}},
        std::vector<Vec3d>(5000, Vec3d(1)),
    };
    PolygonCutter cutter;
    for (const auto& outline : outlines) {
        const auto triangles = cutter.cut(outline);
        EXPECT_EQ(triangles.size(), outline.size() - 2);
        for (const Triangle& t : triangles) {
            for (const uint32_t corner : t) ASSERT_LT(corner, outline.size());
        }
    }
    EXPECT_TRUE(cutter.cut(std::vector<Vec3d>(2)).empty());
    EXPECT_TRUE(cutter.cut({}).empty());
}

}  // namespace
}  // namespace pagoda::ooc
