#include "cache/lru_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <utility>
#include <vector>

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

TEST(LruPages, OfOneFrameAChildGoesBeforeItsParent) {
    const ooc::NodeId root = ooc::NodeId::root(), child = root.child(0), extra = root.extra(1);
    LruPages pages(40);
    for (const ooc::NodeId id : {child, root, child.child(7), extra}) {
        pages.insert({0, id}, 10, 1);
    }
    std::vector<PageId> evicted;
    ASSERT_TRUE(pages.makeRoom(40, evicted));
    EXPECT_THAT(evicted, ElementsAre(PageId{0, child.child(7)}, PageId{0, child}, PageId{0, extra},
                                     PageId{0, root}));
}

TEST(LruPages, KeepsPinnedPagesAndChangesNothingWhenTheyLeaveTooLittleRoom) {
    LruPages pages(30);
    for (uint64_t i = 1; i <= 3; ++i) pages.insert(page(i), 10, i);
    pages.pin(page(1));
    pages.pin(page(2));
    std::vector<PageId> evicted;
    EXPECT_FALSE(pages.hasRoom(11));
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

TEST(LruPages, OnlyPagesLastUsedBeforeTheFrameSaidGo) {
    LruPages pages(30);
    for (uint64_t i = 1; i <= 3; ++i) pages.insert(page(i), 10, i);
    std::vector<PageId> evicted;
    EXPECT_FALSE(pages.makeRoom(11, evicted, 2));
    EXPECT_FALSE(pages.evictOldest(evicted, 1));
    EXPECT_THAT(evicted, IsEmpty());
    EXPECT_TRUE(pages.makeRoom(10, evicted, 2));
    EXPECT_TRUE(pages.evictOldest(evicted, 3));
    EXPECT_FALSE(pages.evictOldest(evicted, 3));
    EXPECT_THAT(evicted, ElementsAre(page(1), page(2)));
}

TEST(LruPages, ARefreshedPageIsTheLastToGoOfWhatMayGo) {
    LruPages pages(40);
    for (uint64_t i = 1; i <= 4; ++i) pages.insert(page(i), 10, i);
    pages.refresh(page(1), 4);  // as if used in frame 3
    pages.refresh(page(4), 4);  // was used later: stays so
    std::vector<PageId> evicted;
    while (pages.evictOldest(evicted)) {
    }
    EXPECT_THAT(evicted, ElementsAre(page(2), page(3), page(1), page(4)));
}

TEST(LruPages, ReservedBytesCountAsUsedUntilTheyAreReleased) {
    LruPages pages(30);
    pages.insert(page(1), 10, 1);
    pages.reserve(15);
    EXPECT_EQ(pages.usedBytes(), 25u);
    std::vector<PageId> evicted;
    EXPECT_FALSE(pages.makeRoom(16, evicted));
    EXPECT_TRUE(pages.makeRoom(15, evicted));
    EXPECT_THAT(evicted, ElementsAre(page(1)));
    pages.release(15);
    EXPECT_EQ(pages.usedBytes(), 0u);
    EXPECT_TRUE(pages.hasRoom(30));
    EXPECT_FALSE(pages.hasRoom(31));
}

// Kept as plainly as can be; every question is answered by going through all of it.
class NaivePages {
public:
    struct Entry {
        uint64_t bytes = 0, frame = 0;
        bool isPinned = false;
    };
    [[nodiscard]] uint64_t bytes(bool onlyPinned) const {
        uint64_t sum = 0;
        for (const auto& [id, entry] : entries) {
            sum += !onlyPinned || entry.isPinned ? entry.bytes : 0;
        }
        return sum;
    }
    [[nodiscard]] std::optional<PageId> oldest(uint64_t beforeFrame) const {
        std::optional<PageId> best;
        for (const auto& [id, entry] : entries) {  // by id, so that of one frame the last one stays
            if (entry.isPinned || entry.frame >= beforeFrame) continue;
            if (!best || entry.frame <= entries.at(*best).frame) best = id;
        }
        return best;
    }
    // Nullopt, and nothing changes, when it cannot be done.
    std::optional<std::vector<PageId>> makeRoom(uint64_t needed, uint64_t budget,
                                                uint64_t beforeFrame) {
        const auto before = entries;
        std::vector<PageId> evicted;
        while (bytes(false) + reserved + needed > budget) {
            const auto page = oldest(beforeFrame);
            if (!page) {
                entries = before;
                return {};
            }
            evicted.push_back(*page);
            entries.erase(*page);
        }
        return evicted;
    }
    std::map<PageId, Entry> entries;
    uint64_t reserved = 0;
};

TEST(LruPages, AgreesWithANaiveListOverRandomUse) {
    constexpr uint64_t kBudget = 1000;
    constexpr uint64_t kSeed = 7;
    SCOPED_TRACE(kSeed);
    std::mt19937_64 random(kSeed);
    LruPages pages(kBudget);
    NaivePages naive;
    for (uint64_t step = 0; step < 4000; ++step) {
        const uint64_t frame = 3 + step / 4;
        if (random() % 4 == 0) {
            pages.unpinAll();
            for (auto& [id, entry] : naive.entries) entry.isPinned = false;
        }
        if (naive.reserved > 0 && random() % 4 == 0) {
            pages.release(naive.reserved);
            naive.reserved = 0;
        }
        const PageId id = page(1 + random() % 60);
        if (const auto found = naive.entries.find(id); found != naive.entries.end()) {
            const bool isRefresh = random() % 3 == 0;
            isRefresh ? pages.refresh(id, frame - 1) : pages.touch(id, frame);
            uint64_t& last = found->second.frame;
            last = isRefresh ? std::max(last, frame - 2) : frame;
        } else {
            const uint64_t bytes = 1 + random() % 200;
            const uint64_t before = random() % 2 == 0 ? LruPages::kAnyFrame : frame - 1;
            const bool hasRoom = pages.hasRoom(bytes, before);
            std::vector<PageId> evicted;
            const bool wasMade = pages.makeRoom(bytes, evicted, before);
            const auto expected = naive.makeRoom(bytes, kBudget, before);
            ASSERT_EQ(hasRoom, expected.has_value());
            ASSERT_EQ(wasMade, expected.has_value());
            ASSERT_EQ(evicted, expected.value_or(std::vector<PageId>{}));
            if (!wasMade) continue;
            if (random() % 8 == 0) {
                pages.reserve(bytes);
                naive.reserved += bytes;
                continue;
            }
            pages.insert(id, bytes, frame);
            naive.entries[id] = {bytes, frame, false};
        }
        if (random() % 3 == 0) {
            pages.pin(id);
            naive.entries[id].isPinned = true;
        } else if (random() % 5 == 0) {
            pages.unpin(id);
            naive.entries[id].isPinned = false;
        }
        ASSERT_EQ(pages.usedBytes(), naive.bytes(false) + naive.reserved);
        ASSERT_EQ(pages.pinnedBytes(), naive.bytes(true));
        ASSERT_LE(pages.usedBytes(), kBudget);
    }
}

TEST(LruPages, UseTouchesPinsAndTellsTheFirstDemandOfAFrame) {
    LruPages pages(100);
    EXPECT_FALSE(pages.use(page(1), 1, true));
    pages.insert(page(1), 40, 1);
    const auto standIn = pages.use(page(1), 2, false);
    ASSERT_TRUE(standIn);
    EXPECT_EQ(standIn->sizeBytes, 40u);
    EXPECT_FALSE(standIn->isNewDemand);
    EXPECT_TRUE(pages.use(page(1), 2, true)->isNewDemand);
    EXPECT_FALSE(pages.use(page(1), 2, true)->isNewDemand);
    EXPECT_EQ(pages.pinnedBytes(), 40u);
    std::vector<PageId> evicted;
    EXPECT_FALSE(pages.makeRoom(70, evicted));
    pages.unpinAll();
    EXPECT_FALSE(pages.makeRoom(70, evicted, 2));  // used in frame 2
    EXPECT_TRUE(pages.use(page(1), 3, true)->isNewDemand);
    pages.unpinAll();
    EXPECT_TRUE(pages.makeRoom(70, evicted, 4));
    EXPECT_EQ(evicted, std::vector{page(1)});
}

TEST(LruPages, WhoMovedOnWithMostOfThemGoesInTheOrderOfItsLastUse) {
    constexpr uint32_t kPages = 600;
    constexpr uint64_t kSeed = 11;
    SCOPED_TRACE(kSeed);
    std::mt19937_64 random(kSeed);
    LruPages pages(kPages);
    std::map<PageId, uint64_t> lastFrames;
    for (uint32_t i = 0; i < kPages; ++i) {
        pages.insert(page(1 + i), 1, 1);
        lastFrames[page(1 + i)] = 1;
    }
    for (uint64_t frame = 2; frame < 60; ++frame) {
        for (auto& [id, last] : lastFrames) {
            if (random() % 20 == 0) continue;
            ASSERT_TRUE(pages.use(id, frame, true));
            last = frame;
        }
        pages.unpinAll();
        if (frame % 10 != 0) continue;
        for (int i = 0; i < 200; ++i) {  // comes back to the frame that it left
            pages.pin(page(1));
            pages.unpin(page(1));
        }
    }
    std::vector<std::pair<uint64_t, PageId>> order;
    order.reserve(lastFrames.size());
    for (const auto& [id, last] : lastFrames) order.emplace_back(last, id);
    std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first < b.first : b.second < a.second;
    });
    for (const auto& [last, id] : order) {
        std::vector<PageId> evicted;
        ASSERT_EQ(pages.hasRoom(1, last), pages.usedBytes() < kPages);
        ASSERT_TRUE(pages.evictOldest(evicted));
        ASSERT_EQ(evicted, std::vector{id});
    }
    EXPECT_EQ(pages.usedBytes(), 0u);
}

TEST(LruPages, ASlotOnlyHintsAtAPage) {
    LruPages pages(100);
    constexpr uint32_t kSlot = 7;
    EXPECT_FALSE(pages.contains(page(1), kSlot));
    pages.insert(page(1), 10, 1);
    pages.insert(page(2), 20, 1);
    EXPECT_EQ(pages.use(page(1), 2, true, kSlot)->sizeBytes, 10u);
    EXPECT_EQ(pages.use(page(2), 2, true, kSlot)->sizeBytes, 20u);  // the slot's next owner
    EXPECT_TRUE(pages.contains(page(1), kSlot));
    pages.unpinAll();
    pages.erase(page(1));
    EXPECT_FALSE(pages.contains(page(1), kSlot));
    pages.insert(page(3), 30, 3);  // where the first one was
    EXPECT_FALSE(pages.contains(page(1), kSlot));
    EXPECT_EQ(pages.use(page(3), 3, true, kSlot)->sizeBytes, 30u);
}

}  // namespace
}  // namespace pagoda::cache
