#include "cache/lru_pages.h"

#include <algorithm>
#include <cassert>

namespace pagoda::cache {

void LruPages::insert(PageId page, uint64_t sizeBytes, uint64_t frameIndex) {
    assert(sizeBytes > 0 && sizeBytes <= budgetBytes_ - usedBytes());
    const bool isNew = pages_.emplace(page, Entry{sizeBytes, frameIndex, false}).second;
    assert(isNew);
    static_cast<void>(isNew);
    evictable_.insert({frameIndex, page});
    usedBytes_ += sizeBytes;
}

void LruPages::touch(PageId page, uint64_t frameIndex) {
    Entry& entry = pages_.at(page);
    if (entry.lastFrame == frameIndex) return;
    if (!entry.isPinned) {
        evictable_.erase({entry.lastFrame, page});
        evictable_.insert({frameIndex, page});
    }
    entry.lastFrame = frameIndex;
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
    evictable_.erase({entry.lastFrame, page});
    pinned_.push_back(page);
}

void LruPages::unpin(PageId page) {
    Entry& entry = pages_.at(page);
    if (!entry.isPinned) return;
    entry.isPinned = false;
    pinnedBytes_ -= entry.sizeBytes;
    evictable_.insert({entry.lastFrame, page});
    std::erase(pinned_, page);
}

void LruPages::unpinAll() {
    for (const PageId& page : pinned_) {
        Entry& entry = pages_.at(page);
        entry.isPinned = false;
        evictable_.insert({entry.lastFrame, page});
    }
    pinned_.clear();
    pinnedBytes_ = 0;
}

void LruPages::erase(PageId page) {
    const auto found = pages_.find(page);
    assert(found != pages_.end() && !found->second.isPinned);
    usedBytes_ -= found->second.sizeBytes;
    evictable_.erase({found->second.lastFrame, page});
    pages_.erase(found);
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
    uint64_t freeBytes = budgetBytes_ - usedBytes();
    for (auto key = evictable_.begin(); freeBytes < neededBytes; ++key) {
        if (key == evictable_.end() || key->lastFrame >= beforeFrame) return false;
        freeBytes += pages_.at(key->page).sizeBytes;
    }
    return true;
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
