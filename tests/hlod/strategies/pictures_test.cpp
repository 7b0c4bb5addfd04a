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

struct Setup {
    const char* strategy;
    uint32_t latencyFrames;
};
std::string nameOf(const testing::TestParamInfo<Setup>& info) {
    return std::string(info.param.strategy) + "At" + std::to_string(info.param.latencyFrames);
}

class CullingAtLatency : public testing::TestWithParam<Setup> {};

// A page that is absent has a stand-in, so the first frames count too.
TEST_P(CullingAtLatency, ChangesNoPixelOfItsOwnCutAlongAMovingPath) {
    const auto [name, latency] = GetParam();
    Rig rig(rooms(),
            {.disk = cache::parseDiskProfile("20MB/s,20ms"), .queryLatencyFrames = latency});
    Rig truth(rooms());
    const auto strategy = makeStrategy(name);
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

INSTANTIATE_TEST_SUITE_P(, CullingAtLatency,
                         testing::Values(Setup{"bool", 0}, Setup{"bool", 1}, Setup{"bool", 2},
                                         Setup{"bool", 4}, Setup{"sw", 0}, Setup{"sw", 1},
                                         Setup{"sw", 2}, Setup{"sw", 4}, Setup{"coh", 0},
                                         Setup{"coh", 1}, Setup{"coh", 2}, Setup{"coh", 4},
                                         Setup{"hzb", 0}, Setup{"hzb", 1}, Setup{"hzb", 2},
                                         Setup{"hzb", 4}, Setup{"late", 0}, Setup{"late", 1},
                                         Setup{"late", 2}, Setup{"late", 4}, Setup{"slabs", 0},
                                         Setup{"slabs", 1}, Setup{"slabs", 2}, Setup{"slabs", 4}),
                         nameOf);

class StillView : public testing::TestWithParam<Setup> {};

TEST_P(StillView, ComesToRestAndReadsNoPageTwice) {
    const auto [name, latency] = GetParam();
    for (const bool isPollFree : {false, true}) {
        Rig rig(rooms(), {.queryLatencyFrames = latency});
        rig.device.setCounting(true, isPollFree);
        const auto strategy = makeStrategy(name);
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
                         testing::Values(Setup{"frustum", 0}, Setup{"bool", 0}, Setup{"bool", 2},
                                         Setup{"sw", 0}, Setup{"coh", 0}, Setup{"coh", 2},
                                         Setup{"hzb", 0}, Setup{"late", 0}, Setup{"late", 2},
                                         Setup{"slabs", 0}, Setup{"slabs", 2}),
                         nameOf);

}  // namespace
}  // namespace pagoda::hlod
