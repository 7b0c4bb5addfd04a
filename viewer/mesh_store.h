// mesh_store.h: pages in GPU memory: one buffer of fixed size, in which each page has one range
// with its vertices and 16-bit indices. Where gaps are too short for a page but long enough
// together, ranges are moved: memory does not fragment. Implements what cache/ asks of GPU memory.
// Also keeps, in host memory, what a translucent page needs to be sorted each frame, and which
// triangles are whose: where an object is hidden, the rest of a page is drawn range by range, so
// that hiding needs nothing of shaders or GPU memory. No budget counts that: 12 bytes for each run
// of triangles of one object, 18 for each translucent triangle, of what is in GPU memory. Render
// thread only, context current.
#pragma once

#include "cache/arena.h"
#include "cache/gpu_pages.h"
#include "ooc/store/object_tree.h"
#include "viewer/gl_names.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace pagoda::viewer {

// Where a page lies, in units that draw calls take.
struct GpuPage {
    size_t chunk = 0;
    Vec3i origin{0};  // lattice point that its vertices are relative to
    uint32_t baseVertex = 0;
    uint32_t firstIndex = 0;  // opaque triangles first, then translucent ones, then zippers
    uint32_t firstNormal = kNoNormals;  // 32-bit word in the chunk: triangle 0's normal
    uint32_t opaqueTriangles = 0;
    uint32_t meshTriangles = 0;
    static constexpr uint32_t kNoNormals = UINT32_MAX;

    struct Strip {
        uint64_t neighbour = 0;  // NodeId::value
        uint32_t firstTriangle = 0, triangleCount = 0;
    };
    std::vector<Strip> zippers;

    // Triangles in turn by object, and which of them are drawn while one of these is hidden.
    struct TriangleRange {
        uint32_t first = 0, count = 0;
    };
    std::vector<ooc::MeshRun> runs;
    bool hasHidden = false;
    std::vector<TriangleRange> shown;  // ascending, opaque and translucent ones apart

    // Translucent triangles: corners as in the page, centroids in steps from the origin.
    std::vector<uint16_t> translucentIndices;
    std::vector<Vec3f> translucentCentroids;
};

class MeshStore final : public cache::GpuPages {
public:
    // Chunks together never exceed `budgetBytes`; the last one is what the others leave.
    explicit MeshStore(uint64_t budgetBytes) : budgetBytes_(budgetBytes) {}

    uint64_t sizeBytes(const ooc::Page& page) const override;
    uint64_t sizeBytes(const ooc::NodeRecord& node) const override;
    Upload upload(cache::PageId id, const ooc::Page& page) override;
    void drop(cache::PageId id) override;

    // Null, or an empty set: all are drawn. Costs a look at every page when it is another one.
    void setHidden(std::shared_ptr<const ooc::ObjectSet> hidden);

    // The page was uploaded (asserted). Valid until it is dropped.
    [[nodiscard]] const GpuPage& page(cache::PageId id) const;
    [[nodiscard]] bool contains(cache::PageId id) const { return pages_.contains(id); }
    [[nodiscard]] uint64_t usedBytes() const;  // of all pages; never above budget
    [[nodiscard]] GlId buffer(size_t chunk) const { return chunks_[chunk].buffer.id(); }
    // The chunk's 32-bit words as a buffer texture of two signed 16-bit numbers each (RG16I).
    [[nodiscard]] GlId words(size_t chunk) const { return chunks_[chunk].words.id(); }

private:
    struct Entry {
        uint64_t offset = 0, bytes = 0;
        GpuPage page;
    };
    struct Chunk {
        cache::Arena arena;
        GlBuffer buffer;
        GlTexture words;
    };
    struct Place {
        size_t chunk;
        uint64_t offset;
    };
    [[nodiscard]] std::optional<Place> allocate(uint64_t sizeBytes);
    // Closes the gaps of the chunk with the most free bytes. False when they are not enough.
    [[nodiscard]] bool compactFor(uint64_t sizeBytes);
    void compact(size_t chunk);
    void move(Entry& entry, uint64_t toOffset);

    void choose(GpuPage& page) const;

    uint64_t budgetBytes_, chunkBytes_ = 0;
    std::vector<Chunk> chunks_;
    std::unordered_map<cache::PageId, Entry, cache::PageIdHash> pages_;
    std::vector<std::byte> staging_;
    std::shared_ptr<const ooc::ObjectSet> hidden_;
};

}  // namespace pagoda::viewer
