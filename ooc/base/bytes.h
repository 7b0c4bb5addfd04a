// bytes.h: little-endian values to and from byte buffers, as all files of Pagoda have them.
// The host is little-endian (asserted at compile time), so values are copied as they are.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace pagoda {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and so are we");

// Appends values to a buffer that it owns.
class ByteWriter {
public:
    template <typename Value>
    requires std::is_arithmetic_v<Value>
    void put(Value value) { putArray(std::span<const Value>(&value, 1)); }
    template <typename Value>
    void putArray(std::span<const Value> values) {
        static_assert(std::is_trivially_copyable_v<Value>);
        putBytes(std::as_bytes(values));
    }
    void putBytes(std::span<const std::byte> bytes) {
        if (bytes.empty()) return;
        const size_t end = bytes_.size();
        bytes_.resize(end + bytes.size());
        std::memcpy(bytes_.data() + end, bytes.data(), bytes.size());
    }
    // 7 bits a byte, least first, high bit set while more follow (LEB128).
    void putVarint(uint32_t value) {
        for (; value >= 0x80u; value >>= 7) put(static_cast<uint8_t>(value | 0x80u));
        put(static_cast<uint8_t>(value));
    }
    [[nodiscard]] size_t size() const noexcept { return bytes_.size(); }
    [[nodiscard]] std::vector<std::byte> take() noexcept { return std::move(bytes_); }
    [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return bytes_; }

private:
    std::vector<std::byte> bytes_;
};

// Reads values of a borrowed buffer. Reading past the end gives zeros and isOk() turns false for
// good: read a whole record, then ask once.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <typename Value>
    requires std::is_arithmetic_v<Value>
    [[nodiscard]] Value get() {
        Value value{};
        getArray(std::span<Value>(&value, 1));
        return value;
    }
    // Fills `out`, which the caller has sized: ask remaining() before trusting a count.
    template <typename Value>
    void getArray(std::span<Value> out) {
        static_assert(std::is_trivially_copyable_v<Value>);
        const std::span<const std::byte> bytes = getBytes(out.size_bytes());
        if (!bytes.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
    }
    // The next `count` bytes, borrowed; empty when there are fewer.
    [[nodiscard]] std::span<const std::byte> getBytes(size_t count) {
        if (count > rest_.size()) {
            isOk_ = false;
            rest_ = {};
            return {};
        }
        const std::span<const std::byte> bytes = rest_.first(count);
        rest_ = rest_.subspan(count);
        return bytes;
    }
    [[nodiscard]] uint32_t getVarint() {
        uint64_t value = 0;
        for (unsigned shift = 0; shift < 35; shift += 7) {
            const auto byte = get<uint8_t>();
            value |= static_cast<uint64_t>(byte & 0x7Fu) << shift;
            if (byte < 0x80u) {
                if (value > UINT32_MAX) break;
                return static_cast<uint32_t>(value);
            }
        }
        isOk_ = false;
        return 0;
    }
    [[nodiscard]] size_t remaining() const noexcept { return rest_.size(); }
    [[nodiscard]] bool isOk() const noexcept { return isOk_; }

private:
    std::span<const std::byte> rest_;
    bool isOk_ = true;
};

}  // namespace pagoda
