// What nothing on the screen needs yet is never in the way of what something does.
#include "cache/residency.h"

#include "tests/cache/scripted_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pagoda::cache {
namespace {

using test::pageOf;
using test::Tree;
using test::World;
using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr uint64_t kPlenty = uint64_t{1} << 20;

TEST(Prefetch, GoesAfterAllThatIsWantedAndIsNeitherMissingNorDemanded) {
    const Tree tree({.gapBytes = 1 << 20});
    World world;
    world.begin();
    world.prefetch(tree.child(0), 99);
    world.want(tree.child(1), 1);
    world.end();
    EXPECT_EQ(world.loads.reads.at(0).at(0).node.id, tree.child(1).id);
    EXPECT_EQ(world.loads.reads.at(1).at(0).node.id, tree.child(0).id);
    EXPECT_EQ(world.residency.missingPages(), 1u);
    EXPECT_EQ(world.residency.demandBytes(), 10u);
    world.begin();
    EXPECT_EQ(world.gpu.uploaded.at(0), pageOf(tree.child(1)));
    EXPECT_EQ(world.gpu.uploaded.at(1), pageOf(tree.child(0)));
    world.prefetch(tree.child(0));  // there: not asked again
    world.end();
    EXPECT_EQ(world.requests.counters().sent, 2u);
}

TEST(Prefetch, PrecisionCountsBytesThatCameBeforeTheyWereWantedAndThoseWantedLater) {
    const Tree tree;
    World world;
    world.begin();
    for (uint32_t i = 0; i < 3; ++i) world.prefetch(tree.child(i));
    world.end();
    world.frames(1, {&tree.child(0), &tree.child(7)});
    world.frames(3, {&tree.child(0), &tree.child(7)});
    EXPECT_EQ(sumOf(world.residency.counters().prefetch).bytes, 300u);
    EXPECT_EQ(sumOf(world.residency.counters().prefetch).usedBytes, 100u);
}

TEST(Prefetch, IsCountedByTheReasonItWasLastAskedFor) {
    const Tree tree({.gapBytes = 1 << 20});
    World world;
    world.begin();
    world.prefetch(tree.child(0), 1.0, 0);
    world.prefetch(tree.child(1), 1.0, 2);
    world.prefetch(tree.child(2), 1.0, 2);
    world.end();
    world.frames(2, {&tree.child(1)});
    const PrefetchCounts& counts = world.residency.counters().prefetch;
    EXPECT_EQ(counts[0].bytes, 100u);
    EXPECT_EQ(counts[0].usedBytes, 0u);
    EXPECT_EQ(counts[2].bytes, 200u);
    EXPECT_EQ(counts[2].usedBytes, 100u);
    EXPECT_EQ(counts[1].bytes + counts[3].bytes, 0u);
}

TEST(Prefetch, WhatIsWantedBeforeItArrivesIsNoPrefetch) {
    const Tree tree;
    World world;
    world.loads.hold();
    world.begin();
    world.prefetch(tree.child(0));
    world.end();
    world.frames(1, {&tree.child(0)});
    world.loads.letGo();
    world.frames(1, {&tree.child(0)});
    EXPECT_TRUE(world.isResident(tree.child(0)));
    EXPECT_EQ(sumOf(world.residency.counters().prefetch).bytes, 0u);
    EXPECT_EQ(sumOf(world.residency.counters().prefetch).usedBytes, 0u);
}

TEST(Prefetch, WhatWasEvictedBeforeItWasWantedWasNotUsed) {
    const Tree tree({.gapBytes = 1 << 20});
    const uint64_t host = 100 + decodedBytes(tree.root());  // one page at a time
    World world({{host, 10, 0}, {}});
    world.frames(2, {&tree.root()});
    world.frames(4, {});
    world.begin();
    world.prefetch(tree.child(0));
    world.end();
    world.frames(3, {&tree.child(1)});  // takes its place
    world.frames(4, {});
    world.frames(4, {&tree.child(0)});
    EXPECT_TRUE(world.isResident(tree.child(0)));
    EXPECT_EQ(sumOf(world.residency.counters().prefetch).bytes, 100u);
    EXPECT_EQ(sumOf(world.residency.counters().prefetch).usedBytes, 0u);
    EXPECT_EQ(world.residency.counters().reloadedPages, 1u);
}

TEST(Prefetch, WhatWasEvictedFromHostMemoryWithoutHavingBeenUploadedWasNotUsedEither) {
    const Tree tree({.gapBytes = 1 << 20});
    World world({{100 + decodedBytes(tree.root()), 20, 0}, {}});
    world.frames(2, {&tree.root()});
    world.gpu.noRoom = -1;
    world.begin();
    world.want(tree.root());
    world.prefetch(tree.child(0));
    world.end();
    world.frames(4, {&tree.root()});
    world.gpu.noRoom = 0;
    world.frames(3, {&tree.root(), &tree.child(1)});  // takes its place
    world.frames(4, {&tree.root()});
    world.frames(4, {&tree.root(), &tree.child(0)});
    EXPECT_TRUE(world.isResident(tree.child(0)));
    EXPECT_EQ(sumOf(world.residency.counters().prefetch).bytes, 100u);
    EXPECT_EQ(sumOf(world.residency.counters().prefetch).usedBytes, 0u);
}

TEST(Prefetch, TakesNoRoomFromWhatWasUsedOrKeptLately) {
    const Tree tree;
    World world({{kPlenty, 20, 0}, {}});
    world.frames(2, {&tree.root(), &tree.child(0)});
    for (int i = 0; i < 12; ++i) {
        world.begin();
        world.want(tree.root());
        world.residency.keep(pageOf(tree.child(0)));
        world.prefetch(tree.child(1));
        world.end();
    }
    EXPECT_THAT(world.gpu.dropped, IsEmpty());
    EXPECT_EQ(world.requests.counters().sent, 2u);
    for (int i = 0; i < 6; ++i) {  // kept no more: the prefetch may have its place
        world.begin();
        world.want(tree.root());
        world.prefetch(tree.child(1));
        world.end();
    }
    EXPECT_TRUE(world.isResident(tree.child(1)));
    EXPECT_FALSE(world.isResident(tree.child(0)));
}

TEST(Prefetch, GivesWayAtOnceToWhatIsWanted) {
    const Tree tree;
    World world({{kPlenty, 30, 0}, {}});
    world.frames(3, {&tree.root()});
    world.begin();
    world.want(tree.root());
    world.prefetch(tree.child(0));
    world.prefetch(tree.child(1));
    world.end();
    world.frames(1, {&tree.root(), &tree.child(2), &tree.child(3)});  // both prefetched are here
    EXPECT_EQ(world.gpu.usedBytes(), 30u);
    EXPECT_TRUE(world.isResident(tree.child(0)) && world.isResident(tree.child(1)));
    world.frames(1, {&tree.root(), &tree.child(2), &tree.child(3)});
    EXPECT_TRUE(world.isResident(tree.child(2)) && world.isResident(tree.child(3)));
    EXPECT_THAT(world.gpu.dropped, Not(Contains(pageOf(tree.root()))));
}

TEST(Prefetch, OnItsWayItHoldsNoGpuRoomThatAWantNeeds) {
    const Tree tree({.gapBytes = 1 << 20});
    World world({{kPlenty, 20, 0}, {}});
    world.frames(2, {&tree.root()});
    world.loads.hold();
    world.begin();
    world.want(tree.root());
    world.prefetch(tree.child(0));
    world.end();
    world.frames(1, {&tree.root(), &tree.child(1)});
    ASSERT_EQ(world.loads.reads.size(), 3u);  // the want was sent although the prefetch would fill
    world.loads.answerAllInReverse();
    world.frames(2, {&tree.root(), &tree.child(1)});
    EXPECT_TRUE(world.isResident(tree.child(1)));
}

}  // namespace
}  // namespace pagoda::cache
