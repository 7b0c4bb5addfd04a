// lru_pages.h: which pages stay in memory, and which one goes next.
// Least recently used goes first; pinned pages never go; ties fall by page id, greatest first, so
// that a replayed path evicts the same pages and a child goes before its parent, which stands in
// for it. Holds ids and byte counts; the bytes live elsewhere. One thread only (the render thread).
// Its place in a frame: docs/frame.md.
#pragma once

#include "cache/page_id.h"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pagoda::cache {

class LruPages {
public:
    static constexpr uint64_t kAnyFrame = UINT64_MAX;

    explicit LruPages(uint64_t budgetBytes) : budgetBytes_(budgetBytes) {}

    [[nodiscard]] bool contains(PageId page) const { return pages_.contains(page); }
    // Adds an absent page of `sizeBytes` > 0 that fits (asserted): makeRoom() comes first.
    void insert(PageId page, uint64_t sizeBytes, uint64_t frameIndex);
    // Marks a page that is there as used in this frame.
    void touch(PageId page, uint64_t frameIndex);
    // As touch() with the frame before `beforeFrame`, unless it was used later.
    void refresh(PageId page, uint64_t beforeFrame);
    // A pinned page is never evicted. Pins do not nest. The page is there (asserted).
    void pin(PageId page);
    void unpin(PageId page);
    void unpinAll();
    struct Used {
        uint64_t sizeBytes = 0;
        bool isNewDemand = false;  // the first of the frame with `isDemand`
    };
    // touch() and pin() at once, for what a frame uses thousands of times; nullopt when absent.
    [[nodiscard]] std::optional<Used> use(PageId page, uint64_t frameIndex, bool isDemand);
    // Forgets a page that is there and not pinned (asserted).
    void erase(PageId page);

    // Room for what is on its way: counts as used until it is released.
    void reserve(uint64_t bytes);  // fits (asserted)
    void release(uint64_t bytes);

    // Appends to `evicted` the pages to drop, oldest first, until `neededBytes` fit, and forgets
    // them. Only pages last used before `beforeFrame` go. False, and nothing changes, if that is
    // not enough: the caller then waits, or coarsens the cut. O(log pages) for each page dropped.
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
    [[nodiscard]] uint64_t sizeBytes(PageId page) const { return pages_.at(page).sizeBytes; }
    [[nodiscard]] size_t pageCount() const noexcept { return pages_.size(); }

private:
    struct Entry {
        uint64_t sizeBytes = 0;
        uint64_t lastFrame = 0;
        bool isPinned = false;
        uint64_t demandedFrame = 0;
    };
    struct Key {
        uint64_t lastFrame;
        PageId page;
        [[nodiscard]] bool operator<(const Key& other) const {
            return lastFrame != other.lastFrame ? lastFrame < other.lastFrame : page > other.page;
        }
    };

    void addEvictable(PageId page, const Entry& entry);
    void removeEvictable(PageId page, const Entry& entry);

    uint64_t budgetBytes_;
    uint64_t usedBytes_ = 0, pinnedBytes_ = 0, reservedBytes_ = 0;
    std::unordered_map<PageId, Entry, PageIdHash> pages_;
    std::set<Key> evictable_;                        // the pages that are not pinned, oldest first
    std::map<uint64_t, uint64_t> evictableBytes_;    // of them, by the frame of last use
    std::vector<std::pair<PageId, Entry*>> pinned_;  // entries stay where they are
};

}  // namespace pagoda::cache
