#include "viewer/mesh_store.h"

#include "viewer/gl_context.h"
#include "viewer/node_program.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cassert>
#include <cstring>

namespace pagoda::viewer {
namespace {

// A range starts at a whole vertex and a whole index, and gaps are never shorter than this.
constexpr uint64_t kGranuleBytes = 64 * sizeof(GpuVertex);
constexpr uint64_t kMaxBufferBytes = (uint64_t{4} << 30) - (uint64_t{1} << 20);
constexpr size_t kMaxVertices = 65536;  // of a 16-bit index

struct Counts {
    size_t vertices = 0, indices = 0;
};

Counts countOf(const ooc::Page& page) {
    Counts counts{page.mesh.positions.size(), page.mesh.indices.size()};
    for (const ooc::Zipper& zipper : page.zippers) {
        counts.vertices += zipper.positions.size();
        counts.indices += zipper.indices.size();
    }
    return counts;
}

uint64_t bytesOf(const Counts& counts) {
    return counts.vertices * sizeof(GpuVertex) + counts.indices * sizeof(uint16_t);
}

// Zippers have no colours of their own: the mean of the page's.
uint32_t meanColour(const ooc::PageMesh& mesh) {
    if (mesh.colours.empty()) return mesh.constantColour;
    uint64_t sums[4] = {};
    for (const uint32_t colour : mesh.colours) {
        for (size_t c = 0; c < 4; ++c) sums[c] += (colour >> (8 * c)) & 255u;
    }
    uint32_t mean = 0;
    for (size_t c = 0; c < 4; ++c) {
        mean |= static_cast<uint32_t>(sums[c] / mesh.colours.size()) << (8 * c);
    }
    return mean;
}

GpuVertex makeVertex(const Vec3i& position, const Vec3i& origin, uint32_t colour,
                     ooc::OctNormal normal) {
    // Differences of lattice points in [0, 2^30] fit.
    return {position.x - origin.x,
            position.y - origin.y,
            position.z - origin.z,
            colour,
            normal.u,
            normal.v,
            0};
}

class Packer {
public:
    Packer(std::vector<std::byte>& bytes, const Counts& counts, const Vec3i& origin)
        : vertexCount_(counts.vertices), origin_(origin), bytes_(bytes) {
        bytes_.resize(bytesOf(counts));
    }
    void addVertex(const Vec3i& position, uint32_t colour, ooc::OctNormal normal) {
        const GpuVertex vertex = makeVertex(position, origin_, colour, normal);
        std::memcpy(bytes_.data() + addedVertices_++ * sizeof vertex, &vertex, sizeof vertex);
    }
    void addIndices(const std::vector<uint32_t>& indices, size_t firstVertex) {
        std::byte* out =
            bytes_.data() + vertexCount_ * sizeof(GpuVertex) + addedIndices_ * sizeof(uint16_t);
        for (const uint32_t index : indices) {
            const auto small = static_cast<uint16_t>(firstVertex + index);
            std::memcpy(out, &small, sizeof small);
            out += sizeof small;
        }
        addedIndices_ += indices.size();
    }
    [[nodiscard]] size_t addedVertices() const { return addedVertices_; }

private:
    size_t vertexCount_, addedVertices_ = 0, addedIndices_ = 0;
    Vec3i origin_;
    std::vector<std::byte>& bytes_;
};

void keepTranslucent(const ooc::PageMesh& mesh, GpuPage& page) {
    const size_t first = size_t{3} * mesh.opaqueTriangleCount();
    for (size_t i = first; i + 2 < mesh.indices.size(); i += 3) {
        Vec3d sum(0.0);
        for (size_t corner = 0; corner < 3; ++corner) {
            const uint32_t index = mesh.indices[i + corner];
            page.translucentIndices.push_back(static_cast<uint16_t>(index));
            sum += Vec3d(mesh.positions[index] - page.origin);
        }
        page.translucentCentroids.push_back(Vec3f(sum / 3.0));
    }
}

GpuPage pack(const ooc::Page& source, const Counts& counts, std::vector<std::byte>& staging) {
    const ooc::PageMesh& mesh = source.mesh;
    GpuPage page;
    page.origin = mesh.positions.empty() ? Vec3i(0) : mesh.box().min;
    page.meshTriangles = mesh.triangleCount();
    page.opaqueTriangles = mesh.opaqueTriangleCount();
    Packer packer(staging, counts, page.origin);
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        packer.addVertex(mesh.positions[i],
                         mesh.colours.empty() ? mesh.constantColour : mesh.colours[i],
                         mesh.normals.empty() ? ooc::OctNormal{} : mesh.normals[i]);
    }
    packer.addIndices(mesh.indices, 0);
    uint32_t firstTriangle = page.meshTriangles;
    const uint32_t stripColour = source.zippers.empty() ? 0 : meanColour(mesh);
    for (const ooc::Zipper& zipper : source.zippers) {
        const size_t firstVertex = packer.addedVertices();
        for (const Vec3i& position : zipper.positions) packer.addVertex(position, stripColour, {});
        packer.addIndices(zipper.indices, firstVertex);
        const auto count = static_cast<uint32_t>(zipper.indices.size() / 3);
        page.zippers.push_back({zipper.neighbour, firstTriangle, count});
        firstTriangle += count;
    }
    keepTranslucent(mesh, page);
    return page;
}

}  // namespace

MeshStore::MeshStore(uint64_t budgetBytes)
    : arena_(std::min(budgetBytes, kMaxBufferBytes), kGranuleBytes), buffer_(makeBuffer()) {
    glNamedBufferStorage(buffer_.id(), static_cast<GLsizeiptr>(arena_.capacityBytes()), nullptr,
                         GL_DYNAMIC_STORAGE_BIT);
    throwOnGlError("the memory for pages");
}

uint64_t MeshStore::sizeBytes(const ooc::Page& page) const {
    return std::max(arena_.roundedUp(bytesOf(countOf(page))), kGranuleBytes);
}

MeshStore::Upload MeshStore::upload(cache::PageId id, const ooc::Page& page) {
    const Counts counts = countOf(page);
    if (counts.vertices > kMaxVertices) return Upload::Refused;
    const auto offset = arena_.allocate(sizeBytes(page));
    if (!offset) return Upload::NoRoom;
    GpuPage packed = pack(page, counts, staging_);
    packed.baseVertex = static_cast<uint32_t>(*offset / sizeof(GpuVertex));
    packed.firstIndex =
        static_cast<uint32_t>((*offset + counts.vertices * sizeof(GpuVertex)) / sizeof(uint16_t));
    if (!staging_.empty()) {
        glNamedBufferSubData(buffer_.id(), static_cast<GLintptr>(*offset),
                             static_cast<GLsizeiptr>(staging_.size()), staging_.data());
    }
    pages_.emplace(id, Entry{*offset, std::move(packed)});
    return Upload::Done;
}

void MeshStore::drop(cache::PageId id) {
    const auto found = pages_.find(id);
    assert(found != pages_.end());
    arena_.free(found->second.offset);
    pages_.erase(found);
}

const GpuPage& MeshStore::page(cache::PageId id) const {
    return pages_.at(id).page;
}

}  // namespace pagoda::viewer
