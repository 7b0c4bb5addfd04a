#include "cache/arena.h"

#include <cassert>
#include <iterator>

namespace pagoda::cache {

Arena::Arena(uint64_t capacityBytes, uint64_t granuleBytes)
    : capacityBytes_(capacityBytes / granuleBytes * granuleBytes), granuleBytes_(granuleBytes) {
    if (capacityBytes_ > 0) addGap(0, capacityBytes_);
}

uint64_t Arena::roundedUp(uint64_t sizeBytes) const {
    return (sizeBytes + granuleBytes_ - 1) / granuleBytes_ * granuleBytes_;
}

std::optional<uint64_t> Arena::allocate(uint64_t sizeBytes) {
    assert(sizeBytes > 0);
    const uint64_t needed = roundedUp(sizeBytes);
    const auto fit = gapsBySize_.lower_bound({needed, 0});
    if (fit == gapsBySize_.end()) return std::nullopt;
    const auto [gapBytes, offset] = *fit;
    removeGap(gaps_.find(offset));
    if (gapBytes > needed) addGap(offset + needed, gapBytes - needed);
    used_.emplace(offset, needed);
    usedBytes_ += needed;
    return offset;
}

void Arena::free(uint64_t offset) {
    const auto range = used_.find(offset);
    assert(range != used_.end());
    uint64_t begin = offset, sizeBytes = range->second;
    usedBytes_ -= sizeBytes;
    used_.erase(range);
    const auto next = gaps_.upper_bound(begin);
    if (next != gaps_.end() && next->first == begin + sizeBytes) {
        sizeBytes += next->second;
        removeGap(next);
    }
    const auto after = gaps_.lower_bound(begin);
    if (after != gaps_.begin()) {
        const auto previous = std::prev(after);
        if (previous->first + previous->second == begin) {
            begin = previous->first;
            sizeBytes += previous->second;
            removeGap(previous);
        }
    }
    addGap(begin, sizeBytes);
}

uint64_t Arena::largestGapBytes() const {
    return gapsBySize_.empty() ? 0 : gapsBySize_.rbegin()->first;
}

void Arena::addGap(uint64_t offset, uint64_t sizeBytes) {
    gaps_.emplace(offset, sizeBytes);
    gapsBySize_.emplace(sizeBytes, offset);
}

void Arena::removeGap(std::map<uint64_t, uint64_t>::iterator gap) {
    gapsBySize_.erase({gap->second, gap->first});
    gaps_.erase(gap);
}

}  // namespace pagoda::cache
