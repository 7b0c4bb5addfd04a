// The lazy occlusion grid of paper 001: its listings by hand on small grids, and random draws and
// tests against a look at every pixel.
#include "hlod/strategies/occlusion_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace pagoda::hlod {
namespace {

constexpr int kWidth = 22, kHeight = 13;  // cells of 4: the last column and row are cut off
constexpr double kInfinite = std::numeric_limits<double>::infinity();

class Picture : public DepthVisibility {
public:
    void draw(const PixelRect& r, double depth) {
        forEach(r, [&](double& pixel) { pixel = std::min(pixel, depth); });
    }
    bool anyFree(const PixelRect& r) override { return maxDepth(r) == kInfinite; }
    double maxDepth(const PixelRect& r) override {
        double depth = 0.0;
        forEach(r, [&](double& pixel) { depth = std::max(depth, pixel); });
        return depth;
    }

private:
    template <typename Visit>
    void forEach(const PixelRect& r, Visit visit) {
        for (int y = std::max(0, r.minY); y < std::min(kHeight, r.maxY); ++y)
            for (int x = std::max(0, r.minX); x < std::min(kWidth, r.maxX); ++x)
                visit(pixels_[static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)]);
    }
    std::vector<double> pixels_ = std::vector<double>(size_t{kWidth} * kHeight, kInfinite);
};

struct Scene {
    Picture picture;
    OcclusionGrid grid;
    explicit Scene(const OcclusionGridOptions& options) : grid(kWidth, kHeight, options) {}
    // Draws `drawn` only, of an object whose rectangle is `marked`.
    void draw(const PixelRect& marked, const PixelRect& drawn, double depth) {
        picture.draw(drawn, depth);
        grid.markDrawn(marked, picture);
    }
    // Is it visible, after how many more queries?
    std::pair<bool, uint64_t> test(const PixelRect& rectangle, double nearDepth) {
        const uint64_t before = grid.pixelQueries();
        const bool isVisible = grid.isVisible(rectangle, nearDepth, picture);
        return {isVisible, grid.pixelQueries() - before};
    }
};

using Answer = std::pair<bool, uint64_t>;
constexpr PixelRect kCell{4, 4, 8, 8}, kPart{5, 5, 7, 7};

TEST(OcclusionGrid, OcclusionCellGoesFromFreeToPartialToFull) {
    Scene scene({.cellPixels = 4});
    EXPECT_EQ(scene.test(kCell, 1), Answer(true, 0));  // free
    EXPECT_EQ(scene.test(kPart, 1), Answer(true, 0));
    scene.draw(kCell, {4, 4, 8, 7}, 1);                 // outdated; a row stays free
    EXPECT_EQ(scene.test(kPart, 2), Answer(false, 1));  // border: hidden, state unchanged
    EXPECT_EQ(scene.test(kCell, 2), Answer(true, 1));   // outdated, hence read: partial
    EXPECT_EQ(scene.test(kCell, 2), Answer(true, 0));   // partial: visible unasked
    EXPECT_EQ(scene.test(kPart, 2), Answer(false, 1));  // a border cell's part is read again
    scene.draw(kCell, {4, 7, 8, 8}, 1);
    EXPECT_EQ(scene.test({5, 5, 7, 8}, 2), Answer(false, 1));
    EXPECT_EQ(scene.test(kCell, 2), Answer(false, 1));  // full
    EXPECT_EQ(scene.test(kCell, 2), Answer(false, 0));
    scene.draw(kCell, kCell, 0.5);  // full is never undone
    EXPECT_EQ(scene.test(kPart, 2), Answer(false, 0));
    scene.grid.beginFrame();
    EXPECT_EQ(scene.test(kCell, 2), Answer(true, 0));
}

TEST(OcclusionGrid, ABorderCellSeenToBeFreeIsPartial) {
    Scene scene({.cellPixels = 4});
    scene.draw(kCell, {4, 4, 8, 6}, 1);
    EXPECT_EQ(scene.test(kPart, 2), Answer(true, 1));
    EXPECT_EQ(scene.test(kCell, 2), Answer(true, 0));
}

TEST(OcclusionGrid, FreeCellsEndATestBeforeAnyIsRead) {
    Scene scene({.cellPixels = 4});
    scene.draw(kCell, {4, 4, 8, 7}, 1);
    EXPECT_EQ(scene.test({4, 4, 12, 8}, 2), Answer(true, 0));  // internal neighbour
    EXPECT_EQ(scene.test({4, 4, 10, 8}, 2), Answer(true, 0));  // border neighbour
}

