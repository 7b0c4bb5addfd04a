// The grid that walks rely on: no triangle passes through a free cell.
#include "tools/paths/occupancy.h"

#include "tools/generate/random.h"
#include "tools/paths/poses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pagoda::tools {
namespace {

constexpr Box3d kBounds{Vec3d(0.0), Vec3d(10.0)};

Vec3d point(Random& random) {
    return {random.range(0, 10), random.range(0, 10), random.range(0, 10)};
}

std::vector<Triangle> someTriangles(size_t count, double size, Random& random) {
    std::vector<Triangle> triangles;
    for (size_t i = 0; i < count; ++i) {
        const Vec3d a = point(random);
        triangles.push_back(
            {a, a + size * (point(random) / 5.0 - 1.0), a + size * (point(random) / 5.0 - 1.0)});
    }
    return triangles;
}

TEST(Occupancy, EveryPointOfATriangleLiesInASolidCell) {
    Random random(1);
    for (const double size : {0.05, 1.0, 8.0}) {
        Occupancy grid(kBounds, 0.25, 1'000'000);
        const std::vector<Triangle> triangles = someTriangles(50, size, random);
        for (const Triangle& t : triangles) ASSERT_TRUE(grid.addTriangle(t));
        for (const Triangle& t : triangles) {
            for (int i = 0; i < 2000; ++i) {
                double u = random.unit(), v = random.unit();
                if (u + v > 1) u = 1 - u, v = 1 - v;
                const Vec3d p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
                if (kBounds.contains(p)) {
                    ASSERT_TRUE(grid.isSolid(grid.cellAt(p)));
                }
            }
        }
    }
}

TEST(Occupancy, SolidCellsAreHardlyMoreThanTheTriangleReaches) {
    // A slanted triangle: no solid cell's centre is farther from its plane than half a cell's
    // diagonal.
    Occupancy grid(kBounds, 0.1, 1'000'000);
    const Triangle t{Vec3d(1, 1, 1), Vec3d(9, 2, 4), Vec3d(3, 8, 7)};
    ASSERT_TRUE(grid.addTriangle(t));
    const Vec3d normal = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    size_t solid = 0;
    for (const Vec3i& block : grid.sortedBlocks()) {
        for (int i = 0; i < 512; ++i) {
            const Vec3i cell = block * 8 + Vec3i(i & 7, i >> 3 & 7, i >> 6);
            if (!grid.isSolid(cell)) continue;
            ++solid;
            const Vec3d centre = grid.cellMin(cell) + 0.05;
            EXPECT_LE(std::abs(glm::dot(centre - t[0], normal)), 0.05 * std::sqrt(3.0) + 1e-6);
        }
    }
    EXPECT_GT(solid, 2000u);
}

TEST(Occupancy, FreeLengthsEndAtTheFirstSolidCell) {
    Random random(2);
    Occupancy grid(kBounds, 0.25, 1'000'000);
    for (const Triangle& t : someTriangles(40, 1.0, random)) ASSERT_TRUE(grid.addTriangle(t));
    size_t hits = 0;
    for (int i = 0; i < 300; ++i) {
        const Vec3d from = point(random);
        const Vec3d direction = glm::normalize(point(random) - 5.0);
        if (grid.isSolid(grid.cellAt(from))) continue;
        const double length = grid.freeLength(from, direction, 6);
        for (double at = 0; at < length - 1e-6; at += 0.01) {
            ASSERT_FALSE(grid.isSolid(grid.cellAt(from + at * direction)));
        }
        if (length == 6) continue;
        ++hits;
        EXPECT_TRUE(grid.isSolid(grid.cellAt(from + (length + 1e-6) * direction)));
        EXPECT_TRUE(grid.isClear(from, from + (length - 1e-6) * direction));
        EXPECT_FALSE(grid.isClear(from, from + (length + 1e-6) * direction));
    }
    EXPECT_GT(hits, 25u);
}

TEST(Occupancy, TooManyBlocksAreRefusedAtOnce) {
    Occupancy grid({Vec3d(0.0), Vec3d(1e6)}, 0.1, 1000);
    EXPECT_FALSE(grid.addTriangle({Vec3d(0, 0, 1), Vec3d(1e6, 0, 1), Vec3d(0, 1e6, 1)}));
    EXPECT_FALSE(grid.addTriangle({Vec3d(0, 0, 1), Vec3d(1, 0, 1), Vec3d(0, 1, 1)}));
}

TEST(Poses, AMarchGoesAsFarAsOneOfItsBoundsAndNoFarther) {
    std::vector<Pose> samples;
    for (int i = 0; i < 400; ++i) {  // a straight way, then a turn on the spot, then back
        const double turn = std::clamp((i - 100) * 0.02, 0.0, 3.14);
        const double x = i < 100 ? 0.1 * i : i < 257 ? 10 : 10 - 0.1 * (i - 257);
        samples.push_back({{x, 0, 0}, directionOf(turn, 0.0)});
    }
    const Pace pace = paceOf(0.25, 3, 100);
    const std::vector<Pose> poses = march(samples, pace, 1000, false);
    EXPECT_GT(poses.size(), 100u);
    for (size_t i = 1; i < poses.size(); ++i) {
        const double move = glm::length(poses[i].eye - poses[i - 1].eye) / 0.25;
        const double turn = degreesBetween(poses[i].gaze, poses[i - 1].gaze) / 3;
        EXPECT_NEAR(std::max(move, turn), 1, 1e-6) << i;
    }
}

}  // namespace
}  // namespace pagoda::tools
