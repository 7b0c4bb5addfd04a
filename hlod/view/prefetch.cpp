#include "hlod/view/prefetch.h"

#include "hlod/view/camera_path.h"
#include "hlod/view/screen_box.h"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace pagoda::hlod {
namespace {

// A turn or a step above these is a jump: nothing on the way was seen.
constexpr double kJumpDegrees = 25.0;
constexpr double kJumpDiagonals = 0.1;
constexpr double kNewest = 0.5;  // weight of the last frame's motion in the mean
constexpr double kGoesOn = 0.9;  // of its velocity is left a frame later
// What is not wanted within so many frames was foretold in vain.
constexpr uint64_t kSoonFrames = 30;
constexpr double kPaysAbove = 0.3;     // chosen, not tuned
constexpr double kPriorBytes = 64e3;   // how much a reason is believed before it was tried
constexpr double kForget = 1.0 / 1e6;  // a byte later: the last megabyte counts
// Of the picture, that a hidden box fills: smaller ones seldom come out whole, and cost few pixels
// when they do (docs/decisions.md).
constexpr double kLeastUncoveredShare = 0.1;
constexpr double kMaxLookAhead = 12.0;  // frames: motion tells no more
constexpr uint32_t kMaxVisits = 20'000;

// Before anything was measured.
constexpr std::array<double, cache::kPrefetchReasons> kPrior = {0.8, 0.5, 0.4, 0.3};

size_t at(PrefetchReason reason) {
    return static_cast<size_t>(reason);
}

// Pixels of the box's outline, roughly: a ball of its diagonal, not clipped.
double roughPixels(const View& view, const Box3d& box) {
    const double sidePx = view.ssePx(glm::length(box.max - box.min), box);
    return std::min(sidePx * sidePx, 1.0 * view.camera().widthPx * view.camera().heightPx);
}

bool isLargeEnoughToUncover(const View& view, const Box3d& box) {
    const double pixels = 1.0 * view.camera().widthPx * view.camera().heightPx;
    return roughPixels(view, box) >= kLeastUncoveredShare * pixels;
}

}  // namespace

std::optional<PrefetchReasons> parsePrefetchReasons(std::string_view text) {
    if (text == "on") return PrefetchReasons().set();
    PrefetchReasons reasons;
    if (text == "off") return reasons;
    while (true) {
        const size_t comma = text.find(',');
        const auto name = std::find(kPrefetchReasonNames.begin(), kPrefetchReasonNames.end(),
                                    text.substr(0, comma));
        if (name == kPrefetchReasonNames.end()) return std::nullopt;
        reasons.set(static_cast<size_t>(name - kPrefetchReasonNames.begin()));
        if (comma == std::string_view::npos) return reasons;
        text.remove_prefix(comma + 1);
    }
}

void CameraMotion::note(const Camera& camera, const Box3d& sceneBox) {
    const std::optional<Camera> before = std::exchange(last_, camera);
    if (!before || before->widthPx != camera.widthPx || before->heightPx != camera.heightPx ||
        before->fovyDegrees != camera.fovyDegrees) {
        moved_ = turned_ = Vec3d(0.0);
        return;
    }
    const PathStep step = stepBetween(*before, camera);
    const double diagonal = glm::length(sceneBox.max - sceneBox.min);
    if (step.turnDegrees > kJumpDegrees || step.moveModelUnits > kJumpDiagonals * diagonal ||
        *before == camera) {
        moved_ = turned_ = Vec3d(0.0);
        return;
    }
    const Vec3d axis = glm::cross(before->target - before->eye, camera.target - camera.eye);
    const double length = glm::length(axis);
    const Vec3d turned =
        length > 0.0 ? axis * (step.turnDegrees * std::numbers::pi / 180.0 / length) : Vec3d(0.0);
    const bool isFirst = moved_ == Vec3d(0.0) && turned_ == Vec3d(0.0);
    const double weight = isFirst ? 1.0 : kNewest;
    moved_ = glm::mix(moved_, camera.eye - before->eye, weight);
    turned_ = glm::mix(turned_, turned, weight);
}

