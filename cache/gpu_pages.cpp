#include "cache/gpu_pages.h"

#include <algorithm>

namespace pagoda::cache {
namespace {

bool needsFaceNormals(const ooc::Page& page) {
    const std::vector<ooc::OctNormal>& normals = page.mesh.normals;
    return normals.empty() || !page.zippers.empty() ||
           std::any_of(normals.begin(), normals.end(), [](ooc::OctNormal n) { return n.isNone(); });
}

}  // namespace

uint64_t GpuPageLayout::sizeBytes() const {
    const uint64_t granules = (bytes() + kGranuleBytes - 1) / kGranuleBytes;
    return std::max(granules, uint64_t{1}) * kGranuleBytes;
}

GpuPageLayout gpuLayoutOf(const ooc::Page& page) {
    GpuPageLayout layout{page.mesh.positions.size(), page.mesh.indices.size(), 0};
    for (const ooc::Zipper& zipper : page.zippers) {
        layout.vertices += zipper.positions.size();
        layout.indices += zipper.indices.size();
    }
    if (needsFaceNormals(page)) layout.faceNormals = layout.indices / 3;
    return layout;
}

GpuPageLayout gpuLayoutOf(const ooc::NodeRecord& node) {
    return {node.vertexCount, uint64_t{3} * node.triangleCount, node.triangleCount};
}

}  // namespace pagoda::cache
