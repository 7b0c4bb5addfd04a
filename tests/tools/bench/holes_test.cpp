// Holes and pixels that get coarser, in pictures made by hand, and against plain loops.
#include "tools/bench/truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pagoda::tools {
namespace {

const ooc::NodeId kInner = ooc::NodeId::root().child(1), kLeaf = kInner.child(2),
                  kOther = ooc::NodeId::root().child(3);
constexpr uint32_t kNone = 0, kOfInner = 1, kOfLeaf = 2, kOfOther = 3;
constexpr double kInnerError = 0.5, kOtherError = 2;

void show(viewer::Picture& picture, size_t pixel, uint32_t ordinal, float depth) {
    picture.nodeOrdinals[pixel] = ordinal;
    picture.depthsModelUnits[pixel] = depth;
    picture.colours[4 * pixel + 3] = ordinal == kNone ? 0 : 255;
}

void showPane(viewer::Picture& picture, size_t pixel) {
    show(picture, pixel, kNone, INFINITY);
    picture.colours[4 * pixel + 3] = 128;
}

// A wall of the leaf, ten units away, at tau 1: neighbourhoods are 5x5.
DrawnPicture wall(int width = 9, int height = 9) {
    DrawnPicture made;
    viewer::Picture& picture = made.picture;
    const auto count = static_cast<size_t>(width) * static_cast<size_t>(height);
    picture.widthPx = width;
    picture.heightPx = height;
    picture.colours.assign(4 * count, 100);
    picture.depthsModelUnits.resize(count);
    picture.nodeOrdinals.resize(count);
    picture.triangles.assign(count, 0);
    picture.nodes = {kInner, kLeaf, kOther};
    for (size_t i = 0; i < count; ++i) show(picture, i, kOfLeaf, 10);
    made.errorsModelUnits = {kInnerError, 0, kOtherError};
    made.isStandIn = {0, 0, 0};
    made.tauPx = 1;
    return made;
}

constexpr size_t kMiddle = 4 * 9 + 4;

TEST(Holes, TheLeavesHaveNone) {
    EXPECT_EQ(countHoles(wall(), wall().picture), 0u);
}

TEST(Holes, BackgroundInAWallIsOne) {
    DrawnPicture drawn = wall();
    show(drawn.picture, kMiddle, kNone, INFINITY);
    EXPECT_EQ(countHoles(drawn, wall().picture), 1u);
}

TEST(Holes, ASurfaceBehindIsOneBeyondTheErrorOfItsNode) {
    for (const auto& [ordinal, error] : {std::pair{kOfInner, kInnerError}, {kOfOther, 2.0}}) {
        DrawnPicture drawn = wall();
        show(drawn.picture, kMiddle, ordinal, static_cast<float>(10 + error));
        EXPECT_EQ(countHoles(drawn, wall().picture), 0u);
        show(drawn.picture, kMiddle, ordinal, static_cast<float>(10 + error + 0.01));
        EXPECT_EQ(countHoles(drawn, wall().picture), 1u);
    }
}

TEST(Holes, ASurfaceBeforeTheWallIsNone) {
    DrawnPicture drawn = wall();
    show(drawn.picture, kMiddle, kOfLeaf, 1);
    EXPECT_EQ(countHoles(drawn, wall().picture), 0u);
}

// An outline may recede by tau, and depth jumps there.
TEST(Holes, AnOpenOrFartherPixelOfTheNeighbourhoodExcusesIt) {
    DrawnPicture drawn = wall();
    show(drawn.picture, kMiddle, kNone, INFINITY);
    viewer::Picture leaves = wall().picture;
    show(leaves, kMiddle + 3, kNone, INFINITY);
    EXPECT_EQ(countHoles(drawn, leaves), 1u) << "three pixels away";
    show(leaves, kMiddle - 2 * 9 + 2, kNone, INFINITY);
    EXPECT_EQ(countHoles(drawn, leaves), 0u) << "two across";

    drawn = wall();
    show(drawn.picture, kMiddle, kOfLeaf, 30);
    leaves = wall().picture;
    show(leaves, kMiddle + 2 * 9, kOfOther, 30);
    EXPECT_EQ(countHoles(drawn, leaves), 0u);
    drawn.tauPx = 0;
    EXPECT_EQ(countHoles(drawn, leaves), 1u) << "the neighbourhood has become 3x3";
}

TEST(Holes, TauCountsAsWholePixels) {
    DrawnPicture drawn = wall();
    show(drawn.picture, kMiddle, kNone, INFINITY);
    viewer::Picture leaves = wall().picture;
    show(leaves, kMiddle + 3, kNone, INFINITY);
    drawn.tauPx = 1.01;
    EXPECT_EQ(countHoles(drawn, leaves), 0u);
}

TEST(Holes, PixelsAtTheBorderAreNotJudged) {
    DrawnPicture drawn = wall();
    for (size_t i = 0; i < 81; ++i) show(drawn.picture, i, kNone, INFINITY);
    EXPECT_EQ(countHoles(drawn, wall().picture), 25u);
    drawn.tauPx = 40;
    EXPECT_EQ(countHoles(drawn, wall().picture), 0u);
}

TEST(Holes, WhatIsTranslucentAloneCoversAndHasNoDepth) {
    DrawnPicture drawn = wall();
    viewer::Picture leaves = wall().picture;
    for (size_t i = 0; i < 81; ++i) showPane(leaves, i);
    show(drawn.picture, kMiddle, kOfLeaf, 30);
    showPane(drawn.picture, kMiddle + 1);
    EXPECT_EQ(countHoles(drawn, leaves), 0u);
    show(drawn.picture, kMiddle, kNone, INFINITY);
    EXPECT_EQ(countHoles(drawn, leaves), 1u);
    EXPECT_EQ(countHoles(drawn, wall().picture), 2u) << "nor does a pane close a wall";
}

size_t pixelAt(const viewer::Picture& picture, int x, int y) {
    return static_cast<size_t>(y) * static_cast<size_t>(picture.widthPx) + static_cast<size_t>(x);
}

// The definition, pixel by pixel.
uint64_t holesByDefinition(const DrawnPicture& drawn, const viewer::Picture& leaves) {
    const viewer::Picture& picture = drawn.picture;
    const int reach = static_cast<int>(std::ceil(drawn.tauPx)) + 1;
    uint64_t holes = 0;
    for (int y = 0; y < picture.heightPx; ++y) {
        for (int x = 0; x < picture.widthPx; ++x) {
            bool isCovered = true;
            double farthest = 0;
            for (int v = y - reach; v <= y + reach; ++v) {
                for (int u = x - reach; u <= x + reach; ++u) {
                    const bool isIn =
                        u >= 0 && v >= 0 && u < picture.widthPx && v < picture.heightPx;
                    isCovered = isCovered && isIn;
                    if (!isCovered) continue;
                    const size_t at = pixelAt(picture, u, v);
                    isCovered = leaves.colours[4 * at + 3] != 0;
                    farthest = std::max(farthest, 1.0 * leaves.depthsModelUnits[at]);
                }
            }
            const size_t at = pixelAt(picture, x, y);
            const uint32_t ordinal = picture.nodeOrdinals[at];
            const double error = ordinal == kNone ? 0 : drawn.errorsModelUnits[ordinal - 1];
            const bool isBackground = picture.colours[4 * at + 3] == 0;
            const bool isBehind = picture.depthsModelUnits[at] > farthest + error;
            holes += isCovered && (isBackground || isBehind);
        }
    }
    return holes;
}

TEST(Holes, AreThoseOfTheDefinitionInRandomPictures) {
    std::mt19937 random(7);
    const auto chance = [&](uint32_t oneIn) { return random() % oneIn == 0; };
    uint64_t total = 0;
    for (int i = 0; i < 200; ++i) {
        const int width = 5 + static_cast<int>(random() % 20);
        const int height = 5 + static_cast<int>(random() % 20);
        DrawnPicture drawn = wall(width, height);
        viewer::Picture leaves = drawn.picture;
        drawn.tauPx = 0.5 * static_cast<double>(random() % 5);
        for (size_t p = 0; p < leaves.pixelCount(); ++p) {
            show(leaves, p, kOfLeaf, 10.0f + static_cast<float>(random() % 3));
            if (chance(60)) show(leaves, p, kNone, INFINITY);
            if (chance(60)) showPane(leaves, p);
            show(drawn.picture, p, 1 + static_cast<uint32_t>(random() % 3),
                 10.0f + static_cast<float>(random() % 5));
            if (chance(8)) show(drawn.picture, p, kNone, INFINITY);
            if (chance(8)) showPane(drawn.picture, p);
        }
        const uint64_t holes = countHoles(drawn, leaves);
        EXPECT_EQ(holes, holesByDefinition(drawn, leaves)) << i;
        total += holes;
    }
    EXPECT_GT(total, 1000u);
}

TEST(Coarser, IsAnAncestorInPlaceOfWhatWasThere) {
    const DrawnPicture before = wall();
    DrawnPicture now = wall();
    EXPECT_EQ(countCoarser(before, now).coarser(), 0u);
    show(now.picture, 3, kOfInner, 10);  // the leaf had no error at all
    EXPECT_EQ(countCoarser(before, now).byCut, 1u);
    EXPECT_EQ(countCoarser(before, now).coarser(), 1u);
    EXPECT_EQ(countCoarser(now, before).coarser(), 0u) << "it got finer";
}

TEST(Coarser, AnotherSurfaceThatComesToTheFrontIsNamed) {
    const DrawnPicture before = wall();
    DrawnPicture now = wall();
    show(now.picture, 3, kOfOther, 10);
    const CoarserPixels counts = countCoarser(before, now);
    EXPECT_EQ(counts.byOthers, 1u);
    EXPECT_EQ(counts.byCut, 0u);
    EXPECT_EQ(counts.coarser(), 1u);
}

TEST(Coarser, StandInsAndAHigherTauAreNamedApart) {
    DrawnPicture before = wall(), now = wall();
    show(now.picture, 3, kOfInner, 10);
    now.isStandIn[kOfInner - 1] = 1;
    EXPECT_EQ(countCoarser(before, now).byStandIns, 1u);
    EXPECT_EQ(countCoarser(before, now).coarser(), 0u);
    now.isStandIn[kOfInner - 1] = 0;
    before.isStandIn[kOfLeaf - 1] = 1;
    EXPECT_EQ(countCoarser(before, now).byStandIns, 1u);
    now.tauPx = 1.5;
    EXPECT_EQ(countCoarser(before, now).byTau, 1u);
    EXPECT_EQ(countCoarser(before, now).byStandIns + countCoarser(before, now).coarser(), 0u);
    before.isStandIn[kOfLeaf - 1] = 0;
    before.tauPx = 2;
    EXPECT_EQ(countCoarser(before, now).coarser(), 1u) << "it fell";
}

TEST(Coarser, WhatHadOrHasNothingOpaqueDoesNotCount) {
    DrawnPicture before = wall(), now = wall();
    show(before.picture, 3, kNone, INFINITY);
    show(now.picture, 3, kOfInner, 10);
    show(now.picture, 4, kNone, INFINITY);
    EXPECT_EQ(countCoarser(before, now).coarser(), 0u);
}

}  // namespace
}  // namespace pagoda::tools
