#include "ooc/base/hash.h"

#define XXH_INLINE_ALL  // items are a few dozen bytes: a call each would cost more than the hash
#include <xxhash.h>

namespace pagoda {

uint64_t hash64(std::span<const std::byte> bytes, uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

void OrderFreeSum::add(std::span<const std::byte> item) {
    const XXH128_hash_t hash = XXH3_128bits(item.data(), item.size());
    add(OrderFreeSum{.low = hash.low64, .high = hash.high64});
}

void OrderFreeSum::add(const OrderFreeSum& other) {
    low += other.low;
    high += other.high + (low < other.low ? 1 : 0);
}

}  // namespace pagoda
