// lru_pages.h: which pages stay in memory, and which one goes next.
// Least recently used goes first; pinned pages never go; ties fall by page id, greatest first, so
// that a replayed path evicts the same pages and a child goes before its parent, which stands in
// for it. Holds ids and byte counts; the bytes live elsewhere. Who has a small number for a page,
// its `slot` (IndexCache), finds it without hashing: slots only hint, another page may have had one
// before. One thread only (the render thread). Its place in a frame: docs/frame.md.
#pragma once

#include "cache/page_id.h"

#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

namespace pagoda::cache {

class LruPages {
public:
    static constexpr uint64_t kAnyFrame = UINT64_MAX;
    static constexpr uint32_t kNoSlot = UINT32_MAX;

    explicit LruPages(uint64_t budgetBytes) : budgetBytes_(budgetBytes) {}

    [[nodiscard]] bool contains(PageId page, uint32_t slot = kNoSlot) const {
        return find(page, slot) != kNoPlace;
    }
    // Adds an absent page of `sizeBytes` > 0 that fits (asserted): makeRoom() comes first.
    void insert(PageId page, uint64_t sizeBytes, uint64_t frameIndex);
    // Marks a page that is there as used in this frame.
    void touch(PageId page, uint64_t frameIndex) { touchPlace(places_.at(page), frameIndex); }
    // As touch() with the frame before `beforeFrame`, unless it was used later or is absent.
    void refresh(PageId page, uint64_t beforeFrame, uint32_t slot = kNoSlot);
    // A pinned page is never evicted. Pins do not nest. The page is there (asserted).
    void pin(PageId page);
    void unpin(PageId page);
    void unpinAll();
    struct Used {
        uint64_t sizeBytes = 0;
        bool isNewDemand = false;  // the first of the frame with `isDemand`
    };
    // touch() and pin() at once, for what a frame uses thousands of times; nullopt when absent.
    [[nodiscard]] std::optional<Used> use(PageId page, uint64_t frameIndex, bool isDemand,
                                          uint32_t slot = kNoSlot);
    // Forgets a page that is there and not pinned (asserted).
    void erase(PageId page);

    // Room for what is on its way: counts as used until it is released.
    void reserve(uint64_t bytes);  // fits (asserted)
    void release(uint64_t bytes);

    // Appends to `evicted` the pages to drop, oldest first, until `neededBytes` fit, and forgets
    // them. Only pages last used before `beforeFrame` go. False, and nothing changes, if that is
    // not enough: the caller then waits, or coarsens the cut. The first of a frame's pages to go
    // costs their sorting, each further one O(1).
    [[nodiscard]] bool makeRoom(uint64_t neededBytes, std::vector<PageId>& evicted,
                                uint64_t beforeFrame = kAnyFrame);
    // Could makeRoom() succeed? O(frames since `beforeFrame`), however many pages would go.
    [[nodiscard]] bool hasRoom(uint64_t neededBytes, uint64_t beforeFrame = kAnyFrame) const;
    // Forgets the oldest page that is not pinned; false when there is none.
    [[nodiscard]] bool evictOldest(std::vector<PageId>& evicted, uint64_t beforeFrame = kAnyFrame);

    [[nodiscard]] uint64_t budgetBytes() const noexcept { return budgetBytes_; }
    // Pages and reservations; never above the budget.
    [[nodiscard]] uint64_t usedBytes() const noexcept { return usedBytes_ + reservedBytes_; }
    [[nodiscard]] uint64_t reservedBytes() const noexcept { return reservedBytes_; }
    [[nodiscard]] uint64_t pinnedBytes() const noexcept { return pinnedBytes_; }
    [[nodiscard]] uint64_t sizeBytes(PageId page) const { return entryOf(page).sizeBytes; }
    [[nodiscard]] size_t pageCount() const noexcept { return places_.size(); }

private:
    static constexpr uint32_t kNoPlace = UINT32_MAX;
    static constexpr PageId kNoPage{UINT32_MAX, {}};
    struct Entry {
        PageId page = kNoPage;
        uint64_t sizeBytes = 0;
        uint64_t lastFrame = 0;
        uint64_t demandedFrame = 0;
        bool isPinned = false;
    };
    // The evictable pages last used in one frame. Each frame thousands of them move on and few are
    // evicted: who has left stays listed until most have, and none are sorted before one must go.
    struct Age {
        uint64_t bytes = 0;
        size_t count = 0;
        std::vector<uint32_t> listed;  // places
        bool isSorted = false;         // by page; the last one goes first
    };

    [[nodiscard]] uint32_t find(PageId page, uint32_t slot) const;
    [[nodiscard]] const Entry& entryOf(PageId page) const { return entries_[places_.at(page)]; }
    void touchPlace(uint32_t place, uint64_t frameIndex);
    void addEvictable(uint32_t place);
    void removeEvictable(const Entry& entry);
    void prune(Age& age, uint64_t frame) const;
    void sort(Age& age, uint64_t frame) const;
    [[nodiscard]] bool isOfAge(uint32_t place, uint64_t frame) const {
        return !entries_[place].isPinned && entries_[place].lastFrame == frame;
    }

    uint64_t budgetBytes_;
    uint64_t usedBytes_ = 0, pinnedBytes_ = 0, reservedBytes_ = 0;
    std::vector<Entry> entries_;
    std::vector<uint32_t> freePlaces_;
    std::unordered_map<PageId, uint32_t, PageIdHash> places_;
    mutable std::vector<uint32_t> placeOfSlot_;  // hints
    std::map<uint64_t, Age> ages_;               // of the pages that are not pinned, by last use
    std::vector<uint32_t> pinned_;
};

}  // namespace pagoda::cache
