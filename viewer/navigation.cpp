#include "viewer/navigation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pagoda::viewer {
namespace {

constexpr double kZoomPerStep = 0.85;
constexpr double kMostZoom = 20;                     // of one call or one height of the picture
constexpr double kTurnPerHeight = std::numbers::pi;  // radians
constexpr double kLevelPx = 200;                     // a turn this long takes all roll away
// View puts its near plane at a millionth of the scene's diagonal when the eye is close: what the
// eye zooms to stays behind it, in the picture's corners too.
constexpr double kLeastShare = 4e-6;
constexpr double kFarDiagonals = 1e4;  // zooming out ends here
// Of the eye's coordinates: nearer, the target's rounding would show in the direction of view.
constexpr double kTargetShare = 1e-9;

double largest(const Vec3d& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

Navigation::Navigation(const hlod::Camera& home, const Box3d& sceneModel, const Vec3d& worldUp)
    : home_(home), frame_(upFrame({0, 0, 1})) {
    setWorldUp(worldUp);
    setScene(sceneModel);
    camera_.widthPx = std::max(home.widthPx, 1);
    camera_.heightPx = std::max(home.heightPx, 1);
    adopt(isUsable(home) ? home : hlod::Camera{});
}

// The camera as given; the pose follows.
void Navigation::adopt(const hlod::Camera& camera) {
    const int widthPx = camera_.widthPx, heightPx = camera_.heightPx;
    camera_ = camera;
    camera_.widthPx = widthPx;
    camera_.heightPx = heightPx;
    pose_ = {camera.eye, attitudeOf(frame_, camera), camera.fovyDegrees};
    axes_ = axesOf(frame_, pose_.attitude);
    // A target close to an eye far from the origin would make the direction of view jitter.
    targetModelUnits_ =
        std::max(glm::length(camera.target - camera.eye), kTargetShare * largest(camera.eye));
    hasChanged_ = true;
}

void Navigation::apply(const CameraPose& pose) {
    pose_ = pose;
    axes_ = axesOf(frame_, pose_.attitude);
    camera_.eye = pose_.eye;
    camera_.target = pose_.eye + targetModelUnits_ * axes_.forward;
    camera_.up = axes_.up;
    camera_.fovyDegrees = pose_.fovyDegrees;
    hasChanged_ = true;
}

void Navigation::setSize(int widthPx, int heightPx) {
    camera_.widthPx = std::max(widthPx, 1);
    camera_.heightPx = std::max(heightPx, 1);
    hasChanged_ = true;
}

void Navigation::setMode(NavigationMode mode) {
    mode_ = mode;
    if (mode == NavigationMode::Orbit) velocity_ = Vec3d(0.0);
}

void Navigation::setScene(const Box3d& sceneModel) {
    scene_ = sceneModel;
    centre_ = isUsable(scene_) ? 0.5 * scene_.min + 0.5 * scene_.max : Vec3d(0.0);
    diagonal_ = isUsable(scene_) ? glm::length(scene_.max - scene_.min) : 0.0;
    if (!(diagonal_ > 0)) diagonal_ = 1;
}

void Navigation::setWorldUp(const Vec3d& worldUp) {
    if (!isFinite(worldUp) || worldUp == Vec3d(0.0)) return;
    stopMoves();
    drag_.reset();
    frame_ = upFrame(worldUp);
    pose_.attitude = attitudeOf(frame_, camera_);
    axes_ = axesOf(frame_, pose_.attitude);
}

void Navigation::stopMoves() {
    transition_.reset();
    velocity_ = Vec3d(0.0);
}

double Navigation::tanY() const {
    return std::tan(glm::radians(pose_.fovyDegrees) / 2);
}

Vec3d Navigation::rayOf(glm::dvec2 px) const {
    const double scale = 2 * tanY() / camera_.heightPx;
    return axes_.forward + (px.x - 0.5 * camera_.widthPx) * scale * axes_.right -
           (px.y - 0.5 * camera_.heightPx) * scale * axes_.up;
}

double Navigation::depthOf(const Vec3d& point) const {
    return glm::dot(point - pose_.eye, axes_.forward);
}

bool Navigation::isInPicture(const Vec3d& point) const {
    const double depth = depthOf(point);
    const Vec3d offset = point - pose_.eye;
    const double reach = depth * tanY();
    return depth > leastDistance() && std::abs(glm::dot(offset, axes_.up)) <= reach &&
           std::abs(glm::dot(offset, axes_.right)) <= reach * camera_.widthPx / camera_.heightPx;
}

double Navigation::leastDistance() const {
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    return std::max(kLeastShare * diagonal_, kRounding * largest(pose_.eye));
}

// Never so small that nothing seems to move.
double Navigation::depthWithoutSurface() const {
    const double least = std::max(leastDistance(), std::min(0.01 * diagonal_, distanceSeen_));
    if (pivot_ && depthOf(*pivot_) > least) return depthOf(*pivot_);
    if (depthOf(centre_) > least) return depthOf(centre_);
    return least;
}

Vec3d Navigation::pivotWithoutSurface() const {
    if (pivot_ && isInPicture(*pivot_)) return *pivot_;
    if (isInPicture(centre_)) return centre_;
    return pose_.eye + depthWithoutSurface() * axes_.forward;
}

void Navigation::beginDrag(DragKind kind, glm::dvec2 px, std::optional<Vec3d> surface) {
    if (!std::isfinite(px.x) || !std::isfinite(px.y)) return;
    stopMoves();
    const bool isGrabbed = surface && isFinite(*surface) && depthOf(*surface) > 0;
    if (isGrabbed) pivot_ = surface;
    Vec3d pivot;
    if (isGrabbed) {
        pivot = *surface;
    } else if (kind == DragKind::Orbit) {
        pivot = pivotWithoutSurface();
    } else {
        pivot = pose_.eye + depthWithoutSurface() * rayOf(px);
    }
    drag_ = Drag{kind, px, pose_, pivot, depthOf(pivot)};
}

void Navigation::endDrag() {
    drag_.reset();
}

void Navigation::dragTo(glm::dvec2 px) {
    if (!drag_ || !std::isfinite(px.x) || !std::isfinite(px.y)) return;
    switch (drag_->kind) {
        case DragKind::Orbit:
        case DragKind::Look:
            return dragTurn(px);
        case DragKind::Pan:
            return dragPan(px - drag_->px);
        case DragKind::Zoom:
            return dragZoom(px - drag_->px);
    }
}

// All from where the drag began: there and back again is the same place.
void Navigation::dragPan(glm::dvec2 deltaPx) {
    const double scale = 2 * tanY() / camera_.heightPx * drag_->depth;
    CameraPose pose = drag_->start;
    pose.eye += scale * (deltaPx.y * axes_.up - deltaPx.x * axes_.right);
    apply(pose);
}

void Navigation::dragTurn(glm::dvec2 px) {
    constexpr double kPole = std::numbers::pi / 2;
    const double perPx = kTurnPerHeight / camera_.heightPx *
                         (drag_->kind == DragKind::Look ? pose_.fovyDegrees / 180 : 1.0);
    CameraPose pose = drag_->start;
    const double pitch = pose.attitude.pitch - (px.y - drag_->px.y) * perPx;
    pose.attitude.pitch = std::clamp(pitch, -kPole, kPole);
    // Back from beyond a pole, the turn begins at once.
    drag_->px.y -= (pitch - pose.attitude.pitch) / perPx;
    const glm::dvec2 deltaPx = px - drag_->px;
    pose.attitude.yaw -= deltaPx.x * perPx;
    pose.attitude.roll *= std::max(0.0, 1 - glm::length(deltaPx) / kLevelPx);
    if (drag_->kind == DragKind::Orbit) {
        const ViewAxes from = axesOf(frame_, drag_->start.attitude);
        const ViewAxes to = axesOf(frame_, pose.attitude);
        const Vec3d offset = drag_->pivot - drag_->start.eye;
        pose.eye +=
            offset - (glm::dot(offset, from.right) * to.right + glm::dot(offset, from.up) * to.up +
                      glm::dot(offset, from.forward) * to.forward);
    }
    apply(pose);
}

void Navigation::dragZoom(glm::dvec2 deltaPx) {
    const double share = std::pow(kMostZoom, deltaPx.y / camera_.heightPx);
    CameraPose pose = drag_->start;
    pose.eye = zoomed(pose, drag_->pivot, share);
    apply(pose);
}

// The eye at `share` of its distance to a point.
Vec3d Navigation::zoomed(const CameraPose& from, const Vec3d& point, double share) const {
    const Vec3d offset = point - from.eye;
    const double distance = glm::length(offset), least = leastDistance();
    if (!(distance > 0) || !std::isfinite(share)) return from.eye;
    const double wanted = share < 1 ? std::max(distance * share, std::min(distance, least))
                                    : std::max(distance, least) * share;
    const Vec3d eye = from.eye + offset * ((distance - wanted) / distance);
    const double farthest = std::max(kFarDiagonals * diagonal_, glm::length(from.eye - centre_));
    return share > 1 && !(glm::length(eye - centre_) <= farthest) ? from.eye : eye;
}

void Navigation::wheel(double steps, glm::dvec2 px, std::optional<Vec3d> surface) {
    if (!std::isfinite(steps) || !std::isfinite(px.x) || !std::isfinite(px.y)) return;
    stopMoves();
    const bool isGrabbed = surface && isFinite(*surface) && depthOf(*surface) > 0;
    if (isGrabbed) pivot_ = surface;
    const Vec3d point = isGrabbed ? *surface : pose_.eye + depthWithoutSurface() * rayOf(px);
    const double share = std::clamp(std::pow(kZoomPerStep, steps), 1 / kMostZoom, kMostZoom);
    CameraPose pose = pose_;
    pose.eye = zoomed(pose_, point, share);
    if (pose.eye == pose_.eye) return;
    if (drag_) drag_.reset();
    apply(pose);
}

}  // namespace pagoda::viewer
