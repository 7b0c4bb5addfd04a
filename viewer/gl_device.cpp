#include "viewer/gl_device.h"

#include "hlod/raster/pushed_depths.h"
#include "viewer/gl_context.h"
#include "viewer/gpu_depth_tests.h"
#include "viewer/stopwatch.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace pagoda::viewer {
namespace {

// Cuts what is drawn while it lives. Programs that write no distance must not be drawn with it.
class SectionScope {
public:
    explicit SectionScope(const LatticeView& view) : isOn_(view.hasSection) {
        if (isOn_) glEnable(GL_CLIP_DISTANCE0);
    }
    ~SectionScope() {
        if (isOn_) glDisable(GL_CLIP_DISTANCE0);
    }
    SectionScope(const SectionScope&) = delete;
    SectionScope& operator=(const SectionScope&) = delete;

private:
    bool isOn_;
};

}  // namespace

std::vector<hlod::Node> translucentBackToFront(std::span<const hlod::Node> nodes,
                                               const Vec3d& eyeModel) {
    struct Key {
        double eyeDistance;
        hlod::Node node;
    };
    std::vector<Key> keys;
    for (const hlod::Node& node : nodes) {
        if ((node.record->flags & ooc::kNodeHasTranslucent) == 0) continue;
        const Box3d& box = *node.boxModel;
        keys.push_back({glm::distance(0.5 * (box.min + box.max), eyeModel), node});
    }
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
        return a.eyeDistance != b.eyeDistance ? a.eyeDistance > b.eyeDistance
                                              : a.node.page() < b.node.page();
    });
    std::vector<hlod::Node> order;
    order.reserve(keys.size());
    for (const Key& key : keys) order.push_back(key.node);
    return order;
}

GlDevice::GlDevice(const ooc::Lattice& lattice, uint64_t gpuBudgetBytes,
                   const PyramidOptions& pyramid)
    : drawsOnCpu_(isSoftwareRenderer()),
      lattice_(lattice),
      store_(gpuBudgetBytes),
      drawer_(store_),
      queries_([this] { flush(); }, [this] { restoreState(); }, !drawsOnCpu_),
      pushesOccluders_(pyramid.pushesOccluders) {
    const bool isOnCpu =
        pyramid.place == PyramidPlace::Auto ? drawsOnCpu_ : pyramid.place == PyramidPlace::Cpu;
    if (isOnCpu) {
        depthTests_ = std::make_unique<CpuDepthTests>([this] { flush(); });
    } else {
        depthTests_ =
            std::make_unique<GpuDepthTests>([this] { flush(); }, [this] { restoreState(); });
    }
}

void GlDevice::setLook(const Background& background, const Vec3f& worldUp) {
    background_ = background;
    worldUp_ = worldUp;
}

void GlDevice::beginFrame(const hlod::View& view) {
    const hlod::Camera& camera = view.camera();
    if (!target_ || target_->widthPx() != camera.widthPx ||
        target_->heightPx() != camera.heightPx) {
        target_.reset();
        target_ = std::make_unique<FrameTarget>(camera.widthPx, camera.heightPx);
    }
    view_ = &view;
    eyeModel_ = view.eye();
    nearModelUnits_ = view.nearModelUnits();
    ordinals_.clear();
    pushes_.assign(1, 0.0f);
    gathered_.clear();
    drawnNodes_ = drawnTriangles_ = 0;
    drawMs_ = 0.0;
    isBackgroundPainted_ = false;
    Stopwatch watch;
    target_->begin(background_);
    latticeView_ = makeLatticeView(view, lattice_);
    store_.setHidden(view.clip().hidden);
    program().setView(latticeView_, worldUp_);
    queries_.beginFrame(view, latticeView_, lattice_);
    depthTests_->beginFrame(view, *target_, pushesOccluders_ ? &pushes_ : nullptr);
    target_->beginOpaque();
    drawer_.bind(program(), latticeView_);
    drawMs_ += watch.lapMs();
}

NodeProgram& GlDevice::program() {
    if (!latticeView_.hasSection) return program_;
    if (!sectionProgram_) sectionProgram_.emplace(std::span<const char* const>{}, true);
    return *sectionProgram_;
}

