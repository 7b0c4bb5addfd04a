// The frame runner under budgets that the cut does not fit.
#include "tests/hlod/software_rig.h"

#include <gtest/gtest.h>

namespace pagoda::hlod {
namespace {

using test::Rig;
using test::RoomScene;

const RoomScene& rooms() {
    static const RoomScene scene;
    return scene;
}

uint64_t rootBytes() {
    return SoftwarePages(0).sizeBytes(rooms().record(ooc::NodeId::root()));
}

// Bytes of the cut of a view at tau 1.
uint64_t neededBytes(const Camera& camera, const char* name) {
    Rig rig(rooms());
    const auto strategy = makeStrategy(name);
    return rig.settle(camera, *strategy, 1.0).demandBytes;
}

class TightBudget : public testing::TestWithParam<const char*> {};

void expectItSettles(const char* name, const Camera& camera, uint64_t gpuBytes) {
    Rig rig(rooms(), {.gpuBytes = gpuBytes});
    const auto strategy = makeStrategy(name);
    uint64_t peakBytes = 0;
    const FrameRecord record =
        rig.runner.settle(camera, *strategy, {1.0}, [&](const FrameRecord& frame) {
            peakBytes = std::max({peakBytes, frame.gpuBytes, rig.device.pages().usedBytes()});
        });
    EXPECT_TRUE(record.isSettled) << name << ' ' << gpuBytes;
    EXPECT_GT(record.drawnNodes, 0u) << name;
    EXPECT_LE(peakBytes, gpuBytes);
    EXPECT_LE(record.demandBytes, gpuBytes);
    const auto reads = rig.loads.pages;
    for (int i = 0; i < 20; ++i) {
        EXPECT_TRUE(rig.live(camera, *strategy, 1.0).isSettled);
    }
    EXPECT_EQ(rig.loads.pages, reads);  // no page is read again in a still view
}

TEST_P(TightBudget, OfOneNodeDrawsTheRoot) {
    expectItSettles(GetParam(), rooms().walk(3, 10), rootBytes());
}

TEST_P(TightBudget, OfAFractionOfTheNeedSettlesAndIsNeverExceeded) {
    for (int i = 0; i < 10; i += 3) {
        const Camera camera = rooms().walk(i, 10);
        for (const uint64_t share : {2u, 5u, 50u}) {
            const uint64_t budget = neededBytes(camera, GetParam()) / share;
            expectItSettles(GetParam(), camera, std::max(budget, rootBytes() + rootBytes() / 4));
        }
    }
}

// From a cold start nothing is known to be hidden, and all in sight wants far more than that.
TEST_P(TightBudget, OfWhatIsSeenIsEnough) {
    const auto strategy = makeStrategy(GetParam());
    if (!strategy->learnsWhatIsHidden()) GTEST_SKIP() << "wants all that is in sight";
    int views = 0;
    for (int i = 0; i < 10; ++i) {
        const Camera camera = rooms().walk(i, 10);
        const uint64_t seen = neededBytes(camera, GetParam());
        const uint64_t budget = std::max(3 * seen, 3 * rootBytes());
        if (budget > neededBytes(camera, "frustum")) continue;  // hardly anything is hidden
        ++views;
        Rig rig(rooms(), {.gpuBytes = budget});
        strategy->forget();
        FrameRecord record;
        int frames = 0;
        double mostTauPx = 0.0;
        while (!record.isSettled && ++frames < 100) {
            record = rig.live(camera, *strategy, 1.0);
            mostTauPx = std::max(mostTauPx, record.effectiveTauPx);
        }
        EXPECT_TRUE(record.isSettled) << i;
        EXPECT_LT(mostTauPx, 4.0) << i;  // 7 and more where nothing is learnt
    }
    EXPECT_GT(views, 2);
}

// The view jumps in every frame: all is thrown away and asked for again.
TEST_P(TightBudget, SurvivesATeleportEveryFrameWithoutHoles) {
    Rig rig(rooms(), {.gpuBytes = 2 * rootBytes(), .disk = cache::parseDiskProfile("2MB/s,20ms")});
    Rig leaves(rooms());
    const auto strategy = makeStrategy(GetParam()), frustum = makeStrategy("frustum");
    for (int i = 0; i < 60; ++i) {
        const Camera camera = rooms().walk(17 * i % 50, 50);
        const FrameRecord record = rig.live(camera, *strategy, 1.0);
        EXPECT_LE(record.gpuBytes, 2 * rootBytes());
        if (record.drawnNodes == 0) continue;
        static_cast<void>(leaves.settle(camera, *frustum, 0.0));
        EXPECT_EQ(test::holes(rig, leaves.picture()), 0u) << i;
    }
    EXPECT_TRUE(rig.settle(rooms().walk(5, 50), *strategy, 1.0).isSettled);
}

INSTANTIATE_TEST_SUITE_P(, TightBudget,
                         testing::Values("frustum", "bool", "sw", "coh", "hzb", "late", "slabs"));

}  // namespace
}  // namespace pagoda::hlod
