#include "hlod/build/seen_colours.h"

#include <gtest/gtest.h>

namespace pagoda::hlod {
namespace {

using Triangles = std::vector<SoupTriangle>;

void addQuad(Triangles& triangles, int z, int left, int right, uint32_t colour,
             uint32_t material = 0) {
    const Vec3i a(left, 0, z), b(right, 0, z), c(right, 1000, z), d(left, 1000, z);
    for (const std::array<Vec3i, 3>& corners : {std::array{a, b, c}, std::array{a, c, d}}) {
        SoupTriangle& triangle = triangles.emplace_back();
        triangle.corners = corners;
        triangle.colours.fill(colour);
        triangle.material = material;
    }
}

constexpr uint32_t kRed = 0xFF0000FFu, kGreen = 0xFF00FF00u, kGrey = 0xFF808080u;

TEST(SeenColours, aSheetTakesTheMeanOfTheColoursItCovers) {
    Triangles model, standIn;
    addQuad(model, 500, 0, 500, kRed);
    addQuad(model, 500, 500, 1000, kGreen);
    addQuad(standIn, 500, 0, 1000, kGrey);
    takeSeenColours(model, {false}, 128, standIn);
    // The triangles cover three quarters of one colour and one of the other.
    int most[2] = {0, 0};
    for (int i = 0; i < 2; ++i) {
        for (const uint32_t rgba : standIn[static_cast<size_t>(i)].colours) {
            EXPECT_EQ(rgba, standIn[static_cast<size_t>(i)].colours[0]);
        }
        const uint32_t rgba = standIn[static_cast<size_t>(i)].colours[0];
        EXPECT_EQ(rgba >> 24, 255u);
        EXPECT_EQ((rgba >> 16) & 255u, 0u);
        most[i] = static_cast<int>(i == 0 ? (rgba >> 8) & 255u : rgba & 255u);
    }
    EXPECT_NEAR(most[0], 191, 4);
    EXPECT_NEAR(most[1], 191, 4);
}

TEST(SeenColours, whatLiesBetweenTwoSheetsDoesNotColourThem) {
    Triangles model, standIn;
    for (const int z : {499, 501}) addQuad(model, z, 0, 1000, kRed);
    addQuad(model, 500, 0, 1000, kGreen);
    addQuad(standIn, 500, 0, 1000, kGrey);
    takeSeenColours(model, {false}, 64, standIn);
    for (const SoupTriangle& triangle : standIn) EXPECT_EQ(triangle.colours[0], kRed);
}

TEST(SeenColours, glassNeitherGivesNorTakesColours) {
    Triangles model, standIn;
    addQuad(model, 500, 0, 1000, kGreen);
    addQuad(model, 600, 0, 1000, 0x400000FFu, 1);
    addQuad(standIn, 500, 0, 1000, kGrey);
    addQuad(standIn, 600, 0, 1000, 0x40808080u, 1);
    takeSeenColours(model, {false, true}, 64, standIn);
    EXPECT_EQ(standIn[0].colours[0], kGreen);
    EXPECT_EQ(standIn[2].colours[0], 0x40808080u);
}

TEST(SeenColours, whatShowsNothingKeepsItsColours) {
    Triangles model, standIn;
    addQuad(standIn, 500, 0, 1000, kGrey);
    takeSeenColours(model, {false}, 64, standIn);
    EXPECT_EQ(standIn[0].colours[0], kGrey);
}

}  // namespace
}  // namespace pagoda::hlod
