#include "hlod/build/visible_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace pagoda::hlod {
namespace {

using Triangles = std::vector<SoupTriangle>;

void addTriangle(Triangles& triangles, const Vec3i& a, const Vec3i& b, const Vec3i& c) {
    triangles.emplace_back().corners = {a, b, c};
}

void addQuad(Triangles& triangles, const Vec3i& a, const Vec3i& b, const Vec3i& c, const Vec3i& d) {
    addTriangle(triangles, a, b, c);
    addTriangle(triangles, a, c, d);
}

// The faces of a box; `open`: without the one at low x.
void addBox(Triangles& triangles, const Vec3i& low, const Vec3i& high, bool isOpen = false) {
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const bool isHigh : {false, true}) {
            if (isOpen && axis == 0 && !isHigh) continue;
            Vec3i a = low;
            a[axis] = isHigh ? high[axis] : low[axis];
            Vec3i b = a, c = a, d = a;
            b[u] = c[u] = high[u];
            c[v] = d[v] = high[v];
            addQuad(triangles, a, b, c, d);
        }
    }
}

// A wall at low x with a square hole in it.
void addWallWithHole(Triangles& triangles, int x, int low, int high, int holeLow, int holeHigh) {
    const auto strip = [&](int y0, int z0, int y1, int z1) {
        addQuad(triangles, {x, y0, z0}, {x, y1, z0}, {x, y1, z1}, {x, y0, z1});
    };
    strip(low, low, high, holeLow);
    strip(low, holeHigh, high, high);
    strip(low, holeLow, holeLow, holeHigh);
    strip(holeHigh, holeLow, high, holeHigh);
}

// The 26 directions, by hand: every (x, y, z) of -1, 0, 1 but (0, 0, 0).
std::vector<Vec3d> directions() {
    std::vector<Vec3d> all;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                if (x != 0 || y != 0 || z != 0) all.push_back(glm::normalize(Vec3d(x, y, z)));
            }
        }
    }
    return all;
}

// Distance along the ray, or none (infinity). Moeller and Trumbore 1997, two-sided.
double hitDistance(const SoupTriangle& triangle, const Vec3d& from, const Vec3d& along) {
    const double none = std::numeric_limits<double>::infinity();
    const Vec3d a(triangle.corners[0]), u = Vec3d(triangle.corners[1]) - a,
                                        v = Vec3d(triangle.corners[2]) - a;
    const Vec3d p = glm::cross(along, v);
    const double det = glm::dot(u, p);
    if (std::abs(det) < 1e-9) return none;
    const Vec3d t = from - a, q = glm::cross(t, u);
    const double first = glm::dot(t, p) / det, second = glm::dot(along, q) / det;
    if (first < 0 || second < 0 || first + second > 1) return none;
    return glm::dot(v, q) / det;
}

struct Sight {
    std::vector<double> area;  // seen of each triangle, over all directions, in square steps
    double diagonal = 0;
};

// Parallel rays on a fine grid from outside, for each direction.
Sight lookWithRays(const Triangles& triangles, int raysAlong) {
    Box3d box;
    for (const SoupTriangle& triangle : triangles) {
        for (const Vec3i& corner : triangle.corners) box.extend(Vec3d(corner));
    }
    Sight sight;
    sight.area.assign(triangles.size(), 0.0);
    sight.diagonal = glm::distance(box.min, box.max);
    const Vec3d centre = (box.min + box.max) * 0.5;
    const double pitch = sight.diagonal / raysAlong;
    for (const Vec3d& along : directions()) {
        // Any two axes across the direction, turned so that rays meet no edges by symmetry.
        const Vec3d across =
            glm::normalize(glm::cross(along, glm::normalize(Vec3d(0.31, -0.77, 0.543))));
        const Vec3d down = glm::cross(along, across);
        for (int i = 0; i < raysAlong; ++i) {
            for (int j = 0; j < raysAlong; ++j) {
                const Vec3d from = centre - along * sight.diagonal +
                                   across * (pitch * (i + 0.437) - sight.diagonal / 2) +
                                   down * (pitch * (j + 0.561) - sight.diagonal / 2);
                double nearest = std::numeric_limits<double>::infinity();
                size_t hit = triangles.size();
                for (size_t k = 0; k < triangles.size(); ++k) {
                    const double distance = hitDistance(triangles[k], from, along);
                    if (distance < nearest) {
                        nearest = distance;
                        hit = k;
                    }
                }
                if (hit < triangles.size()) sight.area[hit] += pitch * pitch;
            }
        }
    }
    return sight;
}

