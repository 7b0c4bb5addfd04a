// gpu_pages.h: what the cache asks of the memory that pages are drawn from. viewer/ implements it
// with GL buffers, hlod/raster/ with plain memory, tests with a counter.
#pragma once

#include "cache/page_id.h"
#include "ooc/codecs/page_codec.h"
#include "ooc/store/records.h"

#include <cstdint>
#include <string>

namespace pagoda::cache {

// How a page lies in GPU memory, whoever keeps it: vertices, 16-bit indices padded to a word, then
// an octahedral normal a triangle, unless every vertex has one. Zippers follow the page's own
// vertices and triangles.
struct GpuPageLayout {
    static constexpr uint64_t kVertexBytes = 20;
    static constexpr uint64_t kMaxVertices = 65536;  // of a 16-bit index
    // A range starts at a whole vertex and a whole word, and gaps are never shorter than this.
    static constexpr uint64_t kGranuleBytes = 64 * kVertexBytes;

    uint64_t vertices = 0, indices = 0, faceNormals = 0;

    [[nodiscard]] uint64_t vertexBytes() const { return vertices * kVertexBytes; }
    [[nodiscard]] uint64_t indexBytes() const { return (indices * sizeof(uint16_t) + 3) / 4 * 4; }
    [[nodiscard]] uint64_t bytes() const {
        return vertexBytes() + indexBytes() + faceNormals * sizeof(uint32_t);
    }
    [[nodiscard]] uint64_t sizeBytes() const;  // whole granules, at least one
};
[[nodiscard]] GpuPageLayout gpuLayoutOf(const ooc::Page& page);
// As far as the record tells: without zippers, and with normals for all triangles.
[[nodiscard]] GpuPageLayout gpuLayoutOf(const ooc::NodeRecord& node);

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
