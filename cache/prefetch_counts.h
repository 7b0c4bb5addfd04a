// prefetch_counts.h: what was read ahead and what came of it, by the reason it was asked for: a
// number whose meaning is the asker's own.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace pagoda::cache {

inline constexpr size_t kPrefetchReasons = 4;

// Encoded bytes.
struct PrefetchCount {
    uint64_t bytes = 0;      // arrived before any frame wanted them
    uint64_t usedBytes = 0;  // of them, wanted later and still there

    PrefetchCount& operator+=(const PrefetchCount& other) {
        bytes += other.bytes;
        usedBytes += other.usedBytes;
        return *this;
    }
    // What was counted since `before`.
    [[nodiscard]] PrefetchCount since(const PrefetchCount& before) const {
        return {bytes - before.bytes, usedBytes - before.usedBytes};
    }
};

using PrefetchCounts = std::array<PrefetchCount, kPrefetchReasons>;

[[nodiscard]] inline PrefetchCount sumOf(const PrefetchCounts& counts) {
    PrefetchCount sum;
    for (const PrefetchCount& count : counts) sum += count;
    return sum;
}

}  // namespace pagoda::cache
