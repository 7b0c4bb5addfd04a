// mesh_store.h: pages in GPU memory: one buffer of fixed size, in which each page has one range
// with its vertices and 16-bit indices. Implements what cache/ asks of GPU memory. Also keeps, in
// host memory, what a translucent page needs to be sorted each frame. Render thread only, context
// current.
#pragma once

#include "cache/arena.h"
#include "cache/gpu_pages.h"
#include "viewer/gl_names.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pagoda::viewer {

// Where a page lies in the buffer, in units that draw calls take.
struct GpuPage {
    Vec3i origin{0};  // lattice point that its vertices are relative to
    uint32_t baseVertex = 0;
    uint32_t firstIndex = 0;  // opaque triangles first, then translucent ones, then zippers
    uint32_t opaqueTriangles = 0;
    uint32_t meshTriangles = 0;

    struct Strip {
        uint64_t neighbour = 0;  // NodeId::value
        uint32_t firstTriangle = 0, triangleCount = 0;
    };
    std::vector<Strip> zippers;

    // Translucent triangles: corners as in the page, centroids in steps from the origin.
    std::vector<uint16_t> translucentIndices;
    std::vector<Vec3f> translucentCentroids;
};

class MeshStore final : public cache::GpuPages {
public:
    // Takes all of `budgetBytes` (below 4 GiB: the limit of a GL buffer here) at once.
    explicit MeshStore(uint64_t budgetBytes);

    uint64_t sizeBytes(const ooc::Page& page) const override;
    Upload upload(cache::PageId id, const ooc::Page& page) override;
    void drop(cache::PageId id) override;

    // The page was uploaded (asserted). Valid until it is dropped.
    [[nodiscard]] const GpuPage& page(cache::PageId id) const;
    [[nodiscard]] GlId buffer() const noexcept { return buffer_.id(); }
    // What is left for pages: the budget rounded down.
    [[nodiscard]] uint64_t capacityBytes() const noexcept { return arena_.capacityBytes(); }

private:
    struct Entry {
        uint64_t offset = 0;
        GpuPage page;
    };
    cache::Arena arena_;
    GlBuffer buffer_;
    std::unordered_map<cache::PageId, Entry, cache::PageIdHash> pages_;
    std::vector<std::byte> staging_;
};

}  // namespace pagoda::viewer
