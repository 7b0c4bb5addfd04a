#include "hlod/raster/software_pages.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace pagoda::hlod {
namespace {

// Of the GL store: a vertex, an index, a triangle's normal; ranges are whole granules.
constexpr uint64_t kVertexBytes = 20, kIndexBytes = 2, kNormalBytes = 4;
constexpr uint64_t kGranuleBytes = 64 * kVertexBytes;
constexpr size_t kMaxVertices = 65536;

struct Counts {
    uint64_t vertices = 0, triangles = 0;
    bool hasFaceNormals = true;
};

uint64_t granules(const Counts& counts) {
    const uint64_t indexBytes = (3 * counts.triangles * kIndexBytes + 3) / 4 * 4;
    const uint64_t normalBytes = counts.hasFaceNormals ? counts.triangles * kNormalBytes : 0;
    const uint64_t bytes = counts.vertices * kVertexBytes + indexBytes + normalBytes;
    return std::max((bytes + kGranuleBytes - 1) / kGranuleBytes, uint64_t{1}) * kGranuleBytes;
}

Counts countOf(const ooc::Page& page) {
    const std::vector<ooc::OctNormal>& normals = page.mesh.normals;
    Counts counts{page.mesh.vertexCount(), page.mesh.triangleCount(),
                  normals.empty() || !page.zippers.empty()};
    for (const ooc::OctNormal& normal : normals) {
        counts.hasFaceNormals = counts.hasFaceNormals || normal.isNone();
    }
    for (const ooc::Zipper& zipper : page.zippers) {
        counts.vertices += zipper.positions.size();
        counts.triangles += zipper.indices.size() / 3;
    }
    return counts;
}

}  // namespace

uint64_t SoftwarePages::sizeBytes(const ooc::Page& page) const {
    return granules(countOf(page));
}

uint64_t SoftwarePages::sizeBytes(const ooc::NodeRecord& node) const {
    return granules({node.vertexCount, node.triangleCount, true});
}

cache::GpuPages::Upload SoftwarePages::upload(cache::PageId id, const ooc::Page& page) {
    const Counts counts = countOf(page);
    if (counts.vertices > kMaxVertices) return Upload::Refused;
    const uint64_t sizeBytes = granules(counts);
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
