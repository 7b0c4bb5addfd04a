#include "cache/lru_pages.h"

#include <algorithm>
#include <cassert>

namespace pagoda::cache {
namespace {

constexpr size_t kMinPruned = 64;  // shorter lists are not worth it

}  // namespace

uint32_t LruPages::find(PageId page, uint32_t slot) const {
    if (slot < placeOfSlot_.size()) {
        const uint32_t hint = placeOfSlot_[slot];
        if (hint < entries_.size() && entries_[hint].page == page) return hint;
    }
    const auto found = places_.find(page);
    if (found == places_.end()) return kNoPlace;
    if (slot == kNoSlot) return found->second;
    if (slot >= placeOfSlot_.size()) placeOfSlot_.resize(slot + 1, kNoPlace);
    placeOfSlot_[slot] = found->second;
    return found->second;
}

void LruPages::insert(PageId page, uint64_t sizeBytes, uint64_t frameIndex) {
    assert(sizeBytes > 0 && sizeBytes <= budgetBytes_ - usedBytes());
    auto place = static_cast<uint32_t>(entries_.size());
    if (freePlaces_.empty()) {
        entries_.emplace_back();
    } else {
        place = freePlaces_.back();
        freePlaces_.pop_back();
    }
    const bool isNew = places_.emplace(page, place).second;
    assert(isNew);
    static_cast<void>(isNew);
    entries_[place] = {page, sizeBytes, frameIndex, 0, false};
    addEvictable(place);
    usedBytes_ += sizeBytes;
}

void LruPages::touchPlace(uint32_t place, uint64_t frameIndex) {
    Entry& entry = entries_[place];
    if (entry.lastFrame == frameIndex) return;
    if (!entry.isPinned) removeEvictable(entry);
    entry.lastFrame = frameIndex;
    if (!entry.isPinned) addEvictable(place);
}

void LruPages::refresh(PageId page, uint64_t beforeFrame, uint32_t slot) {
    const uint32_t place = find(page, slot);
    if (place == kNoPlace || beforeFrame == 0) return;
    if (entries_[place].lastFrame < beforeFrame - 1) touchPlace(place, beforeFrame - 1);
}

void LruPages::pin(PageId page) {
    const uint32_t place = places_.at(page);
    Entry& entry = entries_[place];
    if (entry.isPinned) return;
    removeEvictable(entry);
    entry.isPinned = true;
    pinnedBytes_ += entry.sizeBytes;
    pinned_.push_back(place);
}

std::optional<LruPages::Used> LruPages::use(PageId page, uint64_t frameIndex, bool isDemand,
                                            uint32_t slot) {
    const uint32_t place = find(page, slot);
    if (place == kNoPlace) return std::nullopt;
    Entry& entry = entries_[place];
    if (!entry.isPinned) {
        removeEvictable(entry);
        entry.isPinned = true;
        pinnedBytes_ += entry.sizeBytes;
        pinned_.push_back(place);
    }
    entry.lastFrame = frameIndex;
    const bool isNewDemand = isDemand && entry.demandedFrame != frameIndex;
    if (isDemand) entry.demandedFrame = frameIndex;
    return Used{entry.sizeBytes, isNewDemand};
}

void LruPages::unpin(PageId page) {
    const uint32_t place = places_.at(page);
    Entry& entry = entries_[place];
    if (!entry.isPinned) return;
    entry.isPinned = false;
    pinnedBytes_ -= entry.sizeBytes;
    addEvictable(place);
    std::erase(pinned_, place);
}

void LruPages::unpinAll() {
    for (const uint32_t place : pinned_) {
        entries_[place].isPinned = false;
        addEvictable(place);
    }
    pinned_.clear();
    pinnedBytes_ = 0;
}

void LruPages::erase(PageId page) {
    const auto found = places_.find(page);
    assert(found != places_.end() && !entries_[found->second].isPinned);
    Entry& entry = entries_[found->second];
    usedBytes_ -= entry.sizeBytes;
    removeEvictable(entry);
    entry = {.lastFrame = kAnyFrame};  // of no age
    freePlaces_.push_back(found->second);
    places_.erase(found);
}

void LruPages::addEvictable(uint32_t place) {
    Age& age = ages_[entries_[place].lastFrame];
    age.bytes += entries_[place].sizeBytes;
    ++age.count;
    age.listed.push_back(place);
    age.isSorted = false;
}

// The entry is still as it was: if the list is pruned now, it stays on it once more.
void LruPages::removeEvictable(const Entry& entry) {
    const auto found = ages_.find(entry.lastFrame);
    Age& age = found->second;
    age.bytes -= entry.sizeBytes;
    if (--age.count == 0) {
        ages_.erase(found);
    } else if (age.listed.size() > 2 * age.count + kMinPruned) {
        prune(age, found->first);
    }
}

void LruPages::prune(Age& age, uint64_t frame) const {
    std::erase_if(age.listed, [&](uint32_t place) { return !isOfAge(place, frame); });
    if (age.listed.size() > age.count + 1) sort(age, frame);  // listed twice: left and came back
}

void LruPages::sort(Age& age, uint64_t frame) const {
    std::erase_if(age.listed, [&](uint32_t place) { return !isOfAge(place, frame); });
    std::sort(age.listed.begin(), age.listed.end(),
              [this](uint32_t a, uint32_t b) { return entries_[a].page < entries_[b].page; });
    age.listed.erase(std::unique(age.listed.begin(), age.listed.end()), age.listed.end());
    age.isSorted = true;
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
    if (ages_.empty() || ages_.begin()->first >= beforeFrame) return false;
    const uint64_t frame = ages_.begin()->first;
    Age& age = ages_.begin()->second;
    if (!age.isSorted) sort(age, frame);
    while (!isOfAge(age.listed.back(), frame)) age.listed.pop_back();
    const PageId page = entries_[age.listed.back()].page;
    erase(page);
    evicted.push_back(page);
    return true;
}

bool LruPages::hasRoom(uint64_t neededBytes, uint64_t beforeFrame) const {
    uint64_t heldBytes = pinnedBytes_ + reservedBytes_;
    for (auto age = ages_.lower_bound(beforeFrame); age != ages_.end(); ++age) {
        heldBytes += age->second.bytes;
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
