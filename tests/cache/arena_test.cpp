#include "cache/arena.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace pagoda::cache {
namespace {

TEST(Arena, RoundsSizesUpToTheGranuleAndCapacityDown) {
    Arena arena(1050, 100);
    EXPECT_EQ(arena.capacityBytes(), 1000u);
    EXPECT_EQ(arena.roundedUp(1), 100u);
    EXPECT_EQ(arena.roundedUp(100), 100u);
    EXPECT_EQ(arena.allocate(101), 0u);
    EXPECT_EQ(arena.usedBytes(), 200u);
    EXPECT_EQ(arena.allocate(100), 200u);
}

TEST(Arena, FillsTheShortestGapThatFits) {
    Arena arena(1000, 10);
    const auto a = arena.allocate(100), b = arena.allocate(10), c = arena.allocate(50);
    const auto d = arena.allocate(10);
    ASSERT_TRUE(a && b && c && d);
    arena.free(*a);
    arena.free(*c);
    EXPECT_EQ(arena.allocate(40), c);
    EXPECT_EQ(arena.allocate(60), a);
}

TEST(Arena, IsOneGapAgainWhenEverythingIsFreedInAnyOrder) {
    Arena arena(1 << 20, 64);
    std::mt19937_64 random(3);
    std::map<uint64_t, uint64_t> ranges;
    for (int step = 0; step < 20000; ++step) {
        if (random() % 2 == 0 || ranges.empty()) {
            const uint64_t size = 1 + random() % 20000;
            const auto offset = arena.allocate(size);
            if (!offset) {
                ASSERT_LT(arena.largestGapBytes(), arena.roundedUp(size));
                continue;
            }
            // No overlap with what is in use.
            const auto next = ranges.lower_bound(*offset);
            ASSERT_TRUE(next == ranges.end() || next->first >= *offset + size);
            ASSERT_TRUE(next == ranges.begin() ||
                        std::prev(next)->first + std::prev(next)->second <= *offset);
            ASSERT_LE(*offset + size, arena.capacityBytes());
            ranges[*offset] = size;
        } else {
            auto at = ranges.begin();
            std::advance(at, random() % ranges.size());
            arena.free(at->first);
            ranges.erase(at);
        }
    }
    for (const auto& [offset, size] : ranges) arena.free(offset);
    EXPECT_EQ(arena.usedBytes(), 0u);
    EXPECT_EQ(arena.largestGapBytes(), arena.capacityBytes());
}

}  // namespace
}  // namespace pagoda::cache
