// index_cache.h: the index blocks that have been looked at. Loaded at once for now, and kept:
// memory is proportional to what is looked at (about 120 bytes a node). The streaming run time
// requests instead, and block() then answers null until the block has arrived. One thread (the
// render thread). Pointers stay valid as long as the cache.
#pragma once

#include "cache/page_source.h"

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

namespace pagoda::cache {

struct BlockFault {
    uint32_t block = 0;
    std::string what;
};

class IndexCache {
public:
    // `source` outlives it.
    explicit IndexCache(PageSource& source) : source_(source) {}

    // Null when the block is broken (listed in faults() once, and not tried again).
    [[nodiscard]] const ooc::IndexBlock* block(uint32_t block);
    // Lists a fault that the content of a block that was read has shown.
    void reportFault(uint32_t block, std::string what);

    [[nodiscard]] const std::vector<BlockFault>& faults() const noexcept { return faults_; }
    [[nodiscard]] size_t blockCount() const noexcept { return blocks_.size(); }
    [[nodiscard]] uint64_t usedBytes() const noexcept { return usedBytes_; }

private:
    PageSource& source_;
    std::unordered_map<uint32_t, std::optional<ooc::IndexBlock>> blocks_;
    std::vector<BlockFault> faults_;
    uint64_t usedBytes_ = 0;
};

}  // namespace pagoda::cache
