#include "cache/lru_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <list>
#include <map>
#include <random>

namespace pagoda::cache {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

PageId page(uint64_t number) {
    return {0, ooc::NodeId{number}};
}

TEST(LruPages, DropsTheLeastRecentlyUsedPageFirst) {
    LruPages pages(30);
    for (uint64_t i = 1; i <= 3; ++i) pages.insert(page(i), 10, i);
    pages.touch(page(1), 4);
    std::vector<PageId> evicted;
    ASSERT_TRUE(pages.makeRoom(15, evicted));
    EXPECT_THAT(evicted, ElementsAre(page(2), page(3)));
    EXPECT_EQ(pages.usedBytes(), 10u);
}

TEST(LruPages, BreaksTiesOfOneFrameByPageId) {
    LruPages pages(30);
    for (const uint64_t i : {7u, 3u, 5u}) pages.insert(page(i), 10, 1);
    std::vector<PageId> evicted;
    ASSERT_TRUE(pages.makeRoom(20, evicted));
    EXPECT_THAT(evicted, ElementsAre(page(3), page(5)));
}

TEST(LruPages, KeepsPinnedPagesAndChangesNothingWhenTheyLeaveTooLittleRoom) {
    LruPages pages(30);
    for (uint64_t i = 1; i <= 3; ++i) pages.insert(page(i), 10, i);
    pages.pin(page(1));
    pages.pin(page(2));
    std::vector<PageId> evicted;
    EXPECT_FALSE(pages.makeRoom(11, evicted));
    EXPECT_THAT(evicted, IsEmpty());
    EXPECT_EQ(pages.pageCount(), 3u);
    ASSERT_TRUE(pages.makeRoom(10, evicted));
    EXPECT_THAT(evicted, ElementsAre(page(3)));
    pages.unpin(page(2));
    evicted.clear();
    ASSERT_TRUE(pages.makeRoom(20, evicted));
    EXPECT_THAT(evicted, ElementsAre(page(2)));
}

// Against a plain list that is kept in order of use.
TEST(LruPages, AgreesWithANaiveListOverRandomUse) {
    constexpr uint64_t kBudget = 1000;
    std::mt19937_64 random(7);
    LruPages pages(kBudget);
    struct Naive {
        uint64_t size = 0, frame = 0;
        bool isPinned = false;
    };
    std::map<PageId, Naive> naive;
    const auto naiveBytes = [&](bool pinnedOnly) {
        uint64_t sum = 0;
        for (const auto& [id, entry] : naive) sum += !pinnedOnly || entry.isPinned ? entry.size : 0;
        return sum;
    };
    for (uint64_t frame = 1; frame <= 3000; ++frame) {
        if (random() % 4 == 0) {
            pages.unpinAll();
            for (auto& [id, entry] : naive) entry.isPinned = false;
        }
        const PageId id = page(1 + random() % 60);
        if (naive.contains(id)) {
            pages.touch(id, frame);
            naive[id].frame = frame;
        } else {
            const uint64_t size = 1 + random() % 200;
            std::vector<PageId> evicted, expected;
            const bool hasRoom = naiveBytes(true) + size <= kBudget;
            ASSERT_EQ(pages.makeRoom(size, evicted), hasRoom);
            while (hasRoom && naiveBytes(false) + size > kBudget) {
                auto oldest = naive.end();
                for (auto at = naive.begin(); at != naive.end(); ++at) {
                    if (at->second.isPinned) continue;
                    if (oldest == naive.end() || at->second.frame < oldest->second.frame)
                        oldest = at;
                }
                expected.push_back(oldest->first);
                naive.erase(oldest);
            }
            ASSERT_EQ(evicted, expected);
            if (!hasRoom) continue;
            pages.insert(id, size, frame);
            naive[id] = {size, frame, false};
        }
        if (random() % 3 == 0) {
            pages.pin(id);
            naive[id].isPinned = true;
        }
        ASSERT_EQ(pages.usedBytes(), naiveBytes(false));
        ASSERT_EQ(pages.pinnedBytes(), naiveBytes(true));
        ASSERT_LE(pages.usedBytes(), kBudget);
    }
}

}  // namespace
}  // namespace pagoda::cache
