#include "hlod/build/cluster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <tuple>

namespace pagoda::hlod {
namespace {

constexpr int kExtentBits = 11;
const std::vector<bool> kMaterials = {false, true};  // 1 is translucent

using Triangles = std::vector<SoupTriangle>;

double area(const SoupTriangle& triangle) {
    const Vec3d a(triangle.corners[0]), b(triangle.corners[1]), c(triangle.corners[2]);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

double areaOf(const Triangles& triangles) {
    double sum = 0;
    for (const SoupTriangle& triangle : triangles) sum += area(triangle);
    return sum;
}

Box3i boxOf(const Triangles& triangles) {
    Box3i box;
    for (const SoupTriangle& triangle : triangles) {
        for (const Vec3i& corner : triangle.corners) box.extend(corner);
    }
    return box;
}

// A grid of (columns + 1) x (rows + 1) points, two triangles a square.
template <typename Point>
Triangles gridSurface(int columns, int rows, uint32_t material, Point&& point) {
    Triangles triangles;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const Vec3i a = point(column, row), b = point(column + 1, row),
                        c = point(column + 1, row + 1), d = point(column, row + 1);
            for (const std::array<Vec3i, 3>& corners : {std::array{a, b, c}, std::array{a, c, d}}) {
                SoupTriangle triangle;
                triangle.corners = corners;
                triangle.material = material;
                triangle.object = static_cast<uint32_t>(triangles.size());
                if (!hasNoArea(corners)) triangles.push_back(triangle);
            }
        }
    }
    return triangles;
}

Triangles sphere(int columns, int rows, double radius, const Vec3d& centre, uint32_t material) {
    return gridSurface(columns, rows, material, [&](int column, int row) {
        const double around = 2 * std::numbers::pi * (column % columns) / columns,
                     down = std::numbers::pi * row / rows;
        const Vec3d out(std::sin(down) * std::cos(around), std::sin(down) * std::sin(around),
                        std::cos(down));
        return Vec3i(glm::round(centre + radius * out));
    });
}

// A colour for each place, so that corners that coincide agree.
void paintRandomly(Triangles& triangles) {
    for (SoupTriangle& triangle : triangles) {
        for (size_t corner = 0; corner < 3; ++corner) {
            const Vec3i& p = triangle.corners[corner];
            std::mt19937 random(static_cast<uint32_t>(p.x * 73 + p.y * 9973 + p.z * 999983));
            triangle.colours[corner] = static_cast<uint32_t>(random());
        }
    }
}

// A grid of cells as the papers tell it: what it should hold, worked out with maps.
using CellKey = std::tuple<int, int, int, bool>;
using Triple = std::array<CellKey, 3>;

struct Grid {
    std::map<CellKey, std::array<double, 5>> colours;  // RGBA times area, then area
    std::set<Triple> triples;                          // sorted; of three different cells
};

CellKey cellOf(const Vec3i& point, int size, bool isTranslucent) {
    return {point.x / size, point.y / size, point.z / size, isTranslucent};
}

Grid gridOf(const Triangles& source, int size) {
    Grid grid;
    for (const SoupTriangle& triangle : source) {
        Triple triple;
        for (size_t corner = 0; corner < 3; ++corner) {
            triple[corner] = cellOf(triangle.corners[corner], size, kMaterials[triangle.material]);
            std::array<double, 5>& sums = grid.colours[triple[corner]];
            for (size_t channel = 0; channel < 4; ++channel) {
                sums[channel] +=
                    area(triangle) * ((triangle.colours[corner] >> (8 * channel)) & 255);
            }
            sums[4] += area(triangle);
        }
        std::sort(triple.begin(), triple.end());
        if (triple[0] != triple[1] && triple[1] != triple[2]) grid.triples.insert(triple);
    }
    return grid;
}

// Whether a corner may stand for the cell: inside it (closed: it was rounded) and of its mean
// colour.
bool standsFor(const CellKey& cell, const Grid& grid, const Vec3i& point, uint32_t rgba, int size) {
    const Vec3i low = Vec3i(std::get<0>(cell), std::get<1>(cell), std::get<2>(cell)) * size;
    if (!Box3i{low, low + size}.contains(point)) return false;
    const std::array<double, 5>& sums = grid.colours.at(cell);
    for (size_t channel = 0; channel < 4; ++channel) {
        const double value = (rgba >> (8 * channel)) & 255;
        if (std::abs(value - sums[channel] / sums[4]) > 0.5 + 1e-6) return false;
    }
    return true;
}

// The cells that each result triangle stands for, when all of them are triples of the grid.
std::optional<std::set<Triple>> triplesShown(const Triangles& result, const Grid& grid, int size) {
    std::set<Triple> shown;
    for (const SoupTriangle& triangle : result) {
        Triple triple;
        for (size_t corner = 0; corner < 3; ++corner) {
            bool found = false;
            const Vec3i& p = triangle.corners[corner];
            for (int step = 0; step < 8 && !found; ++step) {  // a border belongs to both sides
                const Vec3i aside = p - Vec3i(step & 1, (step >> 1) & 1, step >> 2);
                if (aside.x < 0 || aside.y < 0 || aside.z < 0) continue;
                triple[corner] = cellOf(aside, size, kMaterials[triangle.material]);
                found = grid.colours.contains(triple[corner]) &&
                        standsFor(triple[corner], grid, p, triangle.colours[corner], size);
            }
            if (!found) return std::nullopt;
        }
        std::sort(triple.begin(), triple.end());
        if (!grid.triples.contains(triple) || !shown.insert(triple).second) return std::nullopt;
    }
    return shown;
}

Triangles twoSpheres() {
    Triangles triangles = sphere(50, 25, 640, Vec3d(1000, 900, 1010), 0);
    const Triangles inner = sphere(30, 15, 400, Vec3d(1010, 905, 1000), 1);
    triangles.insert(triangles.end(), inner.begin(), inner.end());
    paintRandomly(triangles);
    return triangles;
}

TEST(Cluster, isTheFinestGridsTriplesWithCornersInTheirCellsAndMeanColours) {
    const Triangles source = twoSpheres();
    for (const uint32_t budget : {60u, 250u, 700u}) {
        SCOPED_TRACE(budget);
        const Triangles result =
            clusterToBudget(source, budget, kExtentBits, kMaterials, Outline::AsClustered);
        ASSERT_LE(result.size(), budget);
        int size = 0;  // of the grid that explains the result
        std::set<Triple> expected;
        int finestThatFits = 0;
        for (int candidate = 40; candidate < 1280; ++candidate) {
            const Grid grid = gridOf(source, candidate);
            if (grid.triples.size() > budget) continue;
            if (finestThatFits == 0) finestThatFits = candidate;
            if (grid.triples.size() < result.size()) continue;
            const auto shown = triplesShown(result, grid, candidate);
            if (!shown) continue;
            size = candidate;
            expected = grid.triples;
            // Only triangles that lost their area in rounding may be missing.
            EXPECT_GE(shown->size() + 3, expected.size());
            break;
        }
        ASSERT_GT(size, 0) << "no grid explains the result";
        // Counts rise and fall a little from one size to the next: 2% by the header, and as much
        // again for that.
        EXPECT_LE(size, finestThatFits * 1.08 + 1);
        EXPECT_GT(static_cast<double>(result.size()), 0.7 * budget);
    }
}

TEST(Cluster, keepsAnyBudgetAndMakesNoTriangleWithoutArea) {
    std::mt19937 random(3);
    Triangles source = sphere(24, 12, 300, Vec3d(1024, 1024, 1024), 0);
    for (int i = 0; i < 600; ++i) {  // and a soup around it, over the whole lattice
        SoupTriangle triangle;
        for (Vec3i& corner : triangle.corners) {
            corner = Vec3i(random() % 2049, random() % 2049, random() % 2049);
        }
        triangle.material = random() % 2;
        if (!hasNoArea(triangle.corners)) source.push_back(triangle);
    }
    for (const Outline outline : {Outline::AsClustered, Outline::Unshrunk}) {
        for (const uint32_t budget : {1u, 2u, 3u, 7u, 20u, 64u, 300u, 5000u}) {
            const Triangles result =
                clusterToBudget(source, budget, kExtentBits, kMaterials, outline);
            EXPECT_LE(result.size(), budget);
            for (const SoupTriangle& triangle : result) {
                EXPECT_FALSE(hasNoArea(triangle.corners));
                for (const Vec3i& corner : triangle.corners) {
                    EXPECT_TRUE((Box3i{Vec3i(0), Vec3i(1 << kExtentBits)}.contains(corner)));
                }
            }
        }
    }
}

TEST(Cluster, cellsWhoseMeansLieOnALineGiveNoTriangle) {
    // Mirrored about y = 10: where 8 and 12 share a cell, it stands for both at 10.
    Triangles source(2);
    source[0].corners = {Vec3i(1, 10, 5), Vec3i(31, 12, 5), Vec3i(61, 10, 5)};
    source[1].corners = {Vec3i(1, 10, 5), Vec3i(31, 8, 5), Vec3i(61, 10, 5)};
    EXPECT_TRUE(clusterToBudget(source, 1, kExtentBits, kMaterials, Outline::AsClustered).empty());
    EXPECT_EQ(clusterToBudget(source, 2, kExtentBits, kMaterials, Outline::AsClustered).size(), 2u);
}

TEST(Cluster, keepsTheBudgetOfAMeshThatStraddlesCellsLargerThanItself) {
    // The grid's planes are multiples of the cell: one may cut what is smaller than a cell.
    const Triangles source = sphere(16, 8, 20, Vec3d(1024, 1024, 1024), 0);
    for (const uint32_t budget : {1u, 2u, 4u, 8u}) {
        EXPECT_LE(
            clusterToBudget(source, budget, kExtentBits, kMaterials, Outline::AsClustered).size(),
            budget);
    }
}

TEST(Cluster, nothingGivesNothing) {
    EXPECT_TRUE(clusterToBudget({}, 100, kExtentBits, kMaterials, Outline::Unshrunk).empty());
}

TEST(Cluster, opaqueAndTranslucentInOnePlaceKeepTheirColours) {
    const auto sheet = [](uint32_t material, uint32_t rgba) {
        Triangles triangles = gridSurface(
            40, 40, material, [](int x, int y) { return Vec3i(20 + 50 * x, 20 + 50 * y, 700); });
        for (SoupTriangle& triangle : triangles) triangle.colours.fill(rgba);
        return triangles;
    };
    Triangles source = sheet(0, 0xFF2030C0u);
    const Triangles glass = sheet(1, 0x40D01080u);
    source.insert(source.end(), glass.begin(), glass.end());
    const Triangles result =
        clusterToBudget(source, 400, kExtentBits, kMaterials, Outline::AsClustered);
    size_t opaque = 0;
    for (const SoupTriangle& triangle : result) {
        if (triangle.material == 0) ++opaque;
        for (const uint32_t rgba : triangle.colours) {
            EXPECT_EQ(rgba, triangle.material == 0 ? 0xFF2030C0u : 0x40D01080u);
        }
    }
    EXPECT_EQ(opaque * 2, result.size());
    EXPECT_GT(opaque, 100u);
}

TEST(Cluster, aResultTakesObjectAndMaterialTogetherFromOneTriangle) {
    Triangles source = twoSpheres();
    for (SoupTriangle& triangle : source) triangle.object *= 5;  // no neighbours by chance
    const Triangles result =
        clusterToBudget(source, 300, kExtentBits, kMaterials, Outline::Unshrunk);
    ASSERT_FALSE(result.empty());
    const auto pairOf = [](const SoupTriangle& triangle) {
        return std::pair(triangle.object, triangle.material);
    };
    std::set<std::pair<uint32_t, uint32_t>> pairs;
    for (const SoupTriangle& triangle : source) pairs.insert(pairOf(triangle));
    for (const SoupTriangle& triangle : result) EXPECT_TRUE(pairs.contains(pairOf(triangle)));
}

TEST(Cluster, aFlatSheetStaysFlatAndOnlyItsOutlineMovesOut) {
    const Triangles source =
        gridSurface(60, 60, 0, [](int x, int y) { return Vec3i(130 + 30 * x, 130 + 30 * y, 333); });
    const Triangles shrunk =
        clusterToBudget(source, 300, kExtentBits, kMaterials, Outline::AsClustered);
    const Triangles pushed =
        clusterToBudget(source, 300, kExtentBits, kMaterials, Outline::Unshrunk);
    for (const Triangles* result : {&shrunk, &pushed}) {
        EXPECT_EQ(boxOf(*result).min.z, 333);
        EXPECT_EQ(boxOf(*result).max.z, 333);
    }
    EXPECT_TRUE(boxOf(source).contains(boxOf(shrunk)));
    const Box3i inner = boxOf(shrunk), outer = boxOf(pushed);
    for (int axis = 0; axis < 2; ++axis) {
        EXPECT_LT(outer.min[axis], inner.min[axis]);
        EXPECT_GT(outer.max[axis], inner.max[axis]);
    }
    const double full = areaOf(source);
    EXPECT_LT(std::abs(areaOf(pushed) - full), std::abs(areaOf(shrunk) - full));
}

TEST(Cluster, aRoundBarThinnerThanACellStaysAsTwoStripsOfItsWidth) {
    // Radius 5 about a line within the first row of cells, in ten long segments.
    const Triangles source = gridSurface(24, 10, 0, [](int column, int row) {
        const double around = 2 * std::numbers::pi * (column % 24) / 24;
        return Vec3i(
            glm::round(Vec3d(100 * row, 6 + 5 * std::cos(around), 6 + 5 * std::sin(around))));
    });
    const Triangles result =
        clusterToBudget(source, 60, kExtentBits, kMaterials, Outline::AsClustered);
    EXPECT_EQ(result.size(), 40u);  // two crossing strips of two triangles a segment
    EXPECT_EQ(boxOf(result).min.x, 0);
    EXPECT_EQ(boxOf(result).max.x, 1000);
    for (const SoupTriangle& triangle : result) {
        for (const Vec3i& corner : triangle.corners) {
            EXPECT_LE(std::hypot(corner.y - 6, corner.z - 6), 5 + 1);  // 1: rounding
        }
    }
    // Each strip shows the bar's outline: the diameter times the length, rounded to the lattice.
    EXPECT_NEAR(areaOf(result), 2 * 10 * 1000, 0.1 * 2 * 10 * 1000);
}

TEST(Cluster, theOrderOfTheInputMovesNothingByMoreThanRounding) {
    Triangles source = twoSpheres();
    const Triangles once = clusterToBudget(source, 400, kExtentBits, kMaterials, Outline::Unshrunk);
    std::shuffle(source.begin(), source.end(), std::mt19937(8));
    const Triangles other =
        clusterToBudget(source, 400, kExtentBits, kMaterials, Outline::Unshrunk);
    ASSERT_EQ(once.size(), other.size());
    for (const SoupTriangle& triangle : once) {
        for (const Vec3i& corner : triangle.corners) {
            EXPECT_TRUE(std::any_of(other.begin(), other.end(), [&](const SoupTriangle& there) {
                return std::any_of(there.corners.begin(), there.corners.end(), [&](const Vec3i& p) {
                    return Box3i{p - 1, p + 1}.contains(corner);
                });
            }));
        }
    }
}

}  // namespace
}  // namespace pagoda::hlod
