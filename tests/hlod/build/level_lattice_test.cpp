#include "hlod/build/level_lattice.h"

#include "hlod/build/build.h"
#include "ooc/store/database.h"
#include "tests/hlod/build/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace pagoda::hlod {
namespace {

using Point = std::array<int32_t, 3>;

Point pointOf(const Vec3i& p) {
    return {p.x, p.y, p.z};
}

SoupTriangle triangleOf(const Vec3i& a, const Vec3i& b, const Vec3i& c) {
    SoupTriangle triangle;
    triangle.corners = {a, b, c};
    return triangle;
}

// Places with an edge that is walked more often one way than the other.
std::set<Point> bordersOf(const std::vector<SoupTriangle>& triangles) {
    std::map<std::pair<Point, Point>, int> walks;
    for (const SoupTriangle& triangle : triangles) {
        for (size_t k = 0; k < 3; ++k) {
            const Point a = pointOf(triangle.corners[k]),
                        b = pointOf(triangle.corners[(k + 1) % 3]);
            ++walks[{a, b}];
            --walks[{b, a}];
        }
    }
    std::set<Point> borders;
    for (const auto& [edge, count] : walks) {
        if (count != 0) borders.insert({edge.first, edge.second});
    }
    return borders;
}

// A pyramid of four faces over a square in the plane z = 0, open below.
std::vector<SoupTriangle> pyramid(const Vec3i& apex, int32_t size) {
    const int32_t end = 1 + size;
    const std::array<Vec3i, 4> base = {Vec3i(1, 1, 0), {end, 1, 0}, {end, end, 0}, {1, end, 0}};
    std::vector<SoupTriangle> triangles;
    for (size_t i = 0; i < 4; ++i) {
        triangles.push_back(triangleOf(base[i], base[(i + 1) % 4], apex));
    }
    return triangles;
}

// A root cell whose lattice has 2^4 finest steps.
constexpr CellFrame kRoot{.origin = Vec3i(0), .bits = kLevelBits + 4, .extentBits = kLevelBits + 4};
constexpr Box3i kAnywhere{.min = Vec3i(0), .max = Vec3i(1 << (kLevelBits + 4))};

TEST(LevelLattice, EachLevelHasTwiceTheStepOfTheNextDownToTheFinest) {
    const ooc::NodeId root = ooc::NodeId::root();
    EXPECT_EQ(levelShift(cellFrame(root, 18)), 18 - kLevelBits);
    EXPECT_EQ(levelShift(cellFrame(root.child(5), 18)), 17 - kLevelBits);
    EXPECT_EQ(levelShift(cellFrame(root.child(5), kLevelBits)), 0);
}

TEST(LevelLattice, InteriorVerticesMoveToTheNearestPointAndBordersStay) {
    std::vector<SoupTriangle> triangles = pyramid({505, 519, 295}, 1000);
    const LevelSnap snap = snapToLevel(triangles, kRoot, kAnywhere, true);
    EXPECT_EQ(snap.borders, 4u);
    EXPECT_EQ(snap.moved, 1u);
    EXPECT_EQ(snap.kept, 0u);
    const std::vector<SoupTriangle> expected = pyramid({512, 512, 288}, 1000);
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(triangles[i].corners, expected[i].corners);
}

TEST(LevelLattice, ClusteredNodesHaveNoBordersToKeep) {
    std::vector<SoupTriangle> triangles = pyramid({505, 519, 295}, 1000);
    EXPECT_EQ(snapToLevel(triangles, kRoot, kAnywhere, false).moved, 5u);
    EXPECT_EQ(triangles[1].corners[0], Vec3i(1008, 0, 0));
}

TEST(LevelLattice, AVertexThatWouldTurnATriangleOverStays) {
    // The apex lies one step off the line of a side: rounded it would cross it.
    std::vector<SoupTriangle> triangles = pyramid({500, 2, 1}, 1000);
    const std::vector<SoupTriangle> before = triangles;
    const LevelSnap snap = snapToLevel(triangles, kRoot, kAnywhere, true);
    EXPECT_EQ(snap.moved, 0u);
    EXPECT_EQ(snap.kept, 1u);
    for (size_t i = 0; i < 4; ++i) EXPECT_EQ(triangles[i].corners, before[i].corners);
}

TEST(LevelLattice, NoVertexLeavesTheBounds) {
    std::vector<SoupTriangle> triangles = pyramid({505, 519, 295}, 1000);
    const Box3i tight{.min = Vec3i(0), .max = {1000, 1000, 295}};
    EXPECT_EQ(snapToLevel(triangles, kRoot, tight, true).moved, 1u);
    triangles = pyramid({505, 519, 297}, 1000);  // rounds up to 304
    const LevelSnap snap = snapToLevel(triangles, kRoot, {tight.min, {1000, 1000, 297}}, true);
    EXPECT_EQ(snap.moved, 0u);
    EXPECT_EQ(snap.kept, 1u);
    EXPECT_EQ(triangles[0].corners[2], Vec3i(505, 519, 297));
}

TEST(LevelLattice, NoVertexMovesOntoAnother) {
    // The third corner is a point of the level's lattice, and the nearest one to the apex.
    std::vector<SoupTriangle> triangles = pyramid({1002, 1001, 7}, 1007);
    EXPECT_EQ(snapToLevel(triangles, kRoot, kAnywhere, true).kept, 1u);
    EXPECT_EQ(triangles[0].corners[2], Vec3i(1002, 1001, 7));
    // Two apexes near one point: the first gets it.
    std::vector<SoupTriangle> two = pyramid({505, 519, 295}, 1000);
    const std::vector<SoupTriangle> other = pyramid({507, 517, 293}, 2000);
    two.insert(two.end(), other.begin(), other.end());
    const LevelSnap together = snapToLevel(two, kRoot, kAnywhere, true);
    EXPECT_EQ(together.moved, 1u);
    EXPECT_EQ(together.kept, 1u);
    EXPECT_EQ(two[0].corners[2], Vec3i(512, 512, 288));
    EXPECT_EQ(two[4].corners[2], Vec3i(507, 517, 293));
}

TEST(LevelLattice, InteriorsOfBuiltNodesLieOnTheirLevelAndBordersOnPlacesOfTheInput) {
    const test::TemporaryFolder folder;
    writePly(test::roughTorus(300, 120), folder / "torus.ply");
    BuildOptions options;
    options.inputs = expandInputs({(folder / "torus.ply").string()});
    options.target = folder / "torus.pagoda";
    options.threads = 1;
    options.nodeTriangles = 1024;
    Progress progress;
    const BuildReport report = buildDatabase(options, progress);
    ASSERT_EQ(report.sloppyNodes, 0u);

    const ooc::Database database = ooc::Database::open(folder / "torus.pagoda");
    const int extentBits = database.header().lattice.extentBits;
    std::vector<std::pair<int, std::vector<SoupTriangle>>> inner;  // step of the level
    std::set<Point> inputPlaces;
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& record, ooc::NodeRef) {
            const auto page = database.readPage(record);
            EXPECT_TRUE(page.value) << page.fault;
            if (record.isLeaf()) {
                for (const Vec3i& p : page.value->mesh.positions) inputPlaces.insert(pointOf(p));
            } else {
                const int bits = extentBits - record.id.depth();
                inner.emplace_back(1 << std::max(0, bits - kLevelBits),
                                   unpackPage(page.value->mesh));
            }
            return true;
        },
        [](uint32_t, const std::string& fault) { ADD_FAILURE() << fault; });
    ASSERT_GT(inner.size(), 20u);

    size_t borders = 0, interiors = 0, off = 0, coarse = 0;
    for (const auto& [step, triangles] : inner) {
        const std::set<Point> border = bordersOf(triangles);
        std::set<Point> places;
        for (const SoupTriangle& triangle : triangles) {
            for (const Vec3i& p : triangle.corners) places.insert(pointOf(p));
        }
        for (const Point& p : places) {
            if (border.contains(p)) {
                ++borders;
                EXPECT_TRUE(inputPlaces.contains(p));
                continue;
            }
            ++interiors;
            coarse += step > 8 ? 1u : 0u;
            if (p[0] % step != 0 || p[1] % step != 0 || p[2] % step != 0) ++off;
        }
    }
    EXPECT_EQ(off, report.keptVertices);
    EXPECT_LT(off * 100, interiors);
    EXPECT_GT(borders, 1000u);
    EXPECT_GT(coarse, 1000u);
}

}  // namespace
}  // namespace pagoda::hlod
