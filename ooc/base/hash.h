// hash.h: checksums of bytes (XXH3), 64 bits. Not against forgery: against flipped bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace pagoda {

[[nodiscard]] uint64_t hash64(std::span<const std::byte> bytes, uint64_t seed = 0);

// A sum of hashes that does not depend on the order of its terms: adding the same items in any
// order, on any number of threads, gives the same value. 128 bits, so that lost and doubled items
// do not cancel by chance.
struct OrderFreeSum {
    uint64_t low = 0, high = 0;
    void add(std::span<const std::byte> item);
    void add(const OrderFreeSum& other);
    [[nodiscard]] bool operator==(const OrderFreeSum&) const = default;
};

}  // namespace pagoda
