// What the camera's motion foretells is there before it is needed, is within the budgets, and is
// left alone where it does not pay.
#include "hlod/view/prefetch.h"

#include "tests/hlod/software_rig.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pagoda::hlod {
namespace {

using test::Rig;
using test::RigOptions;
using test::RoomScene;

const Box3d kScene{Vec3d(-50.0), Vec3d(50.0)};

const RoomScene& rooms() {
    static const RoomScene scene;
    return scene;
}

Camera lookingAlong(const Vec3d& eye, const Vec3d& direction) {
    Camera camera;
    camera.eye = eye;
    camera.target = eye + direction;
    return camera;
}

TEST(CameraMotion, GoesOnAndDiesAway) {
    CameraMotion motion;
    for (int i = 0; i < 4; ++i) motion.note(lookingAlong({1.0 * i, 0, 0}, {0, 0, -1}), kScene);
    const auto next = motion.in(1.0), later = motion.in(20.0);
    ASSERT_TRUE(next && later);
    EXPECT_NEAR(next->eye.x, 4.0, 1e-9);
    EXPECT_GT(later->eye.x, 8.0);
    EXPECT_LT(later->eye.x, 13.0);
    EXPECT_NEAR(later->target.x, later->eye.x, 1e-9);
}

TEST(CameraMotion, TurnsAsItTurned) {
    CameraMotion motion;
    for (int i = 0; i < 6; ++i) {
        const double angle = 0.02 * i;
        motion.note(lookingAlong({0, 0, 0}, {std::sin(angle), 0, -std::cos(angle)}), kScene);
    }
    const auto next = motion.in(1.0);
    ASSERT_TRUE(next);
    EXPECT_NEAR(std::atan2(next->target.x, -next->target.z), 0.12, 1e-9);
}

TEST(CameraMotion, StandsStillAfterAJumpAndWhenNothingMoves) {
    CameraMotion motion;
    EXPECT_FALSE(motion.in(1.0));
    motion.note(lookingAlong({0, 0, 0}, {0, 0, -1}), kScene);
    motion.note(lookingAlong({1, 0, 0}, {0, 0, -1}), kScene);
    EXPECT_TRUE(motion.in(1.0));
    motion.note(lookingAlong({40, 0, 0}, {0, 0, -1}), kScene);
    EXPECT_FALSE(motion.in(1.0));
    motion.note(lookingAlong({41, 0, 0}, {0, 0, -1}), kScene);
    EXPECT_TRUE(motion.in(1.0));
    motion.note(lookingAlong({41, 0, 0}, {1, 0, 0}), kScene);  // a quarter turn
    EXPECT_FALSE(motion.in(1.0));
    motion.note(lookingAlong({41, 0, 0}, {1, 0, 0}), kScene);
    EXPECT_FALSE(motion.in(1.0));
}

struct Seen {
    uint64_t fallbackPixels = 0, prefetched = 0, used = 0, read = 0;
    uint64_t gpuPeak = 0, hostPeak = 0;
    uint64_t missingBlocks = 0, blocksAhead = 0, blocksUsed = 0;
    bool operator==(const Seen&) const = default;
};

// A walk that begins settled, live from a slow disk.
Seen walk(bool doesPrefetch, const char* name, const RigOptions& options) {
    constexpr int kFrames = 150;
    Rig rig(rooms(), options);
    rig.runner.setPrefetch(doesPrefetch);
    const auto strategy = makeStrategy(name);
    static_cast<void>(rig.settle(rooms().walk(0, kFrames), *strategy, 1.0));
    Seen seen;
    for (int i = 0; i < kFrames; ++i) {
        const FrameRecord record = rig.live(rooms().walk(i, kFrames), *strategy, 1.0);
        seen.prefetched += sumOf(record.prefetch).bytes;
        seen.used += sumOf(record.prefetch).usedBytes;
        seen.read += record.bytesRead;
        seen.missingBlocks += rig.streaming.index().missingBlocks();
        seen.blocksAhead += record.prefetchedBlocks.bytes;
        seen.blocksUsed += record.prefetchedBlocks.usedBytes;
        seen.gpuPeak = std::max({seen.gpuPeak, record.gpuBytes, rig.device.pages().usedBytes()});
        seen.hostPeak = std::max(seen.hostPeak, record.hostBytes);
        std::set<ooc::NodeId> standIns;
        const FrameCut& cut = rig.runner.cut();
        for (size_t n = 0; n < cut.drawn().size(); ++n) {
            if (cut.drawnAsStandIn()[n] != 0) standIns.insert(cut.drawn()[n].record->id);
        }
        for (size_t p = 0; !standIns.empty() && p < rig.picture().pixelCount(); ++p) {
            seen.fallbackPixels +=
                rig.picture().nodeOrdinals[p] != 0 && standIns.contains(rig.picture().nodeAt(p));
        }
    }
    const cache::Residency::Counters& counters = rig.streaming.residency().counters();
    EXPECT_EQ(seen.prefetched, sumOf(counters.prefetch).bytes);
    EXPECT_EQ(seen.used, sumOf(counters.prefetch).usedBytes);
    return seen;
}

const char* const kSlowDisk = "20MB/s,10ms";

TEST(Prefetch, MakesAWalkOnASlowDiskShowFewerStandIns) {
    for (const char* name : {"frustum", "bool", "coh"}) {
        const RigOptions options{.disk = cache::parseDiskProfile(kSlowDisk)};
        const Seen without = walk(false, name, options), with = walk(true, name, options);
        EXPECT_EQ(without.prefetched, 0u);
        EXPECT_GT(with.prefetched, 0u) << name;
        EXPECT_LE(with.used, with.prefetched);
        EXPECT_GT(with.used, 0u) << name;
        EXPECT_LT(with.fallbackPixels, without.fallbackPixels) << name;
        EXPECT_EQ(without.blocksAhead, 0u);
        EXPECT_GT(with.blocksUsed, 0u) << name;
        EXPECT_LE(with.blocksUsed, with.blocksAhead);
        EXPECT_LT(with.missingBlocks, without.missingBlocks) << name;
    }
}

// Frames times blocks that the traversal asked for and did not have, down onto the rooms: from afar
// only the root's block is needed.
uint64_t missingBlocksOnADescent(bool doesPrefetch) {
    Rig rig(rooms(), {.disk = cache::parseDiskProfile("1000MB/s,30ms")});
    rig.runner.setPrefetch(doesPrefetch);
    const auto strategy = makeStrategy("frustum");
    uint64_t missing = 0;
    for (int i = 0; i < 120; ++i) {
        Camera camera = lookingAlong({2000, 2000, 140 + 6000 * std::exp(-0.01 * i)}, {0, 0, -1});
        camera.up = {0, 1, 0};
        camera.widthPx = 64;
        camera.heightPx = 48;
        if (i == 0) {
            static_cast<void>(rig.settle(camera, *strategy, 1.0));
            EXPECT_EQ(rig.streaming.index().blockCount(), 1u);
        }
        static_cast<void>(rig.live(camera, *strategy, 1.0));
        missing += rig.streaming.index().missingBlocks();
    }
    EXPECT_GT(rig.streaming.index().blockCount(), 8u);
    return missing;
}

TEST(Prefetch, BlocksOnTheWayAreThereWhenTheCameraComes) {
    const uint64_t without = missingBlocksOnADescent(false), with = missingBlocksOnADescent(true);
    EXPECT_GE(without, 20u);
    // Nearly all: the first of them teach how long a load takes.
    EXPECT_LE(5 * with, without);
}

TEST(Prefetch, ReadsForTheReasonsItIsToldAlone) {
    for (size_t reason = 0; reason < cache::kPrefetchReasons; ++reason) {
        Rig rig(rooms(), {.disk = cache::parseDiskProfile(kSlowDisk)});
        rig.runner.setPrefetch(true);
        rig.runner.prefetcher().setReasons(PrefetchReasons().set(reason));
        const auto strategy = makeStrategy("coh");
        for (int i = 0; i < 60; ++i) {
            static_cast<void>(rig.live(rooms().walk(i, 150), *strategy, 1.0));
        }
        const cache::PrefetchCounts& counts = rig.streaming.residency().counters().prefetch;
        for (size_t other = 0; other < counts.size(); ++other) {
            EXPECT_TRUE(other == reason || counts[other].bytes == 0) << reason << " " << other;
        }
    }
}

TEST(PrefetchReasons, AreReadFromTheirNames) {
    EXPECT_TRUE(parsePrefetchReasons("on")->all());
    EXPECT_TRUE(parsePrefetchReasons("off")->none());
    const PrefetchReasons two = parsePrefetchReasons("uncover,near").value();
    EXPECT_EQ(two.count(), 2u);
    EXPECT_TRUE(two.test(static_cast<size_t>(PrefetchReason::Near)));
    EXPECT_TRUE(two.test(static_cast<size_t>(PrefetchReason::Uncover)));
    for (const char* text : {"", "near,", ",near", "nearby", "on,near", "near refine"}) {
        EXPECT_FALSE(parsePrefetchReasons(text)) << text;
    }
}

TEST(Prefetch, IsTheSameEveryTime) {
    const RigOptions options{.disk = cache::parseDiskProfile(kSlowDisk)};
    EXPECT_EQ(walk(true, "coh", options), walk(true, "coh", options));
}

TEST(Prefetch, KeepsWithinTightBudgets) {
    const uint64_t budget = uint64_t{300} << 10;
    const Seen seen = walk(true, "coh",
                           {.hostBytes = uint64_t{1} << 20,
                            .gpuBytes = budget,
                            .disk = cache::parseDiskProfile(kSlowDisk)});
    EXPECT_LE(seen.gpuPeak, budget);
    EXPECT_LE(seen.hostPeak, uint64_t{1} << 20);
}

TEST(Prefetch, ReadsNothingForAStillCamera) {
    Rig rig(rooms());
    rig.runner.setPrefetch(true);
    const auto strategy = makeStrategy("coh");
    static_cast<void>(rig.settle(rooms().walk(3, 10), *strategy, 1.0));
    const auto pages = rig.loads.pages;
    for (int i = 0; i < 20; ++i) {
        static_cast<void>(rig.live(rooms().walk(3, 10), *strategy, 1.0));
    }
    EXPECT_EQ(rig.loads.pages, pages);
    EXPECT_EQ(sumOf(rig.streaming.residency().counters().prefetch).bytes, 0u);
}

TEST(Prefetch, StopsForAReasonThatForetoldInVainAndGoesOnWhenItIsRightAgain) {
    Rig rig(rooms());
    const Node root = rig.runner.root();
    Prefetcher prefetcher;
    const NodeRange children = rig.tree.residentChildren(root);
    ASSERT_FALSE(children.empty());
    const Box3d box = rig.runner.sceneBoxModel();
    const auto frame = [&](uint64_t index, bool isRight) {
        prefetcher.beginFrame(index, rig.tree);
        prefetcher.noteRefined(root);
        for (uint32_t i = 0; i < children.size(); ++i) {
            if (isRight) prefetcher.noteWant(children[i], false);
            prefetcher.noteHidden(children[i]);
        }
        const double size = glm::length(box.max - box.min);
        const Vec3d eye = box.max + Vec3d(size, 0.001 * size * double(index), size);
        const View view(lookingAlong(eye, (box.min + box.max) * 0.5 - eye), box);
        prefetcher.run(view, box, 1.0, rig.tree, rig.streaming.residency());
    };
    uint64_t index = 1;
    for (; index <= 80; ++index) frame(index, false);
    EXPECT_FALSE(prefetcher.pays(PrefetchReason::Uncover));
    EXPECT_NE(prefetcher.offText().find("uncover"), std::string::npos);
    for (; index <= 2000 && !prefetcher.pays(PrefetchReason::Uncover); ++index) frame(index, true);
    EXPECT_TRUE(prefetcher.pays(PrefetchReason::Uncover));
}

}  // namespace
}  // namespace pagoda::hlod
