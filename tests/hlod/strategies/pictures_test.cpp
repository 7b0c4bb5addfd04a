// What every strategy's pictures promise, on the software device: culling changes no pixel, still
// views come to rest.
#include "tests/hlod/software_rig.h"

#include <gtest/gtest.h>

#include <random>

namespace pagoda::hlod {
namespace {

using test::Rig;
using test::RoomScene;

const RoomScene& rooms() {
    static const RoomScene scene;
    return scene;
}

// Along a walk, or anywhere in the storey.
Camera viewOf(int i, int steps, bool isAnywhere) {
    Camera camera = rooms().walk(i, steps);
    if (!isAnywhere) return camera;
    std::mt19937 random(static_cast<uint32_t>(i));
    std::uniform_real_distribution<double> place(210, 3790), height(10, 240), direction(-1, 1);
    camera.eye = {place(random), place(random), height(random)};
    camera.target =
        camera.eye + Vec3d(direction(random), direction(random), 0.3 * direction(random));
    return camera;
}

TEST(StrategyPictures, SettledBoolShowsWhatFrustumShowsWithEverythingResident) {
    Rig culled(rooms()), whole(rooms());
    const auto boolean = makeStrategy("bool"), frustum = makeStrategy("frustum");
    uint64_t hiddenNodes = 0, tied = 0;
    for (int i = 0; i < 60; ++i) {
        const Camera camera = viewOf(i, 60, i % 2 == 1);
        const double tauPx = i % 3 == 0 ? 0.5 : 1.0 + i % 3;
        const FrameRecord record = culled.settle(camera, *boolean, tauPx);
        ASSERT_TRUE(record.isSettled);
        static_cast<void>(whole.settle(camera, *frustum, tauPx));
        hiddenNodes += record.hiddenNodes;
        const SoftwarePicture &a = culled.picture(), &b = whole.picture();
        for (size_t p = 0; p < a.pixelCount(); ++p) {
            ASSERT_EQ(a.depths[p], b.depths[p]) << i;
            if (a.nodeOrdinals[p] == 0) continue;
            const bool isSame = a.nodeAt(p) == b.nodeAt(p) && a.triangles[p] == b.triangles[p];
            tied += !isSame;  // another triangle at bit-equal depth
        }
    }
    EXPECT_GT(hiddenNodes, 60u * 5);
    EXPECT_LT(tied, 60u);
}

struct Case {
    const char* strategy;
    uint32_t latencyFrames;
    const char* options = "";
    StrategyOptions strategyOptions{};
};
// Not every frame asks about all, and not about each box by itself.
constexpr StrategyOptions kSparing{.retestEvery = 4, .hiddenBatch = 4, .hysteresis = 0.2};
std::string nameOf(const testing::TestParamInfo<Case>& info) {
    return std::string(info.param.options) + info.param.strategy + "At" +
           std::to_string(info.param.latencyFrames);
}

class CullingAtLatency : public testing::TestWithParam<Case> {};

// A page that is absent has a stand-in, so the first frames count too.
TEST_P(CullingAtLatency, ChangesNoPixelOfItsOwnCutAlongAMovingPath) {
    const Case& tried = GetParam();
    Rig rig(rooms(), {.disk = cache::parseDiskProfile("20MB/s,20ms"),
                      .queryLatencyFrames = tried.latencyFrames});
    Rig truth(rooms());
    const auto strategy = makeStrategy(tried.strategy, tried.strategyOptions);
    uint64_t hiddenNodes = 0, same = 0;
    for (int i = 0; i < 90; ++i) {
        const Camera camera = viewOf(i, 90, false);
        const FrameRecord record = rig.live(camera, *strategy, 1.0);
        if (record.drawnNodes == 0) continue;  // not even the root has come
        const test::WrongPixels pixels = test::wrongPixels(rig, record, camera, truth);
        EXPECT_EQ(pixels.wrong, 0u) << "frame " << i;
        hiddenNodes += record.hiddenNodes;
        same += pixels.same;
    }
    EXPECT_GT(hiddenNodes, 300u);
    EXPECT_GT(same, 90u * 64 * 48 / 2);
}

INSTANTIATE_TEST_SUITE_P(
    , CullingAtLatency,
    testing::Values(Case{"bool", 0}, Case{"bool", 1}, Case{"bool", 2}, Case{"bool", 4},
                    Case{"sw", 0}, Case{"sw", 1}, Case{"sw", 2}, Case{"sw", 4}, Case{"coh", 0},
                    Case{"coh", 1}, Case{"coh", 2}, Case{"coh", 4}, Case{"hzb", 0}, Case{"hzb", 1},
                    Case{"hzb", 2}, Case{"hzb", 4}, Case{"late", 0}, Case{"late", 1},
                    Case{"late", 2}, Case{"late", 4}, Case{"slabs", 0}, Case{"slabs", 1},
                    Case{"slabs", 2}, Case{"slabs", 4}, Case{"auto", 0}, Case{"auto", 2},
                    Case{"coh", 0, "Sparing", kSparing}, Case{"coh", 2, "Sparing", kSparing},
                    Case{"bool", 1, "Sparing", kSparing}, Case{"late", 1, "Sparing", kSparing}),
    nameOf);

class StillView : public testing::TestWithParam<Case> {};

TEST_P(StillView, ComesToRestAndReadsNoPageTwice) {
    const Case& tried = GetParam();
    for (const bool isPollFree : {false, true}) {
        Rig rig(rooms(), {.queryLatencyFrames = tried.latencyFrames});
        rig.device.setCounting(true, isPollFree);
        const auto strategy = makeStrategy(tried.strategy, tried.strategyOptions);
        for (int i = 0; i < 60; ++i) {
            const Camera camera = viewOf(i, 60, i % 2 == 1);
            ASSERT_TRUE(rig.settle(camera, *strategy, 1.0).isSettled) << i;
            const uint64_t hash = rig.runner.cut().drawnHash();
            const std::vector<float> depths = rig.picture().depths;
            for (int frame = 0; frame < 4; ++frame) {
                const FrameRecord record = rig.live(camera, *strategy, 1.0);
                EXPECT_TRUE(record.isSettled);
                EXPECT_EQ(rig.runner.cut().drawnHash(), hash) << i;
                EXPECT_EQ(rig.picture().depths, depths);
            }
        }
        EXPECT_GT(rig.loads.pages.size(), 100u);
        for (const auto& [node, times] : rig.loads.pages) EXPECT_EQ(times, 1) << node.value;
    }
}

INSTANTIATE_TEST_SUITE_P(, StillView,
                         testing::Values(Case{"frustum", 0}, Case{"bool", 0}, Case{"bool", 2},
                                         Case{"sw", 0}, Case{"coh", 0}, Case{"coh", 2},
                                         Case{"hzb", 0}, Case{"late", 0}, Case{"late", 2},
                                         Case{"auto", 0}, Case{"auto", 2}, Case{"slabs", 0},
                                         Case{"slabs", 2}, Case{"coh", 0, "Sparing", kSparing},
                                         Case{"coh", 2, "Sparing", kSparing},
                                         Case{"bool", 0, "Sparing", kSparing}),
                         nameOf);

}  // namespace
}  // namespace pagoda::hlod
