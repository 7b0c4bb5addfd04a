#include "cache/thread_loads.h"

#include "tests/cache/memory_source.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>

namespace pagoda::cache {
namespace {

using test::MemorySource;

constexpr uint64_t kFileBytes = uint64_t{1} << 20;

LoadItem pageItem(uint64_t ticket, uint64_t offset, uint32_t bytes) {
    LoadItem item;
    item.ticket = ticket;
    item.range = {offset, bytes};
    item.node.id = ooc::NodeId{ticket};
    item.node.vertexCount = static_cast<uint32_t>(ticket);
    item.node.pageOffset = offset;
    item.node.pageBytes = bytes;
    return item;
}

// Everything that comes, by ticket.
std::map<uint64_t, LoadResult> takeAll(LoadQueue& loads) {
    std::map<uint64_t, LoadResult> all;
    while (loads.waitForArrival()) {
        std::vector<LoadResult> arrived;
        loads.collect(arrived);
        EXPECT_FALSE(arrived.empty());
        for (LoadResult& result : arrived) {
            const uint64_t ticket = result.ticket;
            EXPECT_TRUE(all.emplace(ticket, std::move(result)).second) << "twice: " << ticket;
        }
    }
    EXPECT_EQ(loads.readsInFlight(), 0u);
    return all;
}

TEST(ThreadLoads, EveryItemOfAJoinedReadIsDecodedFromItsOwnBytes) {
    MemorySource source(kFileBytes);
    source.blocks = {{500, 96}, {700, 192}};
    ThreadLoads loads({&source}, 2);
    loads.send({pageItem(1, 1000, 100), pageItem(2, 1100, 50), pageItem(3, 1300, 10)});
    loads.send({{.ticket = 4, .range = {700, 192}, .isBlock = true, .block = 1}});
    const auto all = takeAll(loads);
    ASSERT_EQ(all.size(), 4u);
    for (uint64_t ticket = 1; ticket <= 3; ++ticket) {
        ASSERT_TRUE(all.at(ticket).page.has_value()) << all.at(ticket).fault;
        EXPECT_EQ(all.at(ticket).page->mesh.positions.size(), ticket);
    }
    ASSERT_TRUE(all.at(4).block.has_value()) << all.at(4).fault;
    EXPECT_EQ(all.at(4).block->nodes.size(), 2u);
    EXPECT_EQ(source.reads, 2);
}

TEST(ThreadLoads, TheFaultOfOneItemOfAJoinedReadCostsThatItemAlone) {
    MemorySource source(kFileBytes);
    source.unreadable = {{1120, 1}};
    ThreadLoads loads({&source}, 1);
    loads.send({pageItem(1, 1000, 100), pageItem(2, 1100, 50), pageItem(3, 1300, 10)});
    const auto all = takeAll(loads);
    EXPECT_TRUE(all.at(1).page.has_value());
    EXPECT_EQ(all.at(2).fault, "bad sector");
    EXPECT_TRUE(all.at(3).page.has_value());
    EXPECT_EQ(source.reads, 4);
}

TEST(ThreadLoads, AFailureInTheGapOfAJoinedReadCostsNothing) {
    MemorySource source(kFileBytes);
    source.unreadable = {{1200, 10}};
    ThreadLoads loads({&source}, 1);
    loads.send({pageItem(1, 1000, 100), pageItem(2, 1300, 50)});
    const auto all = takeAll(loads);
    EXPECT_TRUE(all.at(1).page && all.at(2).page);
}

TEST(ThreadLoads, AReadOfOneItemThatFailsIsNotDoneTwice) {
    MemorySource source(kFileBytes);
    ThreadLoads loads({&source}, 1);
    loads.send({pageItem(1, kFileBytes - 10, 100)});
    EXPECT_EQ(takeAll(loads).at(1).fault, "beyond the end");
    EXPECT_EQ(source.reads, 1);
}

TEST(ThreadLoads, SizesThatLieAndDecodersThatRunOutOfMemoryAreFaults) {
    MemorySource source(kFileBytes);
    source.greedy = {2};
    ThreadLoads loads({&source}, 1);
    LoadItem endless = pageItem(1, 0, 100);
    endless.range.bytes = UINT64_MAX;
    loads.send({endless});
    loads.send({pageItem(2, 0, 100), pageItem(3, 200, 100)});
    const auto all = takeAll(loads);
    EXPECT_FALSE(all.at(1).fault.empty());
    EXPECT_FALSE(all.at(2).fault.empty());
    EXPECT_TRUE(all.at(3).page.has_value());
}

TEST(ThreadLoads, ItemsOfSeveralDatabasesComeFromTheirOwn) {
    MemorySource first(1000), second(100000);
    ThreadLoads loads({&first, &second}, 2);
    LoadItem item = pageItem(1, 50000, 10);
    loads.send({item});
    item.ticket = 2;
    item.database = 1;
    loads.send({item});
    const auto all = takeAll(loads);
    EXPECT_EQ(all.at(1).fault, "beyond the end");
    EXPECT_TRUE(all.at(2).page.has_value());
}

TEST(ThreadLoads, ReadsInFlightCountWhatHasNotFinished) {
    MemorySource source(kFileBytes);
    source.setGate(false);
    ThreadLoads loads({&source}, 1);
    EXPECT_FALSE(loads.waitForArrival());
    for (uint64_t i = 1; i <= 5; ++i) loads.send({pageItem(i, i * 1000, 10)});
    EXPECT_EQ(loads.readsInFlight(), 5u);
    std::vector<LoadResult> arrived;
    loads.collect(arrived);
    EXPECT_TRUE(arrived.empty());
    source.setGate(true);
    EXPECT_EQ(takeAll(loads).size(), 5u);
}

TEST(ThreadLoads, ManyItemsOnManyThreadsWithFaultsComeOnceEach) {
    constexpr uint64_t kSeed = 9;
    SCOPED_TRACE(kSeed);
    std::mt19937_64 random(kSeed);
    MemorySource source(kFileBytes);
    std::map<uint64_t, std::string> faults;
    std::vector<std::vector<LoadItem>> reads;
    uint64_t ticket = 0, offset = 0;
    while (ticket < 5000) {
        std::vector<LoadItem> items;
        for (uint64_t i = 1 + random() % 12; i > 0; --i) {
            const auto bytes = static_cast<uint32_t>(1 + random() % 100);
            items.push_back(pageItem(++ticket, offset, bytes));
            if (random() % 10 == 0) {
                source.broken.insert(ticket);
                faults[ticket] = "checksum differs";
            } else if (random() % 20 == 0) {
                source.unreadable.push_back({offset, 1});
                faults[ticket] = "bad sector";
            }
            offset = (offset + bytes + random() % 20);
        }
        reads.push_back(std::move(items));
    }
    ASSERT_LT(offset, kFileBytes);
    ThreadLoads loads({&source}, 4);
    for (auto& items : reads) loads.send(std::move(items));
    const auto all = takeAll(loads);
    ASSERT_EQ(all.size(), ticket);
    for (const auto& [number, result] : all) {
        const auto fault = faults.find(number);
        ASSERT_EQ(result.page.has_value(), fault == faults.end()) << number << result.fault;
        ASSERT_EQ(result.fault, fault == faults.end() ? "" : fault->second);
    }
}

TEST(ThreadLoads, EndsWithWorkPending) {
    MemorySource source(kFileBytes);
    source.setGate(false);
    auto loads = std::make_unique<ThreadLoads>(std::vector<const PageSource*>{&source}, 3);
    for (uint64_t i = 1; i <= 500; ++i) loads->send({pageItem(i, i * 1000, 10)});
    std::thread opener([&source] { source.setGate(true); });
    loads.reset();  // the reads that have begun end; the others are dropped
    opener.join();
    EXPECT_LE(source.reads, 500);
}

TEST(ThreadLoads, EndsWithResultsThatNobodyCollected) {
    MemorySource source(kFileBytes);
    ThreadLoads loads({&source}, 2);
    for (uint64_t i = 1; i <= 50; ++i) loads.send({pageItem(i, i * 1000, 10)});
    EXPECT_TRUE(loads.waitForArrival());
}

}  // namespace
}  // namespace pagoda::cache
