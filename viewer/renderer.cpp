#include "viewer/renderer.h"

#include "ooc/base/error.h"
#include "viewer/gl_context.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace pagoda::viewer {
namespace {

// How fast tau rises while the cut does not fit: each try loads what the one before already had.
constexpr double kTauGrowth = 1.5;
constexpr double kMinRaisedTauPx = 0.25;
constexpr double kMaxTauPx = 1e7;
constexpr uint64_t kMinGpuBytes = uint64_t{1} << 20;

class Stopwatch {
public:
    // Milliseconds since the last call, or the beginning.
    double lapMs() {
        const auto now = std::chrono::steady_clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - begin_).count();
        begin_ = now;
        return ms;
    }

private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

bool byPage(const hlod::Node& a, const hlod::Node& b) {
    return a.page() < b.page();
}

}  // namespace

// Hears the strategy: pages go to the cache, the cut is kept for drawing in the order of node ids.
class Renderer::Sink final : public hlod::FrameSink {
public:
    explicit Sink(Renderer& renderer) : renderer_(renderer) {}

    cache::PageState want(const hlod::Node& node, double priority) override {
        const cache::PageState state =
            renderer_.residency_.want({node.page(), *node.record, priority});
        hasRoom_ = hasRoom_ && state != cache::PageState::NoRoom;
        return state;
    }
    void refine(const hlod::Node& node) override {
        renderer_.cut_.refine(node);
        // A refined node is not drawn, but its zippers to unrefined neighbours are.
        if ((node.record->flags & ooc::kNodeHasZippers) != 0) static_cast<void>(want(node, 0.0));
    }
    void draw(const hlod::Node& node) override { renderer_.cut_.draw(node); }
    hlod::CountingVisibility* visibility() override { return nullptr; }
    [[nodiscard]] bool hasRoom() const noexcept { return hasRoom_; }

private:
    Renderer& renderer_;
    bool hasRoom_ = true;
};

Renderer::Renderer(const ooc::Lattice& lattice, cache::PageSource& source, Budgets budgets)
    : store_(std::max(budgets.gpuBytes, kMinGpuBytes)),
      residency_({budgets.hostBytes, std::max(budgets.gpuBytes, kMinGpuBytes)}, source, store_),
      index_(source),
      tree_(lattice, index_),
      drawer_(store_) {
}

Box3d Renderer::sceneBox() {
    return tree_.boxModel(tree_.root());
}

hlod::FrameRecord Renderer::render(const hlod::Camera& camera, hlod::Strategy& strategy,
                                   const RenderOptions& options) {
    const hlod::View view(camera, sceneBox());
    const cache::Residency::Counters before = residency_.counters();
    hlod::FrameRecord record;
    record.tauPx = record.effectiveTauPx = options.tauPx;
    Stopwatch watch;
    while (!traverse(view, strategy, record)) {
        record.effectiveTauPx = std::max(record.effectiveTauPx, kMinRaisedTauPx) * kTauGrowth;
        if (record.effectiveTauPx > kMaxTauPx) {
            throw Error("", "", "not even the coarsest nodes fit the GPU budget",
                        "use a greater --gpu-budget");
        }
    }
    record.traverseMs = watch.lapMs();
    beginFrame(view, options);
    std::vector<hlod::Node> nodes(cut_.drawn().begin(), cut_.drawn().end());
    std::sort(nodes.begin(), nodes.end(), byPage);
    drawFrame(view, nodes, record, {});
    record.drawMs = watch.lapMs();
    finish(record, before);
    return record;
}

bool Renderer::traverse(const hlod::View& view, hlod::Strategy& strategy,
                        hlod::FrameRecord& record) {
    residency_.beginFrame(++frameIndex_);
    cut_.clear();
    record.visitedNodes = record.culledNodes = record.standIns = 0;
    Sink sink(*this);
    hlod::FrameContext frame{view, tree_, record.effectiveTauPx, sink, record};
    return strategy.traverse(frame) && sink.hasRoom();
}

hlod::FrameRecord Renderer::renderReference(const hlod::Camera& camera,
                                            const RenderOptions& options,
                                            const std::function<void()>& onBatch) {
    const hlod::View view(camera, sceneBox());
    const cache::Residency::Counters before = residency_.counters();
    hlod::FrameRecord record;
    record.strategy = "reference";
    Stopwatch watch;
    residency_.beginFrame(++frameIndex_);
    cut_.clear();
    std::vector<hlod::Node> leaves, pending{tree_.root()};
    while (!pending.empty()) {
        const hlod::Node node = pending.back();
        pending.pop_back();
        ++record.visitedNodes;
        if (!view.intersectsFrustum(tree_.boxModel(node))) {
            ++record.culledNodes;
            continue;
        }
        if (node.isLeaf()) leaves.push_back(node);
        for (const ooc::NodeRecord& child : tree_.children(node))
            pending.push_back(tree_.node(child));
    }
    std::sort(leaves.begin(), leaves.end(), byPage);
    record.traverseMs = watch.lapMs();
    beginFrame(view, options);
    drawFrame(view, leaves, record, onBatch);
    record.drawMs = watch.lapMs();
    finish(record, before);
    return record;
}

void Renderer::beginFrame(const hlod::View& view, const RenderOptions& options) {
    const hlod::Camera& camera = view.camera();
    if (!target_ || target_->widthPx() != camera.widthPx ||
        target_->heightPx() != camera.heightPx) {
        target_.reset();
        target_ = std::make_unique<FrameTarget>(camera.widthPx, camera.heightPx);
    }
    nearModelUnits_ = view.nearModelUnits();
    ordinals_.clear();
    drawFaults_.clear();
    target_->begin(options.background);
    const LatticeView latticeView = makeLatticeView(view, tree_.lattice());
    program_.setView(latticeView, options.worldUp);
    drawer_.bind(program_, latticeView);
}

