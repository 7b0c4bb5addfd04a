#include "hlod/raster/software_pages.h"

#include <cassert>
#include <utility>

namespace pagoda::hlod {

uint64_t SoftwarePages::sizeBytes(const ooc::Page& page) const {
    return cache::gpuLayoutOf(page).sizeBytes();
}

uint64_t SoftwarePages::sizeBytes(const ooc::NodeRecord& node) const {
    return cache::gpuLayoutOf(node).sizeBytes();
}

cache::GpuPages::Upload SoftwarePages::upload(cache::PageId id, const ooc::Page& page) {
    const cache::GpuPageLayout layout = cache::gpuLayoutOf(page);
    if (layout.vertices > cache::GpuPageLayout::kMaxVertices) return Upload::Refused;
    const uint64_t sizeBytes = layout.sizeBytes();
    if (sizeBytes > budgetBytes_ - usedBytes_) return Upload::NoRoom;
    const ooc::PageMesh& mesh = page.mesh;
    const auto opaqueEnd = mesh.indices.begin() + ptrdiff_t{3} * mesh.opaqueTriangleCount();
    const bool isNew =
        meshes_
            .emplace(id, SoftwareMesh{mesh.positions, {mesh.indices.begin(), opaqueEnd}, sizeBytes})
            .second;
    assert(isNew);
    static_cast<void>(isNew);
    usedBytes_ += sizeBytes;
    return Upload::Done;
}

void SoftwarePages::drop(cache::PageId id) {
    const auto found = meshes_.find(id);
    assert(found != meshes_.end());
    usedBytes_ -= found->second.sizeBytes;
    meshes_.erase(found);
}

const SoftwareMesh& SoftwarePages::mesh(cache::PageId id) const {
    const auto found = meshes_.find(id);
    assert(found != meshes_.end());
    return found->second;
}

}  // namespace pagoda::hlod
