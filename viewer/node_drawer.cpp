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
        const GpuPage& page = store_.page(item.page);
        add(page, {page.firstIndex, page.opaqueTriangles, 0, page.firstNormal}, item);
        triangles += page.opaqueTriangles;
    }
    submit();
    return triangles;
}

uint64_t NodeDrawer::drawZippers(std::span<const DrawItem> items,
                                 const std::function<bool(cache::PageId)>& isRefined,
                                 uint64_t& stripCount) {
    uint64_t triangles = 0;
    for (const DrawItem& item : items) {
        const GpuPage& page = store_.page(item.page);
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
        const auto count = static_cast<uint32_t>(page.translucentCentroids.size());
        add(page, {static_cast<uint32_t>(sortedIndices_.size()), count, 0, GpuPage::kNoNormals},
            item);
        appendSorted(page);
        triangles += count;
    }
    if (!sortedIndices_.empty()) fill(sortedBuffer_.id(), sortedIndices_);
    submit(sortedBuffer_.id());
    return triangles;
}

void NodeDrawer::appendSorted(const GpuPage& page) {
    const Vec3f eye = view_.eye - Vec3f(view_.offsetOf(page.origin));
    order_.clear();
    for (uint32_t i = 0; i < page.translucentCentroids.size(); ++i) {
        order_.emplace_back(-glm::dot(view_.rowW, page.translucentCentroids[i] - eye), i);
    }
    std::sort(order_.begin(), order_.end());  // farthest first, then by number: a total order
    for (const auto& [depth, triangle] : order_) {
        for (uint32_t corner = 0; corner < 3; ++corner) {
            sortedIndices_.push_back(page.translucentIndices[3 * triangle + corner]);
        }
    }
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
