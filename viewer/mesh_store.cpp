#include "viewer/mesh_store.h"

#include "viewer/gl_context.h"
#include "viewer/node_program.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

namespace pagoda::viewer {
namespace {

using cache::GpuPageLayout;

constexpr uint64_t kChunkBytes = uint64_t{32} << 20;
static_assert(sizeof(GpuVertex) == GpuPageLayout::kVertexBytes);

// Octahedral, 16 bits each, as GLSL's unpackSnorm2x16 reads it. From integers, so that it depends
// on neither the eye nor the size of a pixel, as screen-space derivatives would.
uint32_t faceNormal(const Vec3i& a, const Vec3i& b, const Vec3i& c) {
    const Vec3d normal = glm::cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
    const double size = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    if (!(size > 0.0)) return 0;
    double u = normal.x / size, v = normal.y / size;
    if (normal.z < 0.0) {
        const double x = u;
        u = std::copysign(1.0 - std::abs(v), x);
        v = std::copysign(1.0 - std::abs(x), v);
    }
    const auto snorm = [](double value) {
        return static_cast<uint32_t>(static_cast<uint16_t>(std::lround(value * 32767.0)));
    };
    return snorm(u) | snorm(v) << 16;
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
    Packer(std::vector<std::byte>& bytes, const GpuPageLayout& layout, const Vec3i& origin)
        : layout_(layout), origin_(origin), bytes_(bytes) {
        bytes_.assign(layout.bytes(), std::byte{0});
    }
    void addVertex(const Vec3i& position, uint32_t colour, ooc::OctNormal normal) {
        put(addedVertices_++ * sizeof(GpuVertex), makeVertex(position, origin_, colour, normal));
    }
    void addTriangles(const std::vector<Vec3i>& positions, const std::vector<uint32_t>& indices,
                      size_t firstVertex) {
        for (const uint32_t index : indices) {
            put(layout_.vertexBytes() + addedIndices_++ * sizeof(uint16_t),
                static_cast<uint16_t>(firstVertex + index));
        }
        if (layout_.faceNormals == 0) return;
        const size_t firstNormal = layout_.vertexBytes() + layout_.indexBytes();
        for (size_t i = 0; i + 2 < indices.size(); i += 3) {
            put(firstNormal + addedNormals_++ * sizeof(uint32_t),
                faceNormal(positions[indices[i]], positions[indices[i + 1]],
                           positions[indices[i + 2]]));
        }
    }
    [[nodiscard]] size_t addedVertices() const { return addedVertices_; }

private:
    template <typename T>
    void put(size_t offset, const T& value) {
        std::memcpy(bytes_.data() + offset, &value, sizeof value);
    }
    GpuPageLayout layout_;
    size_t addedVertices_ = 0, addedIndices_ = 0, addedNormals_ = 0;
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

GpuPage pack(const ooc::Page& source, const GpuPageLayout& layout,
             std::vector<std::byte>& staging) {
    const ooc::PageMesh& mesh = source.mesh;
    GpuPage page;
    page.origin = mesh.positions.empty() ? Vec3i(0) : mesh.box().min;
    page.meshTriangles = mesh.triangleCount();
    page.opaqueTriangles = mesh.opaqueTriangleCount();
    page.runs = mesh.runs;
    Packer packer(staging, layout, page.origin);
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        packer.addVertex(mesh.positions[i],
                         mesh.colours.empty() ? mesh.constantColour : mesh.colours[i],
                         mesh.normals.empty() ? ooc::OctNormal{} : mesh.normals[i]);
    }
    packer.addTriangles(mesh.positions, mesh.indices, 0);
    uint32_t firstTriangle = page.meshTriangles;
    const uint32_t stripColour = source.zippers.empty() ? 0 : meanColour(mesh);
    for (const ooc::Zipper& zipper : source.zippers) {
        const size_t firstVertex = packer.addedVertices();
        for (const Vec3i& position : zipper.positions) packer.addVertex(position, stripColour, {});
        packer.addTriangles(zipper.positions, zipper.indices, firstVertex);
        const auto count = static_cast<uint32_t>(zipper.indices.size() / 3);
        page.zippers.push_back({zipper.neighbour, firstTriangle, count});
        firstTriangle += count;
    }
    keepTranslucent(mesh, page);
    return page;
}

}  // namespace

uint64_t MeshStore::sizeBytes(const ooc::Page& page) const {
    return cache::gpuLayoutOf(page).sizeBytes();
}

uint64_t MeshStore::sizeBytes(const ooc::NodeRecord& node) const {
    return cache::gpuLayoutOf(node).sizeBytes();
}

std::optional<MeshStore::Place> MeshStore::allocate(uint64_t sizeBytes) {
    for (size_t chunk = 0; chunk < chunks_.size(); ++chunk) {
        if (const auto offset = chunks_[chunk].arena.allocate(sizeBytes))
            return Place{chunk, *offset};
    }
    const uint64_t capacity = std::min(kChunkBytes, budgetBytes_ - chunkBytes_);
    cache::Arena arena(capacity, GpuPageLayout::kGranuleBytes);
    if (arena.capacityBytes() < sizeBytes) return std::nullopt;
    GlBuffer buffer = makeBuffer();
    glNamedBufferStorage(buffer.id(), static_cast<GLsizeiptr>(arena.capacityBytes()), nullptr,
                         GL_DYNAMIC_STORAGE_BIT);
    GlTexture words = makeBufferTexture(GL_RG16I, buffer.id(), arena.capacityBytes() / 4);
    throwOnGlError("pages");
    chunkBytes_ += arena.capacityBytes();
    chunks_.push_back({std::move(arena), std::move(buffer), std::move(words)});
    return Place{chunks_.size() - 1, *chunks_.back().arena.allocate(sizeBytes)};
}

MeshStore::Upload MeshStore::upload(cache::PageId id, const ooc::Page& page) {
    const GpuPageLayout layout = cache::gpuLayoutOf(page);
    const uint64_t neededBytes = layout.sizeBytes();
    if (layout.vertices > GpuPageLayout::kMaxVertices || neededBytes > kChunkBytes)
        return Upload::Refused;
    auto place = allocate(neededBytes);
    if (!place && compactFor(neededBytes)) place = allocate(neededBytes);
    if (!place) return Upload::NoRoom;
    GpuPage packed = pack(page, layout, staging_);
    const uint64_t firstIndexByte = place->offset + layout.vertexBytes();
    packed.chunk = place->chunk;
    packed.baseVertex = static_cast<uint32_t>(place->offset / sizeof(GpuVertex));
    packed.firstIndex = static_cast<uint32_t>(firstIndexByte / sizeof(uint16_t));
    if (layout.faceNormals > 0) {
        packed.firstNormal = static_cast<uint32_t>((firstIndexByte + layout.indexBytes()) / 4);
    }
    if (!staging_.empty()) {
        glNamedBufferSubData(buffer(place->chunk), static_cast<GLintptr>(place->offset),
                             static_cast<GLsizeiptr>(staging_.size()), staging_.data());
    }
    choose(packed);
    pages_.emplace(id, Entry{place->offset, neededBytes, std::move(packed)});
    return Upload::Done;
}

void MeshStore::drop(cache::PageId id) {
    const auto found = pages_.find(id);
    assert(found != pages_.end());
    chunks_[found->second.page.chunk].arena.free(found->second.offset);
    pages_.erase(found);
}

void MeshStore::setHidden(std::shared_ptr<const ooc::ObjectSet> hidden) {
    if (hidden == hidden_) return;
    hidden_ = std::move(hidden);
    for (auto& [id, entry] : pages_) choose(entry.page);
}

void MeshStore::choose(GpuPage& page) const {
    page.hasHidden = false;
    page.shown.clear();
    if (!hidden_ || hidden_->isEmpty()) return;
    uint32_t first = 0;
    for (const ooc::MeshRun& run : page.runs) {
        const uint32_t begin = first;
        first += run.triangleCount;
        if (hidden_->contains(run.object)) {
            page.hasHidden = true;
            continue;
        }
        const bool isFollowing = !page.shown.empty() && begin != page.opaqueTriangles &&
                                 page.shown.back().first + page.shown.back().count == begin;
        if (isFollowing) {
            page.shown.back().count += run.triangleCount;
        } else {
            page.shown.push_back({begin, run.triangleCount});
        }
    }
    if (!page.hasHidden) page.shown.clear();
}

bool MeshStore::compactFor(uint64_t sizeBytes) {
    size_t best = 0;
    uint64_t mostFree = 0;
    for (size_t chunk = 0; chunk < chunks_.size(); ++chunk) {
        const cache::Arena& arena = chunks_[chunk].arena;
        const uint64_t free = arena.capacityBytes() - arena.usedBytes();
        if (free > mostFree) {
            mostFree = free;
            best = chunk;
        }
    }
    if (mostFree < sizeBytes) return false;
    compact(best);
    return true;
}

void MeshStore::compact(size_t chunk) {
    std::vector<Entry*> entries;
    for (auto& [id, entry] : pages_) {
        if (entry.page.chunk == chunk) entries.push_back(&entry);
    }
    std::sort(entries.begin(), entries.end(),
              [](const Entry* a, const Entry* b) { return a->offset < b->offset; });
    glFinish();  // llvmpipe 22.3 does not order the copies behind shaders that read from the buffer
    cache::Arena packed(chunks_[chunk].arena.capacityBytes(), GpuPageLayout::kGranuleBytes);
    for (Entry* entry : entries) move(*entry, *packed.allocate(entry->bytes));
    chunks_[chunk].arena = std::move(packed);
    throwOnGlError("moving pages");
}

// Downwards, in pieces no longer than the way: GL forbids copies that overlap within a buffer.
void MeshStore::move(Entry& entry, uint64_t toOffset) {
    const uint64_t way = entry.offset - toOffset;
    if (way == 0) return;
    const GlId id = buffer(entry.page.chunk);
    for (uint64_t done = 0; done < entry.bytes; done += way) {
        glCopyNamedBufferSubData(id, id, static_cast<GLintptr>(entry.offset + done),
                                 static_cast<GLintptr>(toOffset + done),
                                 static_cast<GLsizeiptr>(std::min(way, entry.bytes - done)));
    }
    entry.offset = toOffset;
    entry.page.baseVertex -= static_cast<uint32_t>(way / sizeof(GpuVertex));
    entry.page.firstIndex -= static_cast<uint32_t>(way / sizeof(uint16_t));
    if (entry.page.firstNormal != GpuPage::kNoNormals) {
        entry.page.firstNormal -= static_cast<uint32_t>(way / sizeof(uint32_t));
    }
}

uint64_t MeshStore::usedBytes() const {
    uint64_t bytes = 0;
    for (const Chunk& chunk : chunks_) bytes += chunk.arena.usedBytes();
    return bytes;
}

const GpuPage& MeshStore::page(cache::PageId id) const {
    return pages_.at(id).page;
}

}  // namespace pagoda::viewer
