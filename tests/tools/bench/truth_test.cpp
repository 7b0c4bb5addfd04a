// Pictures of a few pixels, made by hand.
#include "tools/bench/truth.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pagoda::tools {
namespace {

const ooc::NodeId kA = ooc::NodeId::root().child(1), kB = ooc::NodeId::root().child(2);

// Grey, triangle 0 of node A everywhere, one unit away.
viewer::Picture picture(int width) {
    const auto count = static_cast<size_t>(width);
    viewer::Picture made;
    made.widthPx = width;
    made.heightPx = 1;
    made.colours.assign(4 * count, 100);
    made.depthsModelUnits.assign(count, 1.0f);
    made.nodeOrdinals.assign(count, 1);
    made.triangles.assign(count, 0);
    made.nodes = {kA, kB};
    return made;
}

bool nothing(ooc::NodeId) {
    return false;
}

TEST(Truth, APictureIsRightAgainstItself) {
    const WrongPixels wrong = countWrongPixels(picture(4), picture(4), nothing);
    EXPECT_EQ(wrong.wrong + wrong.tied + wrong.overdrawn, 0u);
    EXPECT_EQ(countDifferentIds(picture(4), picture(4)), 0u);
}

TEST(Truth, OrdinalsMayDifferAsLongAsTheyNameTheSameNode) {
    viewer::Picture other = picture(4);
    other.nodes = {kB, kA};
    other.nodeOrdinals.assign(4, 2);
    EXPECT_EQ(countWrongPixels(picture(4), other, nothing).wrong, 0u);
    EXPECT_EQ(countDifferentIds(picture(4), other), 0u);
}

TEST(Truth, AnotherNodeOrTriangleAtAnotherDepthIsWrong) {
    viewer::Picture seen = picture(4);
    seen.nodeOrdinals[0] = 2;
    seen.depthsModelUnits[0] = 2;
    seen.triangles[1] = 7;
    seen.depthsModelUnits[1] = 3;
    const WrongPixels wrong = countWrongPixels(seen, picture(4), nothing);
    EXPECT_EQ(wrong.wrong, 2u);
    EXPECT_EQ(wrong.tied, 0u);
    EXPECT_EQ(countDifferentIds(seen, picture(4)), 2u);
}

TEST(Truth, AHoleIsWrong) {
    viewer::Picture seen = picture(4);
    seen.nodeOrdinals[3] = 0;
    seen.depthsModelUnits[3] = INFINITY;
    EXPECT_EQ(countWrongPixels(seen, picture(4), nothing).wrong, 1u);
    EXPECT_EQ(countWrongPixels(picture(4), seen, nothing).wrong, 1u);
}

TEST(Truth, AnotherSurfaceAtBitEqualDepthIsTied) {
    viewer::Picture seen = picture(4);
    seen.nodeOrdinals[2] = 2;
    const WrongPixels wrong = countWrongPixels(seen, picture(4), nothing);
    EXPECT_EQ(wrong.tied, 1u);
    EXPECT_EQ(wrong.wrong, 0u);
    EXPECT_EQ(countDifferentIds(seen, picture(4)), 1u) << "whatever the reason";
}

TEST(Truth, PixelsOfOverdrawnNodesAreNamedApart) {
    viewer::Picture seen = picture(4);
    seen.nodeOrdinals[0] = 2;
    seen.depthsModelUnits[0] = 0.5f;
    const auto isB = [](ooc::NodeId node) { return node == kB; };
    const WrongPixels wrong = countWrongPixels(seen, picture(4), isB);
    EXPECT_EQ(wrong.overdrawn, 1u);
    EXPECT_EQ(wrong.wrong, 0u);
}

// Ids are of opaque surfaces: of what is translucent before them, or before nothing, only the
// colour tells.
TEST(Truth, AnotherColourOnTheSameSurfaceIsOfSomethingTranslucentAndWrong) {
    viewer::Picture seen = picture(4), truth = picture(4);
    for (viewer::Picture* each : {&seen, &truth}) {
        each->nodeOrdinals[1] = 0;
        each->depthsModelUnits[1] = INFINITY;
    }
    seen.colours[4 * 0 + 2] = 90;
    seen.colours[4 * 1 + 3] = 0;
    EXPECT_EQ(countWrongPixels(seen, truth, nothing).wrong, 2u);
    EXPECT_EQ(countDifferentIds(seen, truth), 0u);
    const auto isB = [](ooc::NodeId node) { return node == kB; };
    EXPECT_EQ(countWrongPixels(seen, truth, isB).wrong, 0u);
    EXPECT_EQ(countWrongPixels(seen, truth, isB).overdrawn, 2u) << "which may have been B's";
}

TEST(Truth, EqualPicturesHaveTheNumberForEqual) {
    const Psnr quality = psnr(picture(4), picture(4));
    EXPECT_EQ(quality.luma, kEqualDb);
    EXPECT_EQ(quality.cb, kEqualDb);
    EXPECT_EQ(quality.cr, kEqualDb);
}

TEST(Truth, AGreyPixelOffByTenChangesLumaOnly) {
    viewer::Picture seen = picture(4);
    for (size_t c = 0; c < 3; ++c) seen.colours[c] = 110;
    const Psnr quality = psnr(seen, picture(4));
    EXPECT_NEAR(quality.luma, 34.1514, 1e-3);  // 10 log10(255^2 * 4 / 10^2)
    EXPECT_EQ(quality.cb, kEqualDb);
    EXPECT_EQ(quality.cr, kEqualDb);
}

// BT.601 by its matrix: Y = 0.299 R, Cb = -0.168736 R, Cr = 0.5 R.
TEST(Truth, ARedPixelChangesLumaAndChromaByTheMatrixOfBt601) {
    viewer::Picture seen = picture(1);
    seen.colours[0] = 110;
    const Psnr quality = psnr(seen, picture(1));
    const auto db = [](double error) { return 20 * std::log10(255 / error); };
    EXPECT_NEAR(quality.luma, db(2.99), 1e-6);
    EXPECT_NEAR(quality.cb, db(1.68736), 1e-4);
    EXPECT_NEAR(quality.cr, db(5.0), 1e-6);
}

}  // namespace
}  // namespace pagoda::tools
