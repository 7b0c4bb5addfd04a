// software_pages.h: uploaded pages in plain memory, for the software device. Bytes are counted as
// the GL store counts them, so that budgets mean the same on both; gaps cost nothing here. Render
// thread only.
#pragma once

#include "cache/gpu_pages.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pagoda::hlod {

// What is drawn of a page: its opaque triangles.
struct SoftwareMesh {
    std::vector<Vec3i> positions;   // lattice points
    std::vector<uint32_t> indices;  // 3 a triangle
    uint64_t sizeBytes = 0;
};

class SoftwarePages final : public cache::GpuPages {
public:
    explicit SoftwarePages(uint64_t budgetBytes) : budgetBytes_(budgetBytes) {}

    uint64_t sizeBytes(const ooc::Page& page) const override;
    uint64_t sizeBytes(const ooc::NodeRecord& node) const override;
    // Refused above 65536 vertices, as a 16-bit index would have it.
    Upload upload(cache::PageId id, const ooc::Page& page) override;
    void drop(cache::PageId id) override;

    // The page was uploaded (asserted). Valid until it is dropped.
    [[nodiscard]] const SoftwareMesh& mesh(cache::PageId id) const;
    [[nodiscard]] bool contains(cache::PageId id) const { return meshes_.contains(id); }
    [[nodiscard]] uint64_t usedBytes() const noexcept { return usedBytes_; }  // never above budget
    [[nodiscard]] uint64_t budgetBytes() const noexcept { return budgetBytes_; }

private:
    uint64_t budgetBytes_, usedBytes_ = 0;
    std::unordered_map<cache::PageId, SoftwareMesh, cache::PageIdHash> meshes_;
};

}  // namespace pagoda::hlod
