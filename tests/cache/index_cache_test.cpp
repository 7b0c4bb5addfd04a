#include "cache/index_cache.h"

#include "tests/cache/memory_source.h"
#include "tests/cache/scripted_world.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace pagoda::cache {
namespace {

using test::MemorySource;
using test::ScriptedLoads;

constexpr uint32_t kBlocks = 20;
constexpr uint64_t kBlockBytes = 2 * 96;  // two nodes
constexpr uint64_t kHeldBytes = 2 * (sizeof(ooc::NodeRecord) + sizeof(Box3d));
// What admit() sets aside for a block before its nodes are known, from its bytes on disk.
constexpr uint64_t kBoundBytes = kBlockBytes + 3 * (sizeof(ooc::NodeRecord) + sizeof(Box3d));

struct Index {
    explicit Index(uint64_t budgetBytes)
        : requests(loads, clock, {.joinGapBytes = 0, .readBytes = 1, .attempts = 2}),
          index(ooc::Lattice{}, source, requests, budgetBytes) {
        for (uint64_t i = 0; i < kBlocks; ++i) source.blocks.push_back({i * 1000, kBlockBytes});
    }
    void take() {
        std::vector<RequestQueue::Arrival> arrivals;
        requests.collect(arrivals);
        for (RequestQueue::Arrival& arrival : arrivals) index.arrive(arrival);
    }
    // A frame that looks at these, the first most urgent, and reads those ahead.
    void frame(const std::vector<uint32_t>& blocks, const std::vector<uint32_t>& ahead = {}) {
        take();
        requests.beginFrame();
        index.beginFrame(++frameIndex);
        double priority = 100;
        for (const uint32_t block : blocks) static_cast<void>(index.block(block, priority--));
        for (const uint32_t block : ahead) {
            static_cast<void>(index.peek(block));
            index.prefetch(block, 1000);
        }
        requests.send([this](const Request& request) { return index.admit(request); });
    }
    bool isResident(uint32_t block) const {
        return index.state(block) == IndexCache::BlockState::Resident;
    }
    ManualClock clock;
    ScriptedLoads loads;
    MemorySource source{1 << 20};
    RequestQueue requests;
    IndexCache index;
    uint64_t frameIndex = 0;
};

TEST(IndexCache, ABlockIsAbsentThenResidentAndReadOnce) {
    Index world(1 << 20);
    world.index.beginFrame(1);
    EXPECT_EQ(world.index.block(3), nullptr);
    EXPECT_EQ(world.index.block(3), nullptr);
    EXPECT_EQ(world.index.missingBlocks(), 1u);
    EXPECT_EQ(world.index.state(3), IndexCache::BlockState::Absent);
    world.frame({3});
    world.frame({3});
    const IndexCache::Block* block = world.index.block(3);
    ASSERT_NE(block, nullptr);
    EXPECT_EQ(block->index.nodes.size(), 2u);
    EXPECT_EQ(block->boxesModel.size(), 2u);
    EXPECT_EQ(world.index.missingBlocks(), 0u);
    EXPECT_EQ(world.index.usedBytes(), kHeldBytes);
    EXPECT_EQ(world.index.loadedBlocks(), 1u);
    EXPECT_EQ(world.loads.reads.size(), 1u);
}

TEST(IndexCache, ABrokenBlockIsListedOnceAndNeverAskedForAgain) {
    Index world(1 << 20);
    world.loads.failing = {3};
    for (int i = 0; i < 6; ++i) {
        world.frame({0, 3, 4});
        world.clock.advance(1);
    }
    EXPECT_EQ(world.index.state(3), IndexCache::BlockState::Broken);
    ASSERT_EQ(world.index.faults().size(), 1u);
    EXPECT_EQ(world.index.faults()[0].block, 3u);
    EXPECT_EQ(world.index.faults()[0].what, "scripted fault");
    EXPECT_EQ(world.requests.counters().sent, 4u);  // two attempts, and the two others
    EXPECT_EQ(world.index.usedBytes(), 2 * kHeldBytes);
    EXPECT_EQ(world.index.missingBlocks(), 0u);
}

TEST(IndexCache, AFaultOfContentIsListedOnceAndABlockThatDoesNotExistToo) {
    Index world(1 << 20);
    world.frame({0});
    world.frame({0});
    world.index.reportFault(0, "children do not belong to their parent");
    world.index.reportFault(0, "children do not belong to their parent");
    EXPECT_EQ(world.index.block(kBlocks), nullptr);
    EXPECT_EQ(world.index.block(kBlocks), nullptr);
    ASSERT_EQ(world.index.faults().size(), 2u);
    EXPECT_EQ(world.index.faults()[1].what, "no such block");
    EXPECT_EQ(world.index.missingBlocks(), 0u);
}

TEST(IndexCache, TheBlockLookedAtLongestAgoGoesAndItsSlotsAreUsedAgain) {
    Index world(2 * kHeldBytes + kBoundBytes);  // a third one may be read beside two
    world.frame({0, 5});
    world.frame({0, 5});
    world.frame({0, 6});
    world.frame({0, 6, 7});  // frame 4: block 5 was looked at in frame 2
    EXPECT_TRUE(world.isResident(5) && world.isResident(6));
    world.frame({0, 6, 7});
    world.frame({0, 6, 7});
    EXPECT_FALSE(world.isResident(5));
    EXPECT_TRUE(world.isResident(0) && world.isResident(6) && world.isResident(7));
    EXPECT_EQ(world.index.slotCount(), 3 * IndexCache::kSlotsPerBlock);
}

TEST(IndexCache, BlocksOfTheLastTwoFramesStayAndNoNewOnesComeThen) {
    Index world(kHeldBytes + kBoundBytes);
    world.frame({0, 1});
    for (int i = 0; i < 10; ++i) world.frame({0, 1, 2});
    EXPECT_TRUE(world.isResident(0) && world.isResident(1));
    EXPECT_FALSE(world.isResident(2));
    EXPECT_EQ(world.index.missingBlocks(), 1u);
    EXPECT_EQ(world.requests.counters().sent, 2u);
    for (int i = 0; i < 4; ++i) world.frame({0, 2});
    EXPECT_TRUE(world.isResident(2));
    EXPECT_FALSE(world.isResident(1));
}

TEST(IndexCache, TheRootsBlockComesWhateverTheBudgetAndALongerOneThanThatIsAFault) {
    Index world(1);
    world.frame({0, 1});
    world.frame({0, 1});
    EXPECT_TRUE(world.isResident(0));
    EXPECT_EQ(world.index.state(1), IndexCache::BlockState::Broken);
    ASSERT_EQ(world.index.faults().size(), 1u);
    EXPECT_EQ(world.index.faults()[0].block, 1u);
    EXPECT_EQ(world.index.missingBlocks(), 0u);
}

TEST(IndexCache, ReservationsAreGivenBackOnFailure) {
    Index world(1 << 20);
    world.loads.hold();
    world.loads.failing = {0};
    world.frame({0});
    EXPECT_EQ(world.index.usedBytes(), kBoundBytes);
    world.loads.letGo();
    world.frame({});
    EXPECT_EQ(world.index.usedBytes(), 0u);
}

TEST(IndexCache, ABlockReadAheadComesAfterTheWantedOnesAndIsNotMissing) {
    Index world(1 << 20);
    world.frame({0, 3}, {4});
    EXPECT_EQ(world.index.missingBlocks(), 2u);
    ASSERT_EQ(world.loads.reads.size(), 3u);
    EXPECT_EQ(world.loads.reads[2].at(0).block, 4u);
    world.frame({0, 3}, {4});
    EXPECT_TRUE(world.isResident(4));
    EXPECT_EQ(world.index.prefetched().bytes, kBlockBytes);
    EXPECT_EQ(world.index.prefetched().usedBytes, 0u);
    world.frame({0, 3, 4});
    world.frame({0, 3, 4});
    EXPECT_EQ(world.index.missingBlocks(), 0u);
    EXPECT_EQ(world.index.prefetched().usedBytes, kBlockBytes);
    EXPECT_EQ(world.loads.reads.size(), 3u);
}

TEST(IndexCache, ABlockWantedBeforeItArrivesWasNotReadAhead) {
    Index world(1 << 20);
    world.loads.hold();
    world.frame({0}, {4});
    world.frame({0, 4});
    EXPECT_EQ(world.index.missingBlocks(), 2u);
    world.loads.letGo();
    world.frame({0, 4});
    EXPECT_TRUE(world.isResident(4));
    EXPECT_EQ(world.index.prefetched().bytes, 0u);
    EXPECT_EQ(world.index.prefetched().usedBytes, 0u);
}

TEST(IndexCache, ReadingAheadTakesNoRoomFromWhatWasUsedLatelyAndGivesItsOwnToTheFirstWant) {
    Index world(2 * kHeldBytes + kBoundBytes);
    world.frame({0, 1});
    for (int i = 0; i < 10; ++i) world.frame({0, 1}, {2, 3});
    EXPECT_TRUE(world.isResident(0) && world.isResident(1) && world.isResident(2));
    EXPECT_FALSE(world.isResident(3));  // the one read ahead first stays, too
    EXPECT_EQ(world.loads.reads.size(), 3u);
    world.frame({0, 1, 4}, {2, 3});
    world.frame({0, 1, 4}, {2, 3});
    EXPECT_TRUE(world.isResident(1) && world.isResident(4));
    EXPECT_FALSE(world.isResident(2));
    EXPECT_EQ(world.index.prefetched().bytes, kBlockBytes);
    EXPECT_EQ(world.index.prefetched().usedBytes, 0u);
}

TEST(IndexCache, LookingAheadIsNoUse) {
    Index world(2 * kHeldBytes + kBoundBytes);
    for (int i = 0; i < 3; ++i) world.frame({0, 1, 2});
    for (int i = 0; i < 6; ++i) {
        world.frame({0, 1});
        EXPECT_NE(world.index.peek(2), nullptr);
        EXPECT_EQ(world.index.peek(9), nullptr);
    }
    world.frame({0, 1, 3});
    world.frame({0, 1, 3});
    EXPECT_TRUE(world.isResident(3));
    EXPECT_FALSE(world.isResident(2));
}

TEST(IndexCache, SlotsAreUniqueAndTheBudgetHoldsInAnyOrderOfEvents) {
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        const uint64_t budget = kBoundBytes * (1 + random() % 6);
        Index world(budget);
        world.loads.hold();
        size_t answered = 0;
        std::map<uint32_t, uint64_t> usedIn;
        for (int i = 0; i < 200; ++i) {
            while (answered < world.loads.reads.size() && random() % 3 != 0) {
                world.loads.answer(answered++);
            }
            std::vector<uint32_t> looked{0};
            for (uint64_t j = random() % 4; j > 0; --j) {
                looked.push_back(static_cast<uint32_t>(random() % kBlocks));
            }
            world.frame(looked, {static_cast<uint32_t>(random() % kBlocks)});
            for (const uint32_t block : looked) {
                if (world.isResident(block)) usedIn[block] = world.frameIndex;
            }
            uint64_t held = 0;
            for (uint32_t block = 0; block < kBlocks; ++block) {
                const bool wasUsed =
                    usedIn.contains(block) && usedIn[block] + 2 >= world.frameIndex;
                ASSERT_TRUE(!wasUsed || world.isResident(block)) << block;
                held += world.isResident(block) ? kHeldBytes : 0;
            }
            std::map<uint32_t, uint32_t> owners;  // of slots
            for (const uint32_t block : looked) {
                if (!world.isResident(block)) continue;
                const uint32_t slot = world.index.block(block)->firstSlot;
                ASSERT_EQ(slot % IndexCache::kSlotsPerBlock, 0u);
                ASSERT_LT(slot, world.index.slotCount());
                ASSERT_EQ(owners.try_emplace(slot, block).first->second, block);
            }
            const uint64_t reserved = (world.loads.reads.size() - answered) * kBoundBytes;
            ASSERT_EQ(world.index.usedBytes(), held + reserved);
            ASSERT_LE(world.index.usedBytes(), budget);
            ASSERT_LE(world.index.slotCount(),
                      (budget / kHeldBytes + 1) * IndexCache::kSlotsPerBlock);
        }
    }
}

}  // namespace
}  // namespace pagoda::cache
