// gpu_pages.h: what the cache asks of the memory that pages are drawn from. viewer/ implements it
// with GL buffers, hlod/raster/ with plain memory, tests with a counter.
#pragma once

#include "cache/page_id.h"
#include "ooc/codecs/page_codec.h"
#include "ooc/store/records.h"

#include <cstdint>
#include <string>

namespace pagoda::cache {

class GpuPages {
public:
    enum class Upload {
        Done,
        NoRoom,   // gaps are too short, even joined: evict more and ask again
        Refused,  // this page can never be drawn (too many vertices for an index)
    };

    virtual ~GpuPages() = default;
    // Bytes that upload() would take for this page; > 0.
    [[nodiscard]] virtual uint64_t sizeBytes(const ooc::Page& page) const = 0;
    // The same, foretold from the node's record: exact but for zippers.
    [[nodiscard]] virtual uint64_t sizeBytes(const ooc::NodeRecord& node) const = 0;
    [[nodiscard]] virtual Upload upload(PageId id, const ooc::Page& page) = 0;
    // The page was uploaded and is not drawn in this frame.
    virtual void drop(PageId id) = 0;
};

}  // namespace pagoda::cache
