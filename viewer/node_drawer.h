// node_drawer.h: draws batches of resident nodes, each run of nodes in one chunk with one
// multi-draw call. Between bind() and the last draw call no other GL state may change. Render
// thread only.
#pragma once

#include "hlod/view/node_tree.h"
#include "viewer/mesh_store.h"
#include "viewer/node_program.h"

#include <functional>
#include <span>
#include <vector>

namespace pagoda::viewer {

struct DrawItem {
    cache::PageId page;
    uint32_t nodeOrdinal = 0;  // >= 1
    glm::u8vec4 tint{0};       // DrawInstance
};

class NodeDrawer {
public:
    // `store` outlives it.
    explicit NodeDrawer(const MeshStore& store);

    // Fixes the view for the draws that follow.
    void bind(const NodeProgram& program, const LatticeView& view);
    // Goes on with it after other programs have drawn.
    void rebind(const NodeProgram& program);

    // Triangles drawn. Items in the order given; ties at equal depth fall to the first drawn.
    uint64_t drawOpaque(std::span<const DrawItem> items);
    // The zippers of refined nodes whose neighbour `isRefined` denies. They belong to no object: a
    // page of which nothing is shown has none.
    uint64_t drawZippers(std::span<const DrawItem> items,
                         const std::function<bool(cache::PageId)>& isRefined, uint64_t& stripCount);
    // Items from back to front; within each, triangles from back to front by their centroids.
    uint64_t drawTranslucent(std::span<const DrawItem> items);

private:
    // As glMultiDrawElementsIndirect reads it.
    struct Command {
        uint32_t indexCount, instanceCount, firstIndex;
        int32_t baseVertex;
        uint32_t baseInstance;
    };
    struct Range {
        uint32_t firstIndex, triangleCount, firstTriangle, firstNormal;
    };
    void add(const GpuPage& page, const Range& range, const DrawItem& item);
    // Draws what was added; indices come from the chunk, or from `indexBuffer` when it is not 0.
    void submit(GlId indexBuffer = 0);
    uint32_t addOpaque(const GpuPage& page, const DrawItem& item);
    // Returns the triangles appended.
    uint32_t appendSorted(const GpuPage& page);

    const MeshStore& store_;
    LatticeView view_;
    GlVertexArray array_;
    GlBuffer commandBuffer_, instanceBuffer_, sortedBuffer_;
    std::vector<Command> commands_;
    std::vector<DrawInstance> instances_;
    std::vector<size_t> chunks_;  // of each command
    std::vector<uint16_t> sortedIndices_;
    std::vector<std::pair<float, uint32_t>> order_;
};

}  // namespace pagoda::viewer
