// vertex_table.h: gives equal keys equal numbers, in order of first sight. Open addressing, made
// for pages of some ten thousand corners: one allocation, reused.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

namespace pagoda::hlod {

// Key: trivially copyable with operator== and a member `uint64_t hash() const`.
template <typename Key>
class VertexTable {
public:
    // For up to `capacity` different keys.
    void reset(size_t capacity) {
        const size_t slots = std::bit_ceil(capacity * 2 + 2);
        slots_.assign(slots, kEmpty);
        mask_ = slots - 1;
        keys_.clear();
        keys_.reserve(capacity);
    }
    [[nodiscard]] uint32_t add(const Key& key) {
        for (size_t slot = key.hash() & mask_;; slot = (slot + 1) & mask_) {
            if (slots_[slot] == kEmpty) {
                slots_[slot] = static_cast<uint32_t>(keys_.size());
                keys_.push_back(key);
                return slots_[slot];
            }
            if (keys_[slots_[slot]] == key) return slots_[slot];
        }
    }
    [[nodiscard]] const std::vector<Key>& keys() const noexcept { return keys_; }

private:
    static constexpr uint32_t kEmpty = std::numeric_limits<uint32_t>::max();
    std::vector<uint32_t> slots_;
    std::vector<Key> keys_;
    size_t mask_ = 0;
};

[[nodiscard]] inline uint64_t mixHash(uint64_t hash, uint64_t value) {
    hash = (hash ^ value) * 0x9E3779B97F4A7C15ull;
    return hash ^ (hash >> 29);
}

}  // namespace pagoda::hlod