uint32_t sum(const std::vector<uint32_t>& pixels, size_t begin, size_t end) {
    return std::accumulate(pixels.begin() + static_cast<ptrdiff_t>(begin),
                           pixels.begin() + static_cast<ptrdiff_t>(end), 0u);
}

// Each triangle's pixels are its visible area in pixels, but for those on its edges.
void expectAsRays(const Triangles& triangles, int resolution) {
    const std::vector<uint32_t> pixels = countVisiblePixels(triangles, resolution);
    const Sight sight = lookWithRays(triangles, 200);
    const double pixelArea = std::pow(sight.diagonal / resolution, 2);
    ASSERT_EQ(pixels.size(), triangles.size());
    for (size_t i = 0; i < triangles.size(); ++i) {
        const double expected = sight.area[i] / pixelArea;
        EXPECT_NEAR(pixels[i], expected, 12 + 5 * std::sqrt(expected)) << "triangle " << i;
        if (sight.area[i] > 20 * pixelArea) {
            EXPECT_GT(pixels[i], 0u) << "triangle " << i;
        }
    }
}

TEST(VisibleParts, pixelsAreTheAreaThatRaysSeeOfARandomSoup) {
    std::mt19937 random(11);
    Triangles triangles;
    while (triangles.size() < 25) {
        SoupTriangle triangle;
        for (Vec3i& corner : triangle.corners) {
            corner = Vec3i(random() % 1000, random() % 1000, random() % 1000) + 100000;
        }
        if (!hasNoArea(triangle.corners)) triangles.push_back(triangle);
    }
    expectAsRays(triangles, 256);
}

TEST(VisibleParts, aBoxInAClosedBoxIsNotSeenAndAllOfTheOuterIs) {
    Triangles triangles;
    addBox(triangles, Vec3i(0), Vec3i(900));
    addBox(triangles, Vec3i(300), Vec3i(600));
    const std::vector<uint32_t> pixels = countVisiblePixels(triangles, 128);
    for (size_t i = 0; i < 12; ++i) EXPECT_GT(pixels[i], 0u) << i;
    EXPECT_EQ(sum(pixels, 12, 24), 0u);
}

TEST(VisibleParts, nothingShowsBetweenTrianglesThatShareAnEdge) {
    // Faces' diagonals run through pixel centres: rounding must not part the two triangles.
    std::mt19937 random(1);
    for (int round = 0; round < 80; ++round) {
        const auto size = static_cast<int>(100 + random() % 100000000);
        const Vec3i low(random() % 1000, random() % 1000, random() % 1000);
        Triangles triangles;
        addBox(triangles, low, low + size);
        addBox(triangles, low + size / 10, low + size - size / 10);
        const auto resolution = static_cast<int>(64 + random() % 192);
        EXPECT_EQ(sum(countVisiblePixels(triangles, resolution), 12, 24), 0u)
            << "edge " << size << " at " << resolution << " pixels";
    }
}

TEST(VisibleParts, theInnerBoxIsSeenOnceTheOuterIsOpen) {
    Triangles triangles;
    addBox(triangles, Vec3i(0), Vec3i(900), true);
    addBox(triangles, Vec3i(300), Vec3i(600));
    EXPECT_GT(sum(countVisiblePixels(triangles, 128), 10, 22), 0u);
    expectAsRays(triangles, 128);
}

