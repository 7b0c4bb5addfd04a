#include "viewer/window/scene.h"

#include "viewer/window/node_colours.h"
#include "viewer/window/seen_point.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace pagoda::viewer {
namespace {

// Coarser than that, a moving picture says too little; it rather comes slower.
constexpr double kGreatestMovingTauPx = 16.0;
// Of the first picture, which shall come at once.
constexpr double kFirstTauPx = 40.0;
constexpr uint64_t kMaxBlankFrames = 200;

}  // namespace

Scene::Scene(const std::filesystem::path& path, std::string name, const RendererOptions& options)
    : name_(std::move(name)),
      database_(ooc::Database::open(path)),
      source_(database_),
      up_(hlod::upAxisOf(database_.metadataJson())) {
    restart(options);
    triangles_ = renderer_->runner().root().record->subtreeTriangles;
}

Scene::~Scene() = default;

void Scene::restart(const RendererOptions& options) {
    frozen_.reset();
    strategy_.reset();
    renderer_.reset();  // its GPU memory goes before new one is asked for
    renderer_ = std::make_unique<Renderer>(database_.header().lattice, source_, options);
    record_ = {};
    watch(std::nullopt);
    hasDrawn_ = false;
    framesSinceStart_ = 0;
}

std::vector<std::string> Scene::faults() const {
    std::vector<std::string> faults = record_.faults;
    if (!database_.headerFault().empty()) faults.push_back("header: " + database_.headerFault());
    if (!database_.metadataFault().empty()) {
        faults.push_back("metadata: " + database_.metadataFault());
    }
    return faults;
}

hlod::Strategy& Scene::strategyFor(const ViewSettings& settings) {
    if (frozen_) return *frozen_;
    if (!strategy_ || strategyName_ != settings.strategy) {
        if (strategy_) renderer_->runner().forget(*strategy_);
        strategy_ = hlod::makeStrategy(settings.strategy, settings.strategyOptions);
        strategyName_ = settings.strategy;
    }
    return *strategy_;
}

double Scene::tauFor(const ViewSettings& settings, bool isMoving) {
    isCoarsened_ = false;
    if (!hasDrawn_) {  // something to look at comes before all detail
        isCoarsened_ = true;
        return std::max(settings.tauPx, kFirstTauPx);
    }
    if (!settings.holdsFrameRate || frozen_) return settings.tauPx;
    if (!rateControl_ || rateTargetFps_ != settings.targetFps) {
        rateTargetFps_ = settings.targetFps;
        rateControl_.emplace(hlod::FrameRateControl::Options{
            .targetMs = 1000.0 / settings.targetFps, .greatestTauPx = kGreatestMovingTauPx});
    }
    if (!isMoving) return settings.tauPx;
    const double tauPx = rateControl_->tauPx(settings.tauPx);
    isCoarsened_ = tauPx > settings.tauPx;
    return tauPx;
}

void Scene::setTint(const ViewSettings& settings) {
    renderer_->device().setTint(
        tintOf(settings.colouring, record_.effectiveTauPx > 0 ? record_.effectiveTauPx : 1.0));
    renderer_->device().setWireframe(settings.isWireframe);
    // Lines hide nothing: what was learnt from surfaces is wrong for them, and the other way round.
    if (isWireframe_ != settings.isWireframe && strategy_) {
        renderer_->runner().forget(*strategy_);
    }
    isWireframe_ = settings.isWireframe;
}

