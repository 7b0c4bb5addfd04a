// What is wanted, pinned, evicted, uploaded and counted. Budgets in any order of events:
// residency_soak_test.cpp; prefetching: prefetch_test.cpp.
#include "cache/residency.h"

#include "tests/cache/scripted_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace pagoda::cache {
namespace {

using test::pageOf;
using test::Tree;
using test::World;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr uint64_t kPlenty = uint64_t{1} << 20;

TEST(Residency, AnAbsentPageIsAskedForOnceAndIsThereInTheNextFrame) {
    const Tree tree;
    World world;
    world.begin();
    EXPECT_EQ(world.want(tree.root()), PageState::Absent);
    EXPECT_EQ(world.want(tree.root()), PageState::Absent);
    EXPECT_EQ(world.residency.missingPages(), 1u);
    world.end();
    world.begin();
    EXPECT_EQ(world.want(tree.root()), PageState::Resident);
    EXPECT_EQ(world.residency.missingPages(), 0u);
    world.end();
    EXPECT_EQ(world.loads.reads.size(), 1u);
    EXPECT_EQ(world.residency.counters().loadedPages, 1u);
    EXPECT_EQ(world.residency.counters().bytesRead, 100u);
    EXPECT_EQ(world.residency.counters().bytesUploaded, 10u);
}

TEST(Residency, WhatIsOnItsWayIsReservedAndGivenBackWhenItFails) {
    const Tree tree;
    World world;
    world.loads.failing = {tree.child(0).id.value};
    world.loads.hold();
    world.frames(1, {&tree.root(), &tree.child(0)});
    const uint64_t foretold = 100 + decodedBytes(tree.root());
    EXPECT_EQ(world.residency.hostUsedBytes(), 2 * foretold);
    world.loads.letGo();
    world.begin();
    EXPECT_EQ(world.residency.hostUsedBytes(), sizeof(ooc::Page) + 10 * sizeof(Vec3i));
    for (int i = 0; i < 10; ++i) {
        world.want(tree.child(0));
        world.end();
        world.clock.advance(1);
        world.begin();
    }
    EXPECT_EQ(world.want(tree.child(0)), PageState::Failed);
    EXPECT_EQ(world.residency.hostUsedBytes(), sizeof(ooc::Page) + 10 * sizeof(Vec3i));
}

TEST(Residency, AFailingPageIsListedOnceNeverAskedAgainAndCostsThatPageAlone) {
    const Tree tree;
    World world;
    world.loads.failing = {tree.child(3).id.value};
    for (int i = 0; i < 10; ++i) {
        world.frames(1, {&tree.root(), &tree.child(2), &tree.child(3), &tree.child(4)});
        world.clock.advance(1);
    }
    EXPECT_TRUE(world.isResident(tree.child(2)) && world.isResident(tree.child(4)));
    ASSERT_EQ(world.residency.faults().size(), 1u);
    EXPECT_EQ(world.residency.faults()[0].id, pageOf(tree.child(3)));
    EXPECT_EQ(world.residency.faults()[0].what, "scripted fault");
    EXPECT_EQ(world.residency.counters().failedPages, 1u);
    EXPECT_EQ(world.residency.state(pageOf(tree.child(3))), PageState::Failed);
    EXPECT_EQ(world.residency.missingPages(), 0u);
    EXPECT_EQ(world.requests.counters().sent, 3u + RequestQueue::Limits{}.attempts);
}

TEST(Residency, ResultsOutOfOrderAndInPartsArriveAllTheSame) {
    const Tree tree({.gapBytes = 1 << 20});  // nothing joins
    World world;
    world.loads.hold();
    world.frames(1, {&tree.root(), &tree.child(0), &tree.child(1)});
    world.loads.answer(2);
    world.frames(1, {&tree.root(), &tree.child(0), &tree.child(1)});
    EXPECT_TRUE(world.isResident(tree.child(1)));
    EXPECT_EQ(world.residency.missingPages(), 2u);
    world.loads.answerAllInReverse();
    world.frames(1, {&tree.root(), &tree.child(0), &tree.child(1)});
    EXPECT_EQ(world.residency.missingPages(), 0u);
    EXPECT_EQ(world.loads.reads.size(), 3u);
}

TEST(Residency, APageThatComesLateWhenNobodyWantsItIsNotUploadedButKeptInHostMemory) {
    const Tree tree;
    World world;
    world.loads.hold();
    world.frames(1, {&tree.root()});
    world.frames(5, {});
    world.loads.letGo();
    world.frames(3, {});
    EXPECT_EQ(world.residency.counters().loadedPages, 1u);
    EXPECT_THAT(world.gpu.uploaded, IsEmpty());
    world.frames(2, {&tree.root()});  // from host memory
    EXPECT_TRUE(world.isResident(tree.root()));
    EXPECT_EQ(world.loads.reads.size(), 1u);
}

TEST(Residency, WhatNeverArrivesHoldsItsReservationAndNothingElse) {
    const Tree tree({.gapBytes = 1 << 20});
    World world({{kPlenty, 20, 0}, {}});
    world.loads.hold();
    world.frames(1, {&tree.child(0)});
    const uint64_t reserved = world.residency.hostUsedBytes();
    for (int i = 1; i < 8; ++i) {
        world.frames(1, {&tree.child(1)});
        if (i == 1) world.loads.answer(1);
        world.frames(20, {});
    }
    EXPECT_EQ(world.residency.counters().loadedPages, 1u);
    EXPECT_EQ(world.residency.hostUsedBytes(), reserved + decodedBytes(ooc::Page{}) + 120);
    EXPECT_EQ(world.requests.sentCount(), 1u);
}

TEST(Residency, WhatAFrameWantsStaysAndMakesNoRoomForMore) {
    const Tree tree;
    World world({{kPlenty, 20, 0}, {}});
    for (int i = 0; i < 8; ++i) {
        world.frames(1, {&tree.root(), &tree.child(0), &tree.child(1)});
        EXPECT_EQ(world.residency.demandBytes(), 30u);
    }
    EXPECT_TRUE(world.isResident(tree.root()) && world.isResident(tree.child(0)));
    EXPECT_EQ(world.requests.counters().sent, 2u);  // the third would find no room: not even read
    EXPECT_THAT(world.gpu.dropped, IsEmpty());
    EXPECT_THAT(world.residency.faults(), IsEmpty());
}

TEST(Residency, WhatWasUsedInTheLastTwoFramesIsNotEvictedForSomethingElse) {
    const Tree tree;
    World world({{kPlenty, 10, 0}, {}});
    world.frames(4, {&tree.child(0)});  // used in frames 2, 3 and 4
    ASSERT_TRUE(world.isResident(tree.child(0)));
    world.frames(2, {&tree.child(1)});  // frames 5 and 6: refused
    EXPECT_EQ(world.requests.counters().sent, 1u);
    world.frames(1, {&tree.child(1)});  // frame 7: the other was used before frame 5
    EXPECT_EQ(world.requests.counters().sent, 2u);
    EXPECT_TRUE(world.isResident(tree.child(0)));
    world.frames(1, {&tree.child(1)});
    EXPECT_TRUE(world.isResident(tree.child(1)));
    EXPECT_THAT(world.gpu.dropped, ElementsAre(pageOf(tree.child(0))));
}

TEST(Residency, AChildGoesBeforeItsParentAndWhatIsKeptGoesLast) {
    const Tree tree;
    World world({{kPlenty, 50, 0}, {}});
    world.frames(2, {&tree.root(), &tree.child(0), &tree.child(1), &tree.child(2)});
    world.frames(2, {&tree.child(3)});  // used later than all the others
    for (int i = 0; i < 10; ++i) {
        world.begin();
        world.residency.keep(pageOf(tree.child(1)));
        world.residency.keep(pageOf(tree.grandchild(7, 7)));  // not there: no harm
        for (uint32_t j = 0; j < 5 && i > 4; ++j) world.want(tree.grandchild(0, j));
        world.end();
    }
    EXPECT_THAT(world.gpu.dropped,
                ElementsAre(pageOf(tree.child(2)), pageOf(tree.child(0)), pageOf(tree.root()),
                            pageOf(tree.child(3)), pageOf(tree.child(1))));
}

TEST(Residency, ABudgetOfOnePageKeepsTheRootAndRefusesItsChildren) {
    const Tree tree;
    World world({{kPlenty, 10, 0}, {}});
    world.frames(2, {&tree.root()});
    for (int i = 0; i < 20; ++i) {
        world.frames(1, {&tree.root(), &tree.child(0), &tree.child(7)});
        ASSERT_TRUE(world.isResident(tree.root()));
    }
    EXPECT_EQ(world.loads.reads.size(), 1u);
    EXPECT_EQ(world.residency.missingPages(), 2u);
    EXPECT_FALSE(world.requests.waitForArrival());  // and who waits is told so
}

TEST(Residency, APageLargerThanABudgetFailsWithAClearFaultAndBlocksNobody) {
    Tree tree;
    tree.records[1].vertexCount = 51;  // child 0
    tree.records[2].pageBytes = 5000;  // child 1
    World world({{4000, 50, 0}, {}});
    world.begin();
    EXPECT_EQ(world.want(tree.child(0), 9), PageState::Failed);
    EXPECT_EQ(world.want(tree.child(1), 8), PageState::Failed);
    EXPECT_EQ(world.want(tree.child(2), 1), PageState::Absent);
    world.prefetch(tree.child(0));
    world.end();
    world.frames(3, {&tree.child(0), &tree.child(1), &tree.child(2)});
    EXPECT_TRUE(world.isResident(tree.child(2)));
    EXPECT_EQ(world.loads.reads.size(), 1u);
    EXPECT_EQ(world.residency.missingPages(), 0u);
    ASSERT_EQ(world.residency.faults().size(), 2u);
    EXPECT_EQ(world.residency.faults()[0].what,
              "page takes 51 bytes of GPU memory, more than the whole budget of 50");
    EXPECT_THAT(world.residency.faults()[1].what, HasSubstr("bytes of host memory"));
}

TEST(Residency, APageThatProvesLargerThanABudgetFailsToo) {
    const Tree tree;
    World gpu({{kPlenty, 50, 0}, {}});
    gpu.loads.longerBy[tree.child(0).id.value] = 41;
    gpu.frames(4, {&tree.child(0), &tree.child(1)});
    EXPECT_EQ(gpu.residency.state(pageOf(tree.child(0))), PageState::Failed);
    EXPECT_TRUE(gpu.isResident(tree.child(1)));

    World host({{4000, 50000, 0}, {}});
    host.loads.longerBy[tree.child(0).id.value] = 1000;
    host.frames(6, {&tree.child(0), &tree.child(1)});
    EXPECT_EQ(host.residency.state(pageOf(tree.child(0))), PageState::Failed);
    EXPECT_TRUE(host.isResident(tree.child(1)));
    EXPECT_LE(host.requests.counters().sent, 2u);  // read once
}

TEST(Residency, DropsMorePagesWhileGapsAreTooShort) {
    const Tree tree;
    World world({{kPlenty, 100, 0}, {}});
    world.frames(2, {&tree.child(0), &tree.child(1), &tree.child(2), &tree.child(3)});
    world.frames(3, {&tree.child(0)});
    world.gpu.noRoom = 2;
    world.frames(2, {&tree.child(0), &tree.child(4)});
    EXPECT_TRUE(world.isResident(tree.child(4)));
    EXPECT_THAT(world.gpu.dropped, ElementsAre(pageOf(tree.child(3)), pageOf(tree.child(2))));
    EXPECT_EQ(world.residency.counters().evictedPages, 2u);
}

TEST(Residency, GapsThatStayTooShortLeaveWhatIsInUseAloneAndFailWhatNothingIsLeftToDropFor) {
    const Tree tree;
    World world({{kPlenty, 100, 0}, {}});
    world.frames(2, {&tree.root()});
    world.gpu.noRoom = -1;
    world.frames(5, {&tree.root(), &tree.child(0)});
    EXPECT_TRUE(world.isResident(tree.root()));
    EXPECT_EQ(world.residency.state(pageOf(tree.child(0))), PageState::Absent);
    world.frames(5, {&tree.child(0)});
    EXPECT_FALSE(world.isResident(tree.root()));
    EXPECT_EQ(world.residency.state(pageOf(tree.child(0))), PageState::Failed);
}

TEST(Residency, APageThatCannotBeDrawnIsAFault) {
    const Tree tree;
    World world({{kPlenty, kPlenty, 15}, {}});
    world.gpu.refused = {pageOf(tree.child(0))};
    world.frames(2, {&tree.child(0), &tree.child(1)});
    EXPECT_EQ(world.residency.state(pageOf(tree.child(0))), PageState::Failed);
    EXPECT_TRUE(world.isResident(tree.child(1)));  // what is refused takes nothing of the bound
    ASSERT_EQ(world.residency.faults().size(), 1u);
    EXPECT_THAT(world.residency.faults()[0].what, HasSubstr("vertices"));
}

TEST(Residency, UploadsTheBestFirstWithinTheFramesBoundButTheFirstAlwaysGoes) {
    Tree tree;
    tree.records[3].vertexCount = 100;  // child 2: alone more than the bound
    World world({{kPlenty, kPlenty, 35}, {}});
    const std::vector<const ooc::NodeRecord*> wanted{&tree.child(5), &tree.child(0), &tree.child(2),
                                                     &tree.child(1)};
    world.frames(1, wanted);
    world.frames(1, wanted);
    EXPECT_THAT(world.gpu.uploaded, ElementsAre(pageOf(tree.child(5)), pageOf(tree.child(0))));
    world.frames(1, wanted);
    EXPECT_THAT(world.gpu.uploaded.back(), pageOf(tree.child(2)));
    EXPECT_EQ(world.gpu.uploaded.size(), 3u);  // 1 is smaller, but waits its turn
    world.frames(1, wanted);
    EXPECT_EQ(world.gpu.uploaded.size(), 4u);
}

TEST(Residency, WhoWaitsAnywayUploadsWithoutTheBound) {
    const Tree tree;
    World world({{kPlenty, kPlenty, 5}, {}});
    world.frames(1, {&tree.root(), &tree.child(0), &tree.child(1)});
    world.take();
    world.residency.uploadArrived();
    EXPECT_EQ(world.gpu.uploaded.size(), 3u);
}

TEST(Residency, DemandCountsEachWantedPageOnceAFrameAndNoStandIns) {
    Tree tree;
    tree.records[2].vertexCount = 33;  // child 1
    World world;
    world.frames(2, {&tree.root(), &tree.child(0)});
    world.begin();
    world.want(tree.root(), 1, true);
    world.want(tree.child(0));
    world.want(tree.child(0));
    world.want(tree.child(1));  // absent: foretold from its record
    world.want(tree.child(2), 1, true);
    world.residency.keep(pageOf(tree.root()));
    world.prefetch(tree.child(3));
    EXPECT_EQ(world.residency.demandBytes(), 43u);
    world.want(tree.root());  // both a stand-in and of the cut
    EXPECT_EQ(world.residency.demandBytes(), 53u);
    EXPECT_EQ(world.residency.missingPages(), 2u);
    world.end();
    world.begin();
    EXPECT_EQ(world.residency.demandBytes(), 0u);
}

TEST(Residency, APageStillInHostMemoryIsUploadedAgainWithoutReadingItElseReadAgainAndCounted) {
    const Tree tree({.gapBytes = 1 << 20});
    const uint64_t host = 3 * (100 + decodedBytes(tree.root()));
    World world({{host, 10, 0}, {}});
    world.frames(4, {&tree.child(0)});
    world.frames(5, {&tree.child(1)});
    EXPECT_TRUE(world.isResident(tree.child(1)));
    world.frames(5, {&tree.child(0)});
    EXPECT_TRUE(world.isResident(tree.child(0)));
    EXPECT_EQ(world.residency.counters().uploadedPages, 3u);
    EXPECT_EQ(world.residency.counters().reloadedPages, 0u);
    for (uint32_t i = 2; i < 8; ++i) world.frames(5, {&tree.child(i)});
    world.frames(5, {&tree.child(0)});
    EXPECT_TRUE(world.isResident(tree.child(0)));
    EXPECT_EQ(world.residency.counters().reloadedPages, 1u);
    EXPECT_EQ(world.residency.counters().bytesReloaded, 100u);
}

TEST(Residency, DroppingAllEmptiesGpuMemoryEvenOfWhatIsPinned) {
    const Tree tree;
    World world;
    world.frames(3, {&tree.root(), &tree.child(0)});
    world.residency.dropAll();
    EXPECT_EQ(world.gpu.usedBytes(), 0u);
    EXPECT_EQ(world.residency.gpuUsedBytes(), 0u);
    EXPECT_EQ(world.residency.counters().evictedPages, 0u);  // not to make room
    world.frames(2, {&tree.root()});
    EXPECT_TRUE(world.isResident(tree.root()));
    EXPECT_EQ(world.residency.counters().loadedPages, 2u);
}

}  // namespace
}  // namespace pagoda::cache
