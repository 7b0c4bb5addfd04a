// load_queue.h: reads and decodes what it is sent, away from the render thread. A seam: threads
// (thread_loads.h), a simulated disk (disk_loads.h), scripts in tests. The render thread alone
// calls it; nothing here throws for what is read.
#pragma once

#include "cache/page_source.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pagoda::cache {

// One page or one index block.
struct LoadItem {
    uint64_t ticket = 0;  // comes back with the result; unique
    uint32_t database = 0;
    ByteRange range;
    bool isBlock = false;
    uint32_t block = 0;      // of an index block
    ooc::NodeRecord node{};  // of a page
};

struct LoadResult {
    uint64_t ticket = 0;
    std::optional<ooc::Page> page;
    std::optional<ooc::IndexBlock> block;
    std::string fault;                   // why there is neither
    ooc::Codec codec = ooc::Codec::Raw;  // of the page
    double decodeS = 0;                  // that decoding it took
};

class LoadQueue {
public:
    virtual ~LoadQueue() = default;
    // One read from the first item's begin to the last one's end (>= 1 item, one database, by
    // offset), then every item decoded.
    virtual void send(std::vector<LoadItem> items) = 0;
    // Appends what has arrived since the last call. Never blocks on a disk.
    virtual void collect(std::vector<LoadResult>& arrived) = 0;
    // Blocks until collect() has something to give. False when nothing is on its way.
    [[nodiscard]] virtual bool waitForArrival() = 0;
    // Reads that keep the disk busy: sent and not finished. Finished ones that wait for collect()
    // may count too.
    [[nodiscard]] virtual size_t readsInFlight() const = 0;
};

}  // namespace pagoda::cache
