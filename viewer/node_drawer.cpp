#include "viewer/node_drawer.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace pagoda::viewer {
namespace {

template <typename T>
void fill(GlId buffer, const std::vector<T>& items) {
    glNamedBufferData(buffer, static_cast<GLsizeiptr>(items.size() * sizeof(T)), items.data(),
                      GL_STREAM_DRAW);
}

}  // namespace

NodeDrawer::NodeDrawer(const MeshStore& store)
    : store_(store),
      array_(makeNodeVertexArray()),
      commandBuffer_(makeBuffer()),
      instanceBuffer_(makeBuffer()),
      sortedBuffer_(makeBuffer()) {
    glVertexArrayVertexBuffer(array_.id(), 1, instanceBuffer_.id(), 0, sizeof(DrawInstance));
}

void NodeDrawer::bind(const NodeProgram& program, const LatticeView& view) {
    view_ = view;
    rebind(program);
}

void NodeDrawer::rebind(const NodeProgram& program) {
    glUseProgram(program.id());
    glBindVertexArray(array_.id());
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commandBuffer_.id());
}

uint64_t NodeDrawer::drawOpaque(std::span<const DrawItem> items) {
    uint64_t triangles = 0;
    for (const DrawItem& item : items) {
        triangles += addOpaque(store_.page(item.page), item);
    }
    submit();
    return triangles;
}

uint32_t NodeDrawer::addOpaque(const GpuPage& page, const DrawItem& item) {
    if (!page.hasHidden) {
        add(page, {page.firstIndex, page.opaqueTriangles, 0, page.firstNormal}, item);
        return page.opaqueTriangles;
    }
    uint32_t triangles = 0;
    for (const GpuPage::TriangleRange& range : page.shown) {
        if (range.first >= page.opaqueTriangles) break;
        const uint32_t firstNormal = page.firstNormal == GpuPage::kNoNormals
                                         ? GpuPage::kNoNormals
                                         : page.firstNormal + range.first;
        add(page, {page.firstIndex + 3 * range.first, range.count, range.first, firstNormal}, item);
        triangles += range.count;
    }
    return triangles;
}

uint64_t NodeDrawer::drawZippers(std::span<const DrawItem> items,
                                 const std::function<bool(cache::PageId)>& isRefined,
                                 uint64_t& stripCount) {
    uint64_t triangles = 0;
    for (const DrawItem& item : items) {
        const GpuPage& page = store_.page(item.page);
        if (page.hasHidden && page.shown.empty()) continue;
        for (const GpuPage::Strip& strip : page.zippers) {
            if (isRefined({item.page.database, ooc::NodeId{strip.neighbour}})) continue;
            const uint32_t firstNormal =
                page.firstNormal + strip.firstTriangle;  // pages with strips have them
            add(page,
                {page.firstIndex + 3 * strip.firstTriangle, strip.triangleCount,
                 strip.firstTriangle, firstNormal},
                item);
            triangles += strip.triangleCount;
            ++stripCount;
        }
    }
    submit();
    return triangles;
}

uint64_t NodeDrawer::drawTranslucent(std::span<const DrawItem> items) {
    uint64_t triangles = 0;
    sortedIndices_.clear();
    for (const DrawItem& item : items) {
        const GpuPage& page = store_.page(item.page);
        const auto firstIndex = static_cast<uint32_t>(sortedIndices_.size());
        const uint32_t count = appendSorted(page);
        add(page, {firstIndex, count, 0, GpuPage::kNoNormals}, item);
        triangles += count;
    }
    if (!sortedIndices_.empty()) fill(sortedBuffer_.id(), sortedIndices_);
    submit(sortedBuffer_.id());
    return triangles;
}

uint32_t NodeDrawer::appendSorted(const GpuPage& page) {
    const Vec3f eye = view_.eye - Vec3f(view_.offsetOf(page.origin));
    order_.clear();
    const auto addRange = [&](uint32_t first, uint32_t count) {
        for (uint32_t i = first; i < first + count; ++i) {
            order_.emplace_back(-glm::dot(view_.rowW, page.translucentCentroids[i] - eye), i);
        }
    };
    if (page.hasHidden) {
        for (const GpuPage::TriangleRange& range : page.shown) {
            if (range.first < page.opaqueTriangles) continue;
            addRange(range.first - page.opaqueTriangles, range.count);
        }
    } else {
        addRange(0, static_cast<uint32_t>(page.translucentCentroids.size()));
    }
    std::sort(order_.begin(), order_.end());  // farthest first, then by number: a total order
    for (const auto& [depth, triangle] : order_) {
        for (uint32_t corner = 0; corner < 3; ++corner) {
            sortedIndices_.push_back(page.translucentIndices[3 * triangle + corner]);
        }
    }
    return static_cast<uint32_t>(order_.size());
}

void NodeDrawer::add(const GpuPage& page, const Range& range, const DrawItem& item) {
    if (range.triangleCount == 0) return;
    const auto instance = static_cast<uint32_t>(instances_.size());
    commands_.push_back({3 * range.triangleCount, 1, range.firstIndex,
                         static_cast<int32_t>(page.baseVertex), instance});
    instances_.push_back({view_.offsetOf(page.origin), item.nodeOrdinal, range.firstTriangle,
                          range.firstNormal, item.tint});
    chunks_.push_back(page.chunk);
}

void NodeDrawer::submit(GlId indexBuffer) {
    if (!commands_.empty()) {
        fill(commandBuffer_.id(), commands_);
        fill(instanceBuffer_.id(), instances_);
    }
    for (size_t begin = 0, end = 0; begin < commands_.size(); begin = end) {
        while (end < commands_.size() && chunks_[end] == chunks_[begin]) ++end;
        const GlId chunk = store_.buffer(chunks_[begin]);
        glVertexArrayVertexBuffer(array_.id(), 0, chunk, 0, sizeof(GpuVertex));
        glVertexArrayElementBuffer(array_.id(), indexBuffer != 0 ? indexBuffer : chunk);
        glBindTextureUnit(kNormalsUnit, store_.words(chunks_[begin]));
        glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT,
                                    reinterpret_cast<const void*>(begin * sizeof(Command)),
                                    static_cast<GLsizei>(end - begin), sizeof(Command));
    }
    commands_.clear();
    instances_.clear();
    chunks_.clear();
}

}  // namespace pagoda::viewer
