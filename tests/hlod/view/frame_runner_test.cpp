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

INSTANTIATE_TEST_SUITE_P(, TightBudget, testing::Values("frustum", "bool", "sw", "coh", "hzb"));

}  // namespace
}  // namespace pagoda::hlod
