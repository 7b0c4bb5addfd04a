#include "cache/streaming.h"

#include "cache/disk_loads.h"
#include "cache/thread_loads.h"
#include "tests/cache/memory_source.h"
#include "tests/cache/scripted_world.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

namespace pagoda::cache {
namespace {

using test::CountingGpu;
using test::MemorySource;
using test::pageOf;
using test::ScriptedLoads;
using test::Tree;

struct Scene {
    explicit Scene(LoadQueue& loads, Clock& clock, Streaming::Options options = {},
                   size_t databaseCount = 1) {
        source.blocks = {{100, 96}, {300, 96}, {500, 96}};
        const std::vector<SceneDatabase> databases(databaseCount, {ooc::Lattice{}, &source});
        streaming = std::make_unique<Streaming>(databases, loads, gpu, clock, options);
    }
    // A frame that looks at two blocks and wants the root and these children.
    void frame(uint32_t children, bool isHeld = false) {
        streaming->beginFrame();
        static_cast<void>(streaming->index().block(0));
        static_cast<void>(streaming->index().block(1));
        want(tree.root());
        for (uint32_t i = 0; i < children; ++i) want(tree.child(i));
        streaming->endFrame(isHeld);
    }
    void want(const ooc::NodeRecord& node) {
        static_cast<void>(streaming->residency().want({pageOf(node), node, 1.0}));
    }
    Tree tree;
    MemorySource source{uint64_t{1} << 20};
    CountingGpu gpu;
    std::unique_ptr<Streaming> streaming;
};

TEST(Streaming, PagesAndBlocksOfAFrameArriveAndNothingIsMissing) {
    ManualClock clock;
    ScriptedLoads loads;
    Scene scene(loads, clock);
    scene.frame(3);
    EXPECT_EQ(scene.streaming->missing(), 6u);
    EXPECT_TRUE(loads.reads.at(0).at(0).isBlock);
    scene.frame(3);
    EXPECT_EQ(scene.streaming->missing(), 0u);
    EXPECT_EQ(scene.gpu.resident.size(), 4u);
    EXPECT_EQ(scene.streaming->frameIndex(), 2u);
    EXPECT_EQ(scene.streaming->hostBytes(),
              scene.streaming->residency().hostUsedBytes() + scene.streaming->indexBytes());
    EXPECT_GT(scene.streaming->indexBytes(), 0u);
    EXPECT_FALSE(scene.streaming->waitForArrival());
}

TEST(Streaming, WhileHeldNoPageButTheRootsIsSentForAndBlocksAre) {
    ManualClock clock;
    ScriptedLoads loads;
    Scene scene(loads, clock);
    scene.frame(3, true);
    scene.frame(3, true);
    EXPECT_EQ(scene.streaming->index().blockCount(), 2u);
    EXPECT_EQ(scene.gpu.resident.size(), 1u);
    EXPECT_FALSE(scene.streaming->waitForArrival());
    scene.frame(3);
    scene.frame(3);
    EXPECT_EQ(scene.gpu.resident.size(), 4u);
}

TEST(Streaming, PagesThatFindNoRoomDoNotHoldUpBlocks) {
    ManualClock clock;
    ScriptedLoads loads;
    Scene scene(loads, clock, {.gpuBytes = 10});  // the root and no more
    scene.streaming->beginFrame();
    scene.want(scene.tree.root());
    scene.streaming->endFrame();
    for (int i = 0; i < 5; ++i) scene.frame(8);
    EXPECT_EQ(scene.streaming->index().blockCount(), 2u);
    EXPECT_EQ(scene.gpu.resident.size(), 1u);
    EXPECT_EQ(scene.streaming->missing(), 8u);
    EXPECT_FALSE(scene.streaming->waitForArrival());
}

TEST(Streaming, WaitingTakesAndUploadsWhatHasArrived) {
    ManualClock clock;
    auto inner = std::make_unique<ScriptedLoads>();
    DiskLoads disk(std::move(inner), {.bytesPerS = 1e4, .latencyS = 0.01}, clock);
    Scene scene(disk, clock);
    scene.frame(8);
    EXPECT_TRUE(scene.gpu.resident.empty());
    while (scene.streaming->waitForArrival()) {
    }
    EXPECT_EQ(scene.gpu.resident.size(), 9u);
    // Nine pages of 100 bytes and two blocks of 96, all in flight at once; each block its own read.
    EXPECT_NEAR(clock.nowS(), 0.01 + (900 + 296) / 1e4, 1e-9);
}

TEST(Streaming, DatabasesShareTheQueueAndKeepTheirOwnBlocks) {
    ManualClock clock;
    ScriptedLoads loads;
    Scene scene(loads, clock, {}, 2);
    for (int i = 0; i < 2; ++i) {
        scene.streaming->beginFrame();
        static_cast<void>(scene.streaming->index(1).block(2));
        scene.want(scene.tree.root());
        const ooc::NodeRecord& root = scene.tree.root();
        static_cast<void>(scene.streaming->residency().want({{1, root.id}, root, 1.0}));
        scene.streaming->endFrame();
    }
    EXPECT_EQ(scene.streaming->index(0).blockCount(), 0u);
    EXPECT_EQ(scene.streaming->index(1).blockCount(), 1u);
    EXPECT_TRUE(scene.gpu.resident.contains({0, scene.tree.root().id}));
    EXPECT_TRUE(scene.gpu.resident.contains({1, scene.tree.root().id}));
}

// A scene that settles, on a disk that fails and stutters: always, in a bounded number of frames,
// and with the budgets of host and GPU memory kept throughout.
TEST(Streaming, SettlesOnAFailingDiskOrSaysWhatCannotComeAndNeverWaitsForEver) {
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        ManualClock clock;
        DiskLoads disk(
            std::make_unique<ScriptedLoads>(),
            {.bytesPerS = 1e6, .latencyS = 0.01, .failShare = 0.3, .shortShare = 0.2, .seed = seed},
            clock);
        const uint64_t hostBytes = 20000;
        Scene scene(disk, clock,
                    {.hostBytes = hostBytes, .gpuBytes = 60, .uploadBytesPerFrame = 15});
        int frames = 0;
        do {
            scene.frame(5);
            ASSERT_LE(scene.streaming->hostBytes(), hostBytes);
            ASSERT_LE(scene.gpu.usedBytes(), 60u);
            ASSERT_LT(++frames, 200);
            static_cast<void>(scene.streaming->waitForArrival());
        } while (scene.streaming->missing() > 0);
        const size_t faults = scene.streaming->residency().faults().size();
        EXPECT_EQ(scene.gpu.resident.size() + faults, 6u);
        int waits = 0;
        while (scene.streaming->waitForArrival()) ASSERT_LT(++waits, 100);
    }
}

TEST(Streaming, RealThreadsUnderAFailingDiskGiveTheSameFramesEachTime) {
    const auto play = [] {
        ManualClock clock;
        MemorySource source(uint64_t{1} << 20);
        source.broken = {ooc::NodeId::root().child(6).value};
        DiskLoads disk(std::make_unique<ThreadLoads>(std::vector<const PageSource*>{&source}, 3),
                       {.bytesPerS = 1e5, .latencyS = 0.02, .failShare = 0.1, .shortShare = 0.1},
                       clock);
        Scene scene(disk, clock, {.gpuBytes = 200, .uploadBytesPerFrame = 20});
        std::mt19937 random(4);
        std::vector<PageId> history;
        for (int i = 0; i < 300; ++i) {
            scene.streaming->beginFrame();
            scene.want(scene.tree.root());
            scene.want(scene.tree.child(6));
            for (int j = 0; j < 10; ++j) {
                scene.want(scene.tree.records[(random() % 73 + static_cast<uint32_t>(i)) % 73]);
            }
            scene.streaming->endFrame();
            clock.advance(1.0 / 60);
            history.insert(history.end(), scene.gpu.uploaded.begin(), scene.gpu.uploaded.end());
            history.insert(history.end(), scene.gpu.dropped.begin(), scene.gpu.dropped.end());
            scene.gpu.uploaded.clear();
            scene.gpu.dropped.clear();
        }
        EXPECT_EQ(scene.streaming->residency().faults().size(), 1u);
        return history;
    };
    const auto first = play();
    EXPECT_GT(first.size(), 100u);
    EXPECT_EQ(first, play());
}

}  // namespace
}  // namespace pagoda::cache
