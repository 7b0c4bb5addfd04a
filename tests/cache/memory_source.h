// memory_source.h: a file in memory whose bytes are known, with ranges that cannot be read. A page
// decodes only from exactly the bytes of its range.
#pragma once

#include "cache/page_source.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace pagoda::cache::test {

class MemorySource final : public PageSource {
public:
    explicit MemorySource(uint64_t bytes) : bytes_(bytes) {}

    // Any byte: its place in the file decides.
    static std::byte byteAt(uint64_t offset) {
        return static_cast<std::byte>((offset * 0x9E3779B97F4A7C15ull) >> 56);
    }
    std::string read(uint64_t offset, std::span<std::byte> out) const override {
        ++reads;
        {
            std::unique_lock lock(gateMutex_);
            gateOpened_.wait(lock, [this] { return isOpen_; });
        }
        if (offset > bytes_ || out.size() > bytes_ - offset) return "beyond the end";
        for (const ByteRange& bad : unreadable) {
            if (bad.offset < offset + out.size() && offset < bad.end()) return "bad sector";
        }
        for (size_t i = 0; i < out.size(); ++i) out[i] = byteAt(offset + i);
        return {};
    }
    ooc::Loaded<ooc::Page> decodePage(const ooc::NodeRecord& node,
                                      std::span<const std::byte> bytes) const override {
        if (std::string fault = check(pageRange(node), bytes); !fault.empty()) return {{}, fault};
        if (broken.contains(node.id.value)) return {{}, "checksum differs"};
        if (greedy.contains(node.id.value)) throw std::length_error("vector");
        ooc::Page page;
        page.mesh.positions.resize(node.vertexCount);
        return {std::move(page), {}};
    }
    uint32_t blockCount() const override { return static_cast<uint32_t>(blocks.size()); }
    ByteRange blockRange(uint32_t block) const override { return blocks.at(block); }
    ooc::Loaded<ooc::IndexBlock> decodeBlock(uint32_t block,
                                             std::span<const std::byte> bytes) const override {
        if (std::string fault = check(blocks.at(block), bytes); !fault.empty()) {
            return {{}, fault};
        }
        return {ooc::IndexBlock{std::vector<ooc::NodeRecord>(block + 1)}, {}};
    }
    // Reads that have begun wait while it is closed.
    void setGate(bool isOpen) {
        {
            const std::lock_guard lock(gateMutex_);
            isOpen_ = isOpen;
        }
        gateOpened_.notify_all();
    }

    std::vector<ByteRange> unreadable;
    std::vector<ByteRange> blocks;
    std::set<uint64_t> broken, greedy;  // nodes whose pages do not decode; that throw
    mutable std::atomic<int> reads = 0;

private:
    static std::string check(const ByteRange& range, std::span<const std::byte> bytes) {
        if (bytes.size() != range.bytes) return "wrong length";
        for (size_t i = 0; i < bytes.size(); ++i) {
            if (bytes[i] != byteAt(range.offset + i)) return "wrong bytes";
        }
        return {};
    }

    uint64_t bytes_;
    mutable std::mutex gateMutex_;
    mutable std::condition_variable gateOpened_;
    bool isOpen_ = true;
};

}  // namespace pagoda::cache::test
