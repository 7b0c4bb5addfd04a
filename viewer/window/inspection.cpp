#include "viewer/window/inspection.h"

#include <algorithm>

namespace pagoda::viewer {
namespace {

constexpr size_t kMaxPath = 64;  // deeper trees are cut at the top

}  // namespace

Inspection::Inspection(Scene& scene, const std::function<void()>& wake)
    : scene_(scene),
      objects_(scene.database(), wake),
      visibility_(objects_),
      rays_(scene.source(), scene.database().header().lattice, wake) {
}

Inspection::News Inspection::update() {
    News news;
    news.isAny = objects_.update();
    news.isVisibility = visibility_.update();
    if (auto result = rays_.take()) {
        takeHit(*result);
        news.isAny = true;
        news.isExact = !exact_;  // nothing there: no name to wait for
    }
    if (isPathWanted_ && findPath()) {
        isPathWanted_ = false;
        news.isAny = news.isExact = true;
    }
    news.isAny |= news.isVisibility;
    return news;
}

void Inspection::pickAt(glm::dvec2 px) {
    const std::optional<Pick> last = pick_;
    lastExactModel_.reset();
    if (exact_) lastExactModel_ = exact_->hit.pointModel;
    exact_.reset();
    faultsWithoutHit_.clear();
    isPathWanted_ = false;
    pick_ = scene_.pick(px);
    if (last && pick_) {
        pick_->fromLastModelUnits = glm::distance(last->pointModel, pick_->pointModel);
    }
    scene_.watch(pick_ ? std::optional(pick_->node.id) : std::nullopt);
    rays_.ask(scene_.rayThrough(px));
    isReadingLeaves_ = true;
}

void Inspection::dismissPick() {
    rays_.cancel();
    pick_.reset();
    exact_.reset();
    lastExactModel_.reset();
    isReadingLeaves_ = isPathWanted_ = false;
    scene_.watch(std::nullopt);
}

void Inspection::takeHit(const hlod::LeafRayResult& result) {
    isReadingLeaves_ = false;
    exact_.reset();
    faultsWithoutHit_.clear();
    if (!result.isHit) {
        faultsWithoutHit_ = result.faults;
        return;
    }
    exact_ = ExactHit{.hit = result.hit,
                      .distanceModelUnits = result.hit.along,  // the ray is 1 along the view
                      .faults = result.faults,
                      .path = {},
                      .fromLastModelUnits = {}};
    if (lastExactModel_) {
        exact_->fromLastModelUnits = glm::distance(*lastExactModel_, result.hit.pointModel);
    }
    isPathWanted_ = true;
}

// Names of the object and all above it, as far as they have come.
bool Inspection::findPath() {
    std::vector<std::string> path;
    for (uint32_t object = exact_->hit.object;
         object != ooc::kNoObject && path.size() < kMaxPath;) {
        const ooc::ObjectRecord* const record = objects_.record(object);
        if (record == nullptr) return false;
        path.push_back(record->name.empty() ? "(without a name)" : record->name);
        object = record->parent;
    }
    std::reverse(path.begin(), path.end());
    exact_->path = std::move(path);
    return true;
}

}  // namespace pagoda::viewer