const hlod::FrameRecord& Scene::draw(const hlod::Camera& camera, const ViewSettings& settings,
                                     bool isMoving) {
    RenderOptions options;
    options.tauPx = tauFor(settings, isMoving);
    options.worldUp = Vec3f(hlod::upVector(up_));
    options.clip = clip_;
    options.watch = isWatching_ ? &watch_ : nullptr;
    setTint(settings);
    renderer_->runner().setPrefetch(settings.runtime.doesPrefetch && !frozen_);
    hlod::Strategy& strategy = strategyFor(settings);
    record_ = renderer_->renderLive(camera, strategy, options);
    // A view beside the model has nothing to wait for, nor has one whose pages do not come.
    ++framesSinceStart_;
    hasDrawn_ |=
        record_.drawnNodes > 0 || record_.missingPages == 0 || framesSinceStart_ >= kMaxBlankFrames;
    record_.strategy = frozen_ ? "frozen" : settings.strategy;
    if (rateControl_ && isMoving && settings.holdsFrameRate && !frozen_) {
        rateControl_->update({.tauPx = settings.tauPx,
                              .effectiveTauPx = record_.effectiveTauPx,
                              .measuredMs = record_.frameMs,
                              .isSameView = camera == camera_});
    }
    camera_ = camera;
    return record_;
}

void Scene::freeze() {
    if (!hasDrawn_) return;  // there is no visible set yet
    frozen_ = std::make_unique<FrozenCut>(renderer_->runner().cut(), camera_);
}

void Scene::thaw() {
    frozen_.reset();
}

std::optional<Vec3d> Scene::surfaceAt(glm::dvec2 px) {
    FrameTarget* const target = renderer_->device().target();
    if (target == nullptr) return std::nullopt;
    const auto seen = seenPoint(*target, hlod::View(camera_, box()), static_cast<int>(px.x),
                                static_cast<int>(px.y));
    if (!seen) return std::nullopt;
    return seen->pointModel;
}

std::optional<Pick> Scene::pick(glm::dvec2 px) {
    FrameTarget* const target = renderer_->device().target();
    if (target == nullptr) return std::nullopt;
    const int x = static_cast<int>(px.x), y = static_cast<int>(px.y);
    const PixelSample sample = target->sample(x, y);
    const std::optional<ooc::NodeId> id = renderer_->device().nodeOf(sample.nodeOrdinal);
    const hlod::View view(camera_, box());
    const std::optional<SeenPoint> seen = seenPoint(*target, view, x, y);
    if (!id || !seen) return std::nullopt;
    Pick pick;
    pick.pointModel = seen->pointModel;
    pick.distanceModelUnits = seen->distanceModelUnits;
    pick.triangle = sample.triangle;
    const hlod::FrameCut& cut = renderer_->runner().cut();
    const auto take = [&](std::span<const hlod::Node> nodes, std::span<const uint8_t> standIns) {
        for (size_t i = 0; i < nodes.size(); ++i) {
            if (nodes[i].record->id != *id) continue;
            pick.node = *nodes[i].record;
            pick.boxModel = *nodes[i].boxModel;
            pick.isStandIn = i < standIns.size() && standIns[i] != 0;
            pick.ssePx = view.ssePx(pick.node.errorModelUnits, pick.boxModel);
            pick.errorHerePx = pick.node.errorModelUnits * camera_.heightPx /
                               (2.0 * view.tanY() * pick.distanceModelUnits);
            return true;
        }
        return false;
    };
    if (take(cut.drawn(), cut.drawnAsStandIn()) || take(cut.zipped(), {})) return pick;
    return std::nullopt;
}

hlod::LeafRay Scene::rayThrough(glm::dvec2 px) const {
    const hlod::View view(camera_, box());
    return {.originModel = view.eye(),
            .direction = pixelDirection(view, static_cast<int>(px.x), static_cast<int>(px.y)),
            .leastAlong = view.nearModelUnits(),
            .clip = clip_};
}

void Scene::watch(std::optional<ooc::NodeId> node) {
    isWatching_ = node.has_value();
    watch_ = {};
    if (node) watch_.page = {0, *node};
}

const cache::PageStory* Scene::storyOf(ooc::NodeId node) const {
    return renderer_->runner().streaming().residency().history().find({0, node});
}

double Scene::distanceSeen() {
    FrameTarget* const target = renderer_->device().target();
    if (target == nullptr) return std::numeric_limits<double>::infinity();
    return nearestSeen(*target, hlod::View(camera_, box()));
}

Picture Scene::read() {
    return renderer_->read(record_);
}

}  // namespace pagoda::viewer