TEST(VisibleParts, aPartBehindAGapIsSeenAndItsTwinBesideTheGapIsNot) {
    Triangles triangles;
    addBox(triangles, Vec3i(0), Vec3i(900), true);
    addWallWithHole(triangles, 0, 0, 900, 600, 750);
    const size_t first = triangles.size();
    // Two plates parallel to the wall and close behind it: one at the hole, one beside it, where
    // no direction at 45 degrees to the axes leads through the hole.
    addQuad(triangles, {20, 610, 610}, {20, 740, 610}, {20, 740, 740}, {20, 610, 740});
    addQuad(triangles, {20, 110, 110}, {20, 240, 110}, {20, 240, 240}, {20, 110, 240});
    const std::vector<uint32_t> pixels = countVisiblePixels(triangles, 256);
    for (size_t i = first; i < first + 2; ++i) EXPECT_GT(pixels[i], 0u);
    EXPECT_EQ(sum(pixels, first + 2, first + 4), 0u);
    expectAsRays(triangles, 256);
}

TEST(VisibleParts, theFarWallIsSeenThroughAHoleAlongADiagonalOnly) {
    // A plate over the hole leaves the way along the axis closed, and those aslant open.
    Triangles triangles;
    addBox(triangles, Vec3i(0), Vec3i(900), true);
    addWallWithHole(triangles, 0, 0, 900, 400, 500);
    addQuad(triangles, {-100, 400, 400}, {-100, 500, 400}, {-100, 500, 500}, {-100, 400, 500});
    const size_t target = triangles.size();
    addQuad(triangles, {100, 500, 410}, {100, 600, 410}, {100, 600, 490}, {100, 500, 490});
    EXPECT_GT(sum(countVisiblePixels(triangles, 256), target, target + 2), 0u);
    expectAsRays(triangles, 256);
}

TEST(VisibleParts, bothSidesOfATriangleCountAlike) {
    Triangles outwards;
    addBox(outwards, Vec3i(0), Vec3i(500));
    Triangles inwards = outwards;
    for (SoupTriangle& triangle : inwards) std::swap(triangle.corners[1], triangle.corners[2]);
    const uint32_t all = sum(countVisiblePixels(outwards, 100), 0, 12);
    // Windings change no pixel but those whose centre an edge meets, by rounding.
    EXPECT_NEAR(sum(countVisiblePixels(inwards, 100), 0, 12), all, all * 0.001);

    Triangles sheet;
    addTriangle(sheet, {0, 0, 0}, {400, 0, 0}, {0, 400, 0});
    Triangles pair = sheet;
    addTriangle(pair, {0, 0, 9}, {400, 0, 9}, {0, 400, 9});
    const uint32_t alone = countVisiblePixels(sheet, 100)[0];
    const std::vector<uint32_t> two = countVisiblePixels(pair, 100);
    EXPECT_GT(alone, 1000u);
    EXPECT_NEAR(two[0], alone / 2.0, alone * 0.08);  // each hides one side of the other,
    EXPECT_NEAR(two[1], alone / 2.0, alone * 0.08);  // but for a rim
}

TEST(VisibleParts, ofTwoTrianglesInOnePlaceTheLowerNumberIsSeen) {
    Triangles triangles;
    addTriangle(triangles, {0, 0, 0}, {700, 100, 50}, {30, 600, 400});
    triangles.push_back(triangles[0]);
    const std::vector<uint32_t> pixels = countVisiblePixels(triangles, 64);
    EXPECT_GT(pixels[0], 0u);
    EXPECT_EQ(pixels[1], 0u);
}

TEST(VisibleParts, nothingHasNoPixels) {
    EXPECT_TRUE(countVisiblePixels({}, 64).empty());
}

}  // namespace
}  // namespace pagoda::hlod