std::optional<Camera> CameraMotion::in(double frames) const {
    if (!last_ || (moved_ == Vec3d(0.0) && turned_ == Vec3d(0.0))) return std::nullopt;
    const double steps = (1.0 - std::pow(kGoesOn, frames)) / (1.0 - kGoesOn);
    Camera camera = *last_;
    const double radians = glm::length(turned_) * steps;
    Vec3d look = camera.target - camera.eye;
    if (radians > 0.0) {
        const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), radians, glm::normalize(turned_));
        look = Vec3d(turn * glm::dvec4(look, 0.0));
    }
    camera.eye += moved_ * steps;
    camera.target = camera.eye + look;
    return camera;
}

struct Prefetcher::Walk {
    const View& now;
    const View& then;
    double tauPx;
    NodeTree& tree;
    cache::Residency& residency;
    uint32_t visits = 0;
};

void Prefetcher::beginFrame(uint64_t frameIndex, const NodeTree& tree) {
    frame_ = frameIndex;
    if (marks_.size() < tree.slotCount()) marks_.resize(tree.slotCount());
    expire();
}

void Prefetcher::settleScore(const Foretold& foretold, bool isHit) {
    Score& score = scores_[at(foretold.reason)];
    const double left = std::exp(-kForget * foretold.bytes);
    score.hitBytes *= left;
    score.missBytes *= left;
    (isHit ? score.hitBytes : score.missBytes) += foretold.bytes;
}

void Prefetcher::expire() {
    while (!byAge_.empty() && byAge_.front().first + kSoonFrames < frame_) {
        const auto found = foretold_.find(byAge_.front().second);
        if (found != foretold_.end() && found->second.frame == byAge_.front().first) {
            settleScore(found->second, false);
            foretold_.erase(found);
        }
        byAge_.pop_front();
    }
}

void Prefetcher::noteWant(const Node& node, bool isResident) {
    const cache::PageId page = node.page();
    if (const auto found = foretold_.find(page); found != foretold_.end()) {
        settleScore(found->second, true);
        foretold_.erase(found);
    }
    if (!isResident) {
        missingSince_.try_emplace(page, frame_);
    } else if (!missingSince_.empty()) {
        const auto found = missingSince_.find(page);
        if (found == missingSince_.end()) return;
        const auto frames = static_cast<double>(frame_ - found->second);
        latencyFrames_ += 0.1 * (std::min(frames, kMaxLookAhead) - latencyFrames_);
        missingSince_.erase(found);
    }
}

double Prefetcher::precision(PrefetchReason reason) const {
    const Score& score = scores_[at(reason)];
    const double hits = score.hitBytes + kPriorBytes * kPrior[at(reason)];
    return hits / (score.hitBytes + score.missBytes + kPriorBytes);
}

bool Prefetcher::pays(PrefetchReason reason) const {
    return precision(reason) >= kPaysAbove;
}

std::string Prefetcher::offText() const {
    std::string text;
    for (size_t i = 0; i < cache::kPrefetchReasons; ++i) {
        const auto reason = static_cast<PrefetchReason>(i);
        if (pays(reason)) continue;
        text += fmt::format("{}{} {:.0f}%", text.empty() ? "" : ", ", kPrefetchReasonNames[i],
                            100.0 * precision(reason));
    }
    return text;
}

// A frame more than a load takes, and one for what the motion's mean lags behind.
double Prefetcher::lookAheadFrames() const {
    return std::clamp(std::ceil(latencyFrames_) + 2.0, 3.0, kMaxLookAhead);
}

void Prefetcher::run(const View& now, const Box3d& sceneBox, double tauPx, NodeTree& tree,
                     cache::Residency& residency) {
    motion_.note(now.camera(), sceneBox);
    std::erase_if(missingSince_,
                  [&](const auto& item) { return item.second + kSoonFrames < frame_; });
    const std::optional<Camera> there = motion_.in(lookAheadFrames());
    if (!there || tauPx <= 0.0) return;
    const auto root = tree.root();
    if (!root) return;
    const View then(*there, sceneBox, now.clip());
    Walk walk{now, then, tauPx, tree, residency};
    visit(walk, *root);
}