uint32_t GlDevice::ordinalOf(const hlod::Node& node) {
    ordinals_.push_back(node.record->id);
    if (pushesOccluders_) {
        pushes_.push_back(hlod::depthPush(node.record->errorModelUnits, nearModelUnits_));
    }
    return static_cast<uint32_t>(ordinals_.size());
}

void GlDevice::draw(const hlod::Node& node) {
    gathered_.push_back({node.page(), ordinalOf(node), tintOf(node)});
}

glm::u8vec4 GlDevice::tintOf(const hlod::Node& node) const {
    return tint_ && view_ != nullptr ? tint_(node, *view_) : glm::u8vec4(0);
}

void GlDevice::flush() {
    if (gathered_.empty()) return;
    Stopwatch watch;
    // Ties at equal depth fall to the first drawn: the least page id of a batch.
    std::sort(gathered_.begin(), gathered_.end(),
              [](const DrawItem& a, const DrawItem& b) { return a.page < b.page; });
    drawnNodes_ += gathered_.size();
    const SectionScope section(latticeView_);
    // Boxes of queries are filled all the same.
    if (isWireframe_) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    drawnTriangles_ += drawer_.drawOpaque(gathered_);
    if (isWireframe_) glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    gathered_.clear();
    drawMs_ += watch.lapMs();
}

void GlDevice::restoreState() {
    target_->beginOpaque();
    drawer_.rebind(program());
}

void GlDevice::finishOpaque(hlod::FrameRecord& record) {
    flush();
    // Ranges of the drawn pages are about to be written again. llvmpipe 22.3 does not order that
    // behind shaders that still read normals from them, as GL says it should.
    glFinish();
    record.drawnNodes += drawnNodes_;
    record.drawnTriangles += drawnTriangles_;
    drawnNodes_ = drawnTriangles_ = 0;
}

void GlDevice::drawZippers(const hlod::FrameCut& cut, hlod::FrameRecord& record) {
    std::vector<hlod::Node> nodes(cut.zipped().begin(), cut.zipped().end());
    std::sort(nodes.begin(), nodes.end(),
              [](const hlod::Node& a, const hlod::Node& b) { return a.page() < b.page(); });
    std::vector<DrawItem> items;
    for (const hlod::Node& node : nodes) {
        if (store_.contains(node.page())) {
            items.push_back({node.page(), ordinalOf(node), tintOf(node)});
        }
    }
    const SectionScope section(latticeView_);
    const auto isRefined = [&](cache::PageId page) { return cut.refined(page); };
    record.drawnTriangles += drawer_.drawZippers(items, isRefined, record.drawnZippers);
}

void GlDevice::drawTranslucent(std::span<const hlod::Node> order, hlod::FrameRecord& record) {
    std::vector<DrawItem> items;
    for (const hlod::Node& node : order) items.push_back({node.page(), 0, tintOf(node)});
    if (!isBackgroundPainted_) target_->paintBackground();
    isBackgroundPainted_ = true;
    target_->beginTranslucent();
    drawer_.rebind(program());
    const SectionScope section(latticeView_);
    const uint64_t triangles = drawer_.drawTranslucent(items);
    record.translucentTriangles += triangles;
    record.drawnTriangles += triangles;
}

void GlDevice::endFrame(const hlod::FrameCut& cut, hlod::FrameRecord& record) {
    record.queryMs = queries_.msThisFrame() + depthTests_->msThisFrame();
    record.drawMs = drawMs_;  // what was drawn while the strategy went on; its caller adds the rest
    finishOpaque(record);
    drawZippers(cut, record);
    drawTranslucent(translucentBackToFront(cut.drawn(), eyeModel_), record);
    glFinish();
    throwOnGlError("drawing a frame");
    view_ = nullptr;
    record.queries += queries_.queriesThisFrame();
}

std::optional<ooc::NodeId> GlDevice::nodeOf(uint32_t ordinal) const {
    if (ordinal == 0 || ordinal > ordinals_.size()) return std::nullopt;
    return ordinals_[ordinal - 1];
}

Picture GlDevice::read() const {
    Picture picture = target_->read(nearModelUnits_);
    picture.nodes = ordinals_;
    return picture;
}

}  // namespace pagoda::viewer
