#include "cache/lru_pages.h"

#include <algorithm>
#include <cassert>

namespace pagoda::cache {

void LruPages::insert(PageId page, uint64_t sizeBytes, uint64_t frameIndex) {
    assert(sizeBytes > 0 && sizeBytes <= budgetBytes_ - usedBytes());
    const auto [found, isNew] = pages_.emplace(page, Entry{sizeBytes, frameIndex, false, 0});
    assert(isNew);
    static_cast<void>(isNew);
    addEvictable(page, found->second);
    usedBytes_ += sizeBytes;
}

void LruPages::touch(PageId page, uint64_t frameIndex) {
    Entry& entry = pages_.at(page);
    if (entry.lastFrame == frameIndex) return;
    if (!entry.isPinned) removeEvictable(page, entry);
    entry.lastFrame = frameIndex;
    if (!entry.isPinned) addEvictable(page, entry);
}

void LruPages::refresh(PageId page, uint64_t beforeFrame) {
    if (beforeFrame > 0 && pages_.at(page).lastFrame < beforeFrame - 1) {
        touch(page, beforeFrame - 1);
    }
}

void LruPages::pin(PageId page) {
    Entry& entry = pages_.at(page);
    if (entry.isPinned) return;
    entry.isPinned = true;
    pinnedBytes_ += entry.sizeBytes;
    removeEvictable(page, entry);
    pinned_.emplace_back(page, &entry);
}

std::optional<LruPages::Used> LruPages::use(PageId page, uint64_t frameIndex, bool isDemand) {
    const auto found = pages_.find(page);
    if (found == pages_.end()) return std::nullopt;
    Entry& entry = found->second;
    if (!entry.isPinned) {
        removeEvictable(page, entry);
        entry.isPinned = true;
        pinnedBytes_ += entry.sizeBytes;
        pinned_.emplace_back(page, &entry);
    }
    entry.lastFrame = frameIndex;
    const bool isNewDemand = isDemand && entry.demandedFrame != frameIndex;
    if (isDemand) entry.demandedFrame = frameIndex;
    return Used{entry.sizeBytes, isNewDemand};
}

void LruPages::unpin(PageId page) {
    Entry& entry = pages_.at(page);
    if (!entry.isPinned) return;
    entry.isPinned = false;
    pinnedBytes_ -= entry.sizeBytes;
    addEvictable(page, entry);
    std::erase_if(pinned_, [&](const auto& pinned) { return pinned.first == page; });
}

void LruPages::unpinAll() {
    for (const auto& [page, entry] : pinned_) {
        entry->isPinned = false;
        addEvictable(page, *entry);
    }
    pinned_.clear();
    pinnedBytes_ = 0;
}

void LruPages::erase(PageId page) {
    const auto found = pages_.find(page);
    assert(found != pages_.end() && !found->second.isPinned);
    usedBytes_ -= found->second.sizeBytes;
    removeEvictable(page, found->second);
    pages_.erase(found);
}

void LruPages::addEvictable(PageId page, const Entry& entry) {
    evictable_.insert({entry.lastFrame, page});
    evictableBytes_[entry.lastFrame] += entry.sizeBytes;
}

void LruPages::removeEvictable(PageId page, const Entry& entry) {
    evictable_.erase({entry.lastFrame, page});
    const auto bytes = evictableBytes_.find(entry.lastFrame);
    bytes->second -= entry.sizeBytes;
    if (bytes->second == 0) evictableBytes_.erase(bytes);
}

void LruPages::reserve(uint64_t bytes) {
    assert(bytes <= budgetBytes_ - usedBytes());
    reservedBytes_ += bytes;
}

void LruPages::release(uint64_t bytes) {
    assert(bytes <= reservedBytes_);
    reservedBytes_ -= bytes;
}

bool LruPages::evictOldest(std::vector<PageId>& evicted, uint64_t beforeFrame) {
    if (evictable_.empty() || evictable_.begin()->lastFrame >= beforeFrame) return false;
    const PageId page = evictable_.begin()->page;
    erase(page);
    evicted.push_back(page);
    return true;
}

bool LruPages::hasRoom(uint64_t neededBytes, uint64_t beforeFrame) const {
    uint64_t heldBytes = pinnedBytes_ + reservedBytes_;
    for (auto used = evictableBytes_.lower_bound(beforeFrame); used != evictableBytes_.end();
         ++used) {
        heldBytes += used->second;
    }
    return neededBytes <= budgetBytes_ - heldBytes;
}

bool LruPages::makeRoom(uint64_t neededBytes, std::vector<PageId>& evicted, uint64_t beforeFrame) {
    if (!hasRoom(neededBytes, beforeFrame)) return false;
    while (neededBytes > budgetBytes_ - usedBytes()) {
        const bool wasEvicted = evictOldest(evicted, beforeFrame);
        assert(wasEvicted);
        static_cast<void>(wasEvicted);
    }
    return true;
}

}  // namespace pagoda::cache
