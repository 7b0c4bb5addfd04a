// gl_device.h: draws frames by OpenGL 4.5: nodes gathered into multi-draws between queries, box
// queries, then zippers and translucent parts. Implements what hlod/view/ asks of a device. How a
// frame flows: docs/frame.md. Render thread only, context current.
#pragma once

#include "hlod/view/device.h"
#include "viewer/box_queries.h"
#include "viewer/depth_tests.h"
#include "viewer/frame_target.h"
#include "viewer/mesh_store.h"
#include "viewer/node_drawer.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace pagoda::viewer {

// What a node is painted with instead of the model's colours: DrawInstance::tint.
using NodeTint = std::function<glm::u8vec4(const hlod::Node&, const hlod::View&)>;

class GlDevice final : public hlod::Device {
public:
    // `lattice` is the scene's.
    GlDevice(const ooc::Lattice& lattice, uint64_t gpuBudgetBytes,
             const PyramidOptions& pyramid = {});

    [[nodiscard]] MeshStore& store() noexcept { return store_; }
    // Holds from the next frame on.
    void setLook(const Background& background, const Vec3f& worldUp);
    void setTint(NodeTint tint) { tint_ = std::move(tint); }  // empty: the model's colours
    void setWireframe(bool isOn) noexcept { isWireframe_ = isOn; }

    void beginFrame(const hlod::View& view) override;
    void draw(const hlod::Node& node) override;
    [[nodiscard]] bool drawsOnCpu() const override { return drawsOnCpu_; }
    [[nodiscard]] hlod::CountingVisibility* counting() override { return &queries_; }
    [[nodiscard]] hlod::PyramidVisibility* pyramid() override { return depthTests_.get(); }
    void endFrame(const hlod::FrameCut& cut, hlod::FrameRecord& record) override;

    // For who draws a picture in several batches: draws what was gathered, waits for it, and
    // forgets the pages. Zippers do not take part.
    void finishOpaque(hlod::FrameRecord& record);
    // Translucent parts of nodes whose pages are uploaded, `order` from back to front.
    void drawTranslucent(std::span<const hlod::Node> order, hlod::FrameRecord& record);

    // The last frame's picture.
    [[nodiscard]] Picture read() const;
    // What the last frame was drawn into; null before the first.
    [[nodiscard]] FrameTarget* target() noexcept { return target_.get(); }
    // The node that PixelSample::nodeOrdinal names in the last frame; nothing for 0.
    [[nodiscard]] std::optional<ooc::NodeId> nodeOf(uint32_t ordinal) const;

private:
    void flush();
    void restoreState();
    [[nodiscard]] NodeProgram& program();
    [[nodiscard]] uint32_t ordinalOf(const hlod::Node& node);
    [[nodiscard]] glm::u8vec4 tintOf(const hlod::Node& node) const;
    void drawZippers(const hlod::FrameCut& cut, hlod::FrameRecord& record);

    bool drawsOnCpu_;
    ooc::Lattice lattice_;
    MeshStore store_;
    NodeProgram program_;
    std::optional<NodeProgram> sectionProgram_;  // made when a view is first cut
    NodeDrawer drawer_;
    BoxQueries queries_;
    bool pushesOccluders_;
    std::unique_ptr<DepthTests> depthTests_;
    std::unique_ptr<FrameTarget> target_;
    Background background_;
    Vec3f worldUp_{0, 1, 0};
    NodeTint tint_;
    bool isWireframe_ = false;
    const hlod::View* view_ = nullptr;  // of this frame, until it ends
    LatticeView latticeView_;
    Vec3d eyeModel_{0.0};
    double nearModelUnits_ = 1.0;
    std::vector<ooc::NodeId> ordinals_;  // node of ordinal i + 1
    std::vector<float> pushes_;          // of ordinal i, where occluders are pushed
    std::vector<DrawItem> gathered_;
    uint64_t drawnNodes_ = 0, drawnTriangles_ = 0;
    double drawMs_ = 0.0;
    bool isBackgroundPainted_ = false;  // in this frame
};

// Nodes with translucent parts among `nodes`, from back to front by their centres.
[[nodiscard]] std::vector<hlod::Node> translucentBackToFront(std::span<const hlod::Node> nodes,
                                                             const Vec3d& eyeModel);

}  // namespace pagoda::viewer
