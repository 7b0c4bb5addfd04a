// page_source.h: where pages and index blocks come from. A seam: a database on disk now; simulated
// disks and byte ranges over HTTP are one more source each. Results are values, so that a fault
// costs that page alone; nothing here throws for what a file holds.
#pragma once

#include "ooc/store/database.h"

#include <cstdint>

namespace pagoda::cache {

class PageSource {
public:
    virtual ~PageSource() = default;
    // Reads, checks and decodes a node's page. May block.
    [[nodiscard]] virtual ooc::Loaded<ooc::Page> loadPage(const ooc::NodeRecord& node) = 0;
    // Reads one block of the index. May block.
    [[nodiscard]] virtual ooc::Loaded<ooc::IndexBlock> loadBlock(uint32_t block) = 0;
};

// A database's own file. The database outlives it.
class DatabaseSource final : public PageSource {
public:
    explicit DatabaseSource(const ooc::Database& database) : database_(database) {}
    ooc::Loaded<ooc::Page> loadPage(const ooc::NodeRecord& node) override {
        return database_.readPage(node);
    }
    ooc::Loaded<ooc::IndexBlock> loadBlock(uint32_t block) override {
        return database_.readBlock(block);
    }

private:
    const ooc::Database& database_;
};

}  // namespace pagoda::cache