// `nodes` by page id: the order that decides ties at equal depth.
void Renderer::drawFrame(const hlod::View& view, std::span<const hlod::Node> nodes,
                         hlod::FrameRecord& record, const std::function<void()>& onBatch) {
    for (const hlod::Node& node : nodes) ordinals_.push_back(node.record->id);
    target_->beginOpaque();
    drawOpaque(nodes, record, onBatch);
    drawZippers(record);
    target_->beginTranslucent();
    drawTranslucent(view, nodes, record, onBatch);
    glFinish();
}

void Renderer::drawOpaque(std::span<const hlod::Node> nodes, hlod::FrameRecord& record,
                          const std::function<void()>& onBatch) {
    std::vector<uint32_t> order(nodes.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto draw = [&](std::span<const DrawItem> items) {
        record.drawnNodes += items.size();
        record.drawnTriangles += drawer_.drawOpaque(items);
    };
    drawInBatches(nodes, order, draw, onBatch);
}

void Renderer::drawZippers(hlod::FrameRecord& record) {
    std::vector<DrawItem> items;
    for (const auto& [page, node] : cut_.refinedNodes()) {
        if ((node.record->flags & ooc::kNodeHasZippers) == 0 || !residency_.isResident(page))
            continue;
        ordinals_.push_back(page.node);
        items.push_back({page, static_cast<uint32_t>(ordinals_.size())});
    }
    const auto isRefined = [&](cache::PageId page) { return cut_.refined(page); };
    record.drawnTriangles += drawer_.drawZippers(items, isRefined, record.drawnZippers);
}

void Renderer::drawTranslucent(const hlod::View& view, std::span<const hlod::Node> nodes,
                               hlod::FrameRecord& record, const std::function<void()>& onBatch) {
    struct Key {
        double eyeDistance;
        uint32_t index;
    };
    std::vector<Key> keys;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        if ((nodes[i].record->flags & ooc::kNodeHasTranslucent) == 0) continue;
        const Box3d box = tree_.boxModel(nodes[i]);
        keys.push_back({glm::distance(0.5 * (box.min + box.max), view.eye()), i});
    }
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
        return a.eyeDistance != b.eyeDistance ? a.eyeDistance > b.eyeDistance : a.index < b.index;
    });
    std::vector<uint32_t> order;
    for (const Key& key : keys) order.push_back(key.index);
    const auto draw = [&](std::span<const DrawItem> items) {
        const uint64_t triangles = drawer_.drawTranslucent(items);
        record.translucentTriangles += triangles;
        record.drawnTriangles += triangles;
    };
    drawInBatches(nodes, order, draw, onBatch);
}

// Draws nodes[order[0]], nodes[order[1]], ... A batch ends when pinned pages fill the GPU budget,
// which in a frame whose cut fits happens once, at the end.
void Renderer::drawInBatches(std::span<const hlod::Node> nodes, std::span<const uint32_t> order,
                             const std::function<void(std::span<const DrawItem>)>& draw,
                             const std::function<void()>& onBatch) {
    std::vector<DrawItem> batch;
    const auto flush = [&] {
        draw(batch);
        batch.clear();
        if (onBatch) onBatch();
    };
    for (const uint32_t i : order) {
        const cache::PageRequest request{nodes[i].page(), *nodes[i].record};
        cache::PageState state = residency_.want(request);
        if (state == cache::PageState::NoRoom) {
            flush();
            // Ranges of the drawn pages are about to be written again. llvmpipe 22.3 does not order
            // that behind shaders that still read normals from them, as GL says it should.
            glFinish();
            residency_.unpinAll();
            state = residency_.want(request);
        }
        if (state == cache::PageState::Resident) batch.push_back({request.id, i + 1});
        if (state == cache::PageState::NoRoom) {
            drawFaults_.push_back(fmt::format("page of node {:#x}: larger than the GPU budget",
                                              request.id.node.value));
        }
    }
    flush();
}

void Renderer::finish(hlod::FrameRecord& record, const cache::Residency::Counters& before) {
    throwOnGlError("drawing a frame");
    const cache::Residency::Counters& after = residency_.counters();
    record.widthPx = target_->widthPx();
    record.heightPx = target_->heightPx();
    record.loadedPages = after.loadedPages - before.loadedPages;
    record.bytesRead = after.bytesRead - before.bytesRead;
    record.bytesUploaded = after.bytesUploaded - before.bytesUploaded;
    record.evictedPages = after.evictedPages - before.evictedPages;
    record.indexBlocks = index_.blockCount();
    record.indexBytes = index_.usedBytes();
    record.gpuBytes = residency_.gpuUsedBytes();
    record.hostBytes = residency_.hostUsedBytes();
    for (const cache::BlockFault& fault : index_.faults()) {
        record.faults.push_back(fmt::format("index block {}: {}", fault.block, fault.what));
    }
    for (const cache::PageFault& fault : residency_.faults()) {
        record.faults.push_back(
            fmt::format("page of node {:#x}: {}", fault.id.node.value, fault.what));
    }
    record.faults.insert(record.faults.end(), drawFaults_.begin(), drawFaults_.end());
}

Picture Renderer::read(hlod::FrameRecord& record) {
    Stopwatch watch;
    Picture picture = target_->read(nearModelUnits_);
    picture.nodes = ordinals_;
    record.coveredPixels = picture.coveredPixels();
    record.readMs = watch.lapMs();
    return picture;
}

}  // namespace pagoda::viewer