TEST(OcclusionGrid, DepthCellsCompareBeforeTheyAreRead) {
    Scene scene({.cellPixels = 4, .variant = GridVariant::DepthBuffer});
    EXPECT_EQ(scene.test(kCell, 9), Answer(true, 0));
    scene.draw(kCell, kCell, 5);
    EXPECT_EQ(scene.test(kPart, 9), Answer(true, 0));   // as printed: stale, hence free
    EXPECT_EQ(scene.test(kCell, 9), Answer(false, 1));  // far depth is 5 now
    EXPECT_EQ(scene.test(kCell, 9), Answer(false, 0));
    EXPECT_EQ(scene.test(kCell, 5), Answer(true, 0));  // equal depths show
    EXPECT_EQ(scene.test(kPart, 9), Answer(false, 0));
    EXPECT_EQ(scene.test(kPart, 4), Answer(true, 1));  // a border is read, nothing stored
    scene.draw(kCell, kPart, 2);
    EXPECT_EQ(scene.test(kCell, 9), Answer(false, 0));  // outdated, but depths only fall
    EXPECT_EQ(scene.test(kPart, 4), Answer(false, 1));
    EXPECT_EQ(scene.test(kCell, 4), Answer(true, 1));
}

TEST(OcclusionGrid, TouchedBordersAreReadWhenAsked) {
    Scene scene({.cellPixels = 4, .variant = GridVariant::DepthBuffer, .readTouchedBorders = true});
    EXPECT_EQ(scene.test(kPart, 9), Answer(true, 0));
    scene.draw(kCell, kPart, 5);
    EXPECT_EQ(scene.test(kPart, 9), Answer(false, 1));
    EXPECT_EQ(scene.test(kCell, 9), Answer(true, 1));  // read whole: a pixel is free elsewhere
    EXPECT_EQ(scene.test(kPart, 9), Answer(false, 1));
}

TEST(OcclusionGrid, ABusyGridReadsEachTouchedCellThatIsNotFullAtOnce) {
    Scene scene({.cellPixels = 4, .busy = true});
    scene.draw({4, 4, 12, 8}, kCell, 1);
    EXPECT_EQ(scene.grid.pixelQueries(), 2u);
    scene.draw({4, 4, 12, 8}, kCell, 1);
    EXPECT_EQ(scene.grid.pixelQueries(), 3u);
    EXPECT_EQ(scene.test(kCell, 2), Answer(false, 0));
}

TEST(OcclusionGrid, NothingShowsOutsideThePicture) {
    Scene scene({.cellPixels = 4});
    EXPECT_FALSE(scene.test({kWidth, 0, kWidth + 9, 5}, 1).first);
    EXPECT_TRUE(scene.test({-5, -5, 1, 1}, 1).first);
    EXPECT_TRUE(scene.test({kWidth - 1, kHeight - 1, 99, 99}, 1).first);
}

PixelRect randomRectangle(std::mt19937& random) {
    std::uniform_int_distribution<int> x(-2, kWidth), y(-2, kHeight), size(1, 12);
    const int minX = x(random), minY = y(random);
    return {minX, minY, minX + size(random), minY + size(random)};
}

// Lazy and busy decide as a look at every pixel does; the printed z-buffer variant never culls
// what such a look shows. Objects come front to back, as the occlusion buffer demands.
TEST(OcclusionGrid, DecidesAsALookAtEveryPixel) {
    constexpr bool kYes = true;
    for (unsigned seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        const int size = 1 + static_cast<int>(seed % 7);
        Scene lazy({.cellPixels = size}), busy({.cellPixels = size, .busy = true});
        const auto z = GridVariant::DepthBuffer;
        Scene lazyZ({.cellPixels = size, .variant = z, .readTouchedBorders = kYes});
        Scene busyZ({.cellPixels = size, .variant = z, .busy = true, .readTouchedBorders = kYes});
        Scene printed({.cellPixels = size, .variant = z});
        for (int step = 1; step <= 40; ++step) {
            const PixelRect box = randomRectangle(random);
            const double depth = std::uniform_int_distribution<int>(1, 9)(random);
            const double farthest = lazyZ.picture.maxDepth(box);  // 0: no pixel
            EXPECT_EQ(lazyZ.test(box, depth).first, depth <= farthest);
            EXPECT_EQ(busyZ.test(box, depth).first, depth <= farthest);
            if (depth <= farthest) {
                EXPECT_TRUE(printed.test(box, depth).first);
            }
            const bool isFree = lazy.picture.maxDepth(box) == kInfinite;
            EXPECT_EQ(lazy.test(box, step).first, isFree);
            EXPECT_EQ(busy.test(box, step).first, isFree);
            const PixelRect part{box.minX, box.minY, box.maxX, box.maxY - step % 2};
            for (Scene* scene : {&lazyZ, &busyZ, &printed}) scene->draw(box, part, depth);
            for (Scene* scene : {&lazy, &busy}) scene->draw(box, part, step);
        }
    }
}

}  // namespace
}  // namespace pagoda::hlod