Prefetcher::What Prefetcher::told(const Node& node) const {
    if (node.slot >= marks_.size()) return What::Nothing;
    const Mark& mark = marks_[node.slot];
    return mark.frame == frame_ && mark.page == node.page() ? mark.what : What::Nothing;
}

void Prefetcher::visit(Walk& walk, const Node& node) {
    if (++walk.visits > kMaxVisits || !walk.then.intersectsFrustum(*node.boxModel)) return;
    const What what = told(node);
    const bool isNear = crossesNear(walk.then, *node.boxModel);
    if (what == What::Refined) {
        const NodeRange children = walk.tree.residentChildren(node);
        for (uint32_t i = 0; i < children.size(); ++i) visit(walk, children[i]);
    } else if (what == What::Drawn) {
        const double errorModelUnits = node.record->errorModelUnits;
        if (node.isLeaf() || walk.then.ssePx(errorModelUnits, *node.boxModel) <= walk.tauPx) return;
        // Drawn above tau for being half hidden: as it is now it will do, until the eye is there.
        const bool isWeighed = walk.now.ssePx(errorModelUnits, *node.boxModel) > walk.tauPx;
        if (isWeighed && !isNear) return;
        below(walk, node, isNear ? PrefetchReason::Near : PrefetchReason::Refine);
    } else if (what == What::Hidden) {
        if (isNear) return below(walk, node, PrefetchReason::Near);
        if (isLargeEnoughToUncover(walk.then, *node.boxModel)) {
            foretell(walk, node, PrefetchReason::Uncover);
        }
    } else if (!walk.now.intersectsFrustum(*node.boxModel)) {
        below(walk, node, isNear ? PrefetchReason::Near : PrefetchReason::Enter);
    }
}

// The part of the cut at tau that lies below it then, in the frustum. What is about to hold the eye
// is asked for itself, too: it would stand in for what nobody has seen yet.
void Prefetcher::below(Walk& walk, const Node& node, PrefetchReason reason) {
    if (++walk.visits > kMaxVisits || !walk.then.intersectsFrustum(*node.boxModel)) return;
    const double ssePx = walk.then.ssePx(node.record->errorModelUnits, *node.boxModel);
    const bool isCut = node.isLeaf() || ssePx <= walk.tauPx;
    if (isCut || reason == PrefetchReason::Near) foretell(walk, node, reason);
    if (isCut) return;
    const NodeRange children = walk.tree.residentChildren(node);
    if (children.empty()) return foretellChildren(walk, node, reason);
    for (uint32_t i = 0; i < children.size(); ++i) {
        const bool isNear = crossesNear(walk.then, *children[i].boxModel);
        // Only what holds the eye is seen for sure.
        const bool isUnsure = reason == PrefetchReason::Near && !isNear;
        below(walk, children[i], isUnsure ? PrefetchReason::Refine : reason);
    }
}

void Prefetcher::foretell(Walk& walk, const Node& node, PrefetchReason reason) {
    const cache::PageId page = node.page();
    if (walk.residency.state(page) != cache::PageState::Absent) return;
    const auto [found, isNew] =
        foretold_.try_emplace(page, Foretold{reason, frame_, node.record->pageBytes});
    if (isNew) byAge_.emplace_back(frame_, page);
    if (!isReadFor(reason)) return;
    walk.residency.prefetch({page, *node.record, priority(walk, node, reason)},
                            static_cast<uint8_t>(reason));
}

// What is below cannot be foretold before its block is there: without it, each level of blocks
// would cost a load when the eye comes.
void Prefetcher::foretellChildren(Walk& walk, const Node& node, PrefetchReason reason) {
    if (isReadFor(reason)) walk.tree.prefetchChildren(node, priority(walk, node, reason));
}

bool Prefetcher::isReadFor(PrefetchReason reason) const {
    return reasons_.test(at(reason)) && pays(reason);
}

double Prefetcher::priority(const Walk& walk, const Node& node, PrefetchReason reason) const {
    return roughPixels(walk.then, *node.boxModel) * precision(reason);
}

}  // namespace pagoda::hlod
