// page_source.h: where the bytes of pages and index blocks come from, and what they mean. A seam:
// a database on disk now, byte ranges over HTTP later, scripts in tests. Results are values, so
// that a fault costs that page alone; nothing here throws for what a file holds. Every call may
// come from any thread.
#pragma once

#include "ooc/store/database.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace pagoda::cache {

struct ByteRange {
    uint64_t offset = 0, bytes = 0;
    [[nodiscard]] uint64_t end() const { return offset + bytes; }
    [[nodiscard]] bool operator==(const ByteRange&) const = default;
};

[[nodiscard]] inline ByteRange pageRange(const ooc::NodeRecord& node) {
    return {node.pageOffset, node.pageBytes};
}

class PageSource {
public:
    virtual ~PageSource() = default;
    // Fills `out` from `offset` on; may block. Empty when done, else why not.
    [[nodiscard]] virtual std::string read(uint64_t offset, std::span<std::byte> out) const = 0;
    // A node's page from its encoded bytes, checked.
    [[nodiscard]] virtual ooc::Loaded<ooc::Page> decodePage(
        const ooc::NodeRecord& node, std::span<const std::byte> bytes) const = 0;
    [[nodiscard]] virtual uint32_t blockCount() const = 0;
    [[nodiscard]] virtual ByteRange blockRange(uint32_t block) const = 0;  // block < blockCount()
    [[nodiscard]] virtual ooc::Loaded<ooc::IndexBlock> decodeBlock(
        uint32_t block, std::span<const std::byte> bytes) const = 0;
};

// A database's own file. The database outlives it.
class DatabaseSource final : public PageSource {
public:
    explicit DatabaseSource(const ooc::Database& database) : database_(database) {}
    std::string read(uint64_t offset, std::span<std::byte> out) const override;
    ooc::Loaded<ooc::Page> decodePage(const ooc::NodeRecord& node,
                                      std::span<const std::byte> bytes) const override {
        return database_.decodePage(node, bytes);
    }
    uint32_t blockCount() const override { return database_.blockCount(); }
    ByteRange blockRange(uint32_t block) const override {
        const ooc::Database::Range& range = database_.indexRanges()[block];
        return {range.offset, range.bytes};
    }
    ooc::Loaded<ooc::IndexBlock> decodeBlock(uint32_t block,
                                             std::span<const std::byte> bytes) const override {
        return database_.decodeBlock(block, bytes);
    }

private:
    const ooc::Database& database_;
};

}  // namespace pagoda::cache
