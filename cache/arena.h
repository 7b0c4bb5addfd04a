// arena.h: hands out ranges of one fixed block of memory that lives elsewhere (a GL buffer).
// Best fit, lowest offset first among equals; freed neighbours join at once. Deterministic: the
// same calls give the same offsets. Sizes are rounded up to the granule, which bounds how small a
// gap can be. One thread only.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace pagoda::cache {

class Arena {
public:
    // `capacityBytes` is rounded down to whole granules.
    Arena(uint64_t capacityBytes, uint64_t granuleBytes);

    [[nodiscard]] uint64_t roundedUp(uint64_t sizeBytes) const;
    // Offset of a free range of `sizeBytes` > 0, a multiple of the granule; nullopt when no gap is
    // long enough, although gaps together may be. O(log gaps).
    [[nodiscard]] std::optional<uint64_t> allocate(uint64_t sizeBytes);
    // Gives back what allocate() returned (asserted).
    void free(uint64_t offset);

    [[nodiscard]] uint64_t capacityBytes() const noexcept { return capacityBytes_; }
    [[nodiscard]] uint64_t usedBytes() const noexcept { return usedBytes_; }
    [[nodiscard]] uint64_t largestGapBytes() const;

private:
    void addGap(uint64_t offset, uint64_t sizeBytes);
    void removeGap(std::map<uint64_t, uint64_t>::iterator gap);

    uint64_t capacityBytes_, granuleBytes_;
    uint64_t usedBytes_ = 0;
    std::map<uint64_t, uint64_t> used_;                   // offset -> size
    std::map<uint64_t, uint64_t> gaps_;                   // offset -> size
    std::set<std::pair<uint64_t, uint64_t>> gapsBySize_;  // size, offset
};

}  // namespace pagoda::cache
