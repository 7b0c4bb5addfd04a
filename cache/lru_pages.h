// lru_pages.h: which pages stay in memory, and which one goes next.
// Least recently used goes first; pinned pages never go; ties fall by page id, so that a replayed
// path evicts the same pages. Holds ids and byte counts; the bytes live elsewhere. One thread only
// (the render thread). Its place in a frame: docs/frame.md, step 3.
#pragma once

#include "cache/page_id.h"

#include <cstdint>
#include <set>
#include <unordered_map>
#include <vector>

namespace pagoda::cache {

class LruPages {
public:
    explicit LruPages(uint64_t budgetBytes) : budgetBytes_(budgetBytes) {}

    [[nodiscard]] bool contains(PageId page) const { return pages_.contains(page); }
    // Adds an absent page of `sizeBytes` > 0 that fits (asserted): makeRoom() comes first.
    void insert(PageId page, uint64_t sizeBytes, uint64_t frameIndex);
    // Marks a page that is there as used in this frame.
    void touch(PageId page, uint64_t frameIndex);
    // A pinned page is never evicted. Pins do not nest. The page is there (asserted).
    void pin(PageId page);
    void unpin(PageId page);
    void unpinAll();
    // Forgets a page that is there and not pinned (asserted).
    void erase(PageId page);

    // Appends to `evicted` the pages to drop, oldest first, until `neededBytes` fit, and forgets
    // them. False, and nothing changes, if pinned pages leave too little room: the caller then
    // coarsens the cut. O(log pages) for each page dropped.
    [[nodiscard]] bool makeRoom(uint64_t neededBytes, std::vector<PageId>& evicted);
    // Forgets the oldest page that is not pinned; false when there is none.
    [[nodiscard]] bool evictOldest(std::vector<PageId>& evicted);

    [[nodiscard]] uint64_t budgetBytes() const noexcept { return budgetBytes_; }
    [[nodiscard]] uint64_t usedBytes() const noexcept {
        return usedBytes_;
    }  // never above the budget
    [[nodiscard]] uint64_t pinnedBytes() const noexcept { return pinnedBytes_; }
    [[nodiscard]] size_t pageCount() const noexcept { return pages_.size(); }

private:
    struct Entry {
        uint64_t sizeBytes = 0;
        uint64_t lastFrame = 0;
        bool isPinned = false;
    };
    struct Key {
        uint64_t lastFrame;
        PageId page;
        [[nodiscard]] auto operator<=>(const Key&) const = default;
    };

    uint64_t budgetBytes_;
    uint64_t usedBytes_ = 0, pinnedBytes_ = 0;
    std::unordered_map<PageId, Entry, PageIdHash> pages_;
    std::set<Key> evictable_;  // the pages that are not pinned, oldest first
    std::vector<PageId> pinned_;
};

}  // namespace pagoda::cache
