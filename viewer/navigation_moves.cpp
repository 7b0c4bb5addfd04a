// Navigation over time: keys that move, and transitions.
#include "viewer/navigation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pagoda::viewer {
namespace {

constexpr double kEaseS = 0.08;          // a velocity is reached, or lost, by this time constant
constexpr double kStillShare = 1e-3;     // of the speed: slower is standing still
constexpr double kLongestFrameS = 0.25;  // a hitch must not carry the eye through a wall
// Of what is seen, in a second.
constexpr double kDistancesPerSecond = 0.7;
constexpr double kLeastDiagonalsPerSecond = 1e-4, kMostDiagonalsPerSecond = 1.0;
constexpr double kBlindDiagonalsPerSecond = 0.1;

int sign(bool plus, bool minus) {
    return int{plus} - int{minus};
}

}  // namespace

void Navigation::setKeys(const MoveKeys& keys) {
    keys_ = keys;
    if (wishedVelocity() != Vec3d(0.0)) transition_.reset();
}

void Navigation::setSpeedFactor(double factor) {
    if (std::isnan(factor)) return;
    speedFactor_ = std::clamp(factor, 1e-3, 1e3);
}

void Navigation::setDistanceSeen(double modelUnits) {
    if (std::isnan(modelUnits)) return;
    distanceSeen_ = std::max(modelUnits, 0.0);
}

double Navigation::speedModelUnitsPerSecond() const {
    const double seen =
        std::isfinite(distanceSeen_)
            ? std::clamp(kDistancesPerSecond * distanceSeen_, kLeastDiagonalsPerSecond * diagonal_,
                         kMostDiagonalsPerSecond * diagonal_)
            : kBlindDiagonalsPerSecond * diagonal_;
    return seen * speedFactor_ * (keys_.fast ? 4 : 1) * (keys_.slow ? 0.25 : 1);
}

Vec3d Navigation::wishedVelocity() const {
    if (mode_ == NavigationMode::Orbit) return Vec3d(0.0);
    ViewAxes axes = axes_;
    if (mode_ == NavigationMode::Walk) axes = axesOf(frame_, {pose_.attitude.yaw, 0, 0});
    const Vec3d direction = double(sign(keys_.forward, keys_.back)) * axes.forward +
                            double(sign(keys_.right, keys_.left)) * axes.right +
                            double(sign(keys_.up, keys_.down)) * frame_.up;
    const double length = glm::length(direction);
    // Forward against up cancels when one looks straight down.
    return length > 1e-6 ? direction * (speedModelUnitsPerSecond() / length) : Vec3d(0.0);
}

bool Navigation::update(double seconds) {
    if (!(seconds > 0)) seconds = 0;
    const bool isMoving = transition_ ? advanceTransition(seconds) : advanceMove(seconds);
    const bool hasChanged = hasChanged_;
    hasChanged_ = false;
    return isMoving || hasChanged;
}

// Integrated exactly, so that the way does not depend on the frames it is cut into.
bool Navigation::advanceMove(double seconds) {
    const Vec3d wished = wishedVelocity();
    if (wished == Vec3d(0.0) && velocity_ == Vec3d(0.0)) return false;
    seconds = std::min(seconds, kLongestFrameS);
    const double kept = std::exp(-seconds / kEaseS);
    const Vec3d lag = velocity_ - wished;
    const Vec3d step = wished * seconds + lag * (kEaseS * (1 - kept));
    velocity_ = wished + lag * kept;
    const bool isStill =
        wished == Vec3d(0.0) && glm::length(velocity_) <= kStillShare * speedModelUnitsPerSecond();
    if (isStill) velocity_ = Vec3d(0.0);
    if (drag_) {
        drag_->start.eye += step;
        drag_->pivot += step;
    }
    CameraPose pose = pose_;
    pose.eye += step;
    apply(pose);
    return true;
}

bool Navigation::advanceTransition(double seconds) {
    const CameraPose pose = transition_->advance(seconds);
    if (transition_->isDone()) {
        transition_.reset();
        if (transitionEnd_) {
            adopt(*transitionEnd_);
            return true;
        }
    }
    apply(pose);
    return true;
}

void Navigation::frame(const Box3d& boxModel) {
    frameFrom({pose_.attitude.yaw, pose_.attitude.pitch, 0}, boxModel);
}

void Navigation::axisView(AxisView view) {
    constexpr double kQuarter = std::numbers::pi / 2;
    Attitude attitude{kQuarter, 0, 0};
    switch (view) {
        case AxisView::Front:
            break;
        case AxisView::Back:
            attitude.yaw = -kQuarter;
            break;
        case AxisView::Left:
            attitude.yaw = 0;
            break;
        case AxisView::Right:
            attitude.yaw = 2 * kQuarter;
            break;
        case AxisView::Top:
            attitude.pitch = -kQuarter;
            break;
        case AxisView::Bottom:
            attitude.pitch = kQuarter;
            break;
        case AxisView::Isometric:  // as viewDirection()'s "iso"
            attitude = levelAttitude(
                frame_, -glm::normalize(0.8 * frame_.right - frame_.into + 0.7 * frame_.up));
            break;
    }
    frameFrom(attitude, scene_);
}

void Navigation::frameFrom(const Attitude& attitude, const Box3d& boxModel) {
    Box3d box = isUsable(boxModel) ? boxModel : scene_;
    if (!isUsable(box)) box = {centre_, centre_};
    const double leastSize = 1e-3 * diagonal_;
    if (!(glm::length(box.max - box.min) > leastSize)) {  // a point: something round it
        box.min -= Vec3d(0.5 * leastSize);
        box.max += Vec3d(0.5 * leastSize);
    }
    const ViewAxes axes = axesOf(frame_, attitude);
    const hlod::Camera framed = hlod::frameBox(camera_, box, -axes.forward, axes.up);
    const Vec3d middle = 0.5 * box.min + 0.5 * box.max;
    const double ahead = glm::dot(middle - framed.eye, axes.forward);
    pivot_ = middle;
    transitTo({framed.eye, attitude, pose_.fovyDegrees}, ahead, std::nullopt);
}

void Navigation::goTo(const hlod::Camera& camera) {
    if (!isUsable(camera)) return;
    transitTo({camera.eye, attitudeOf(frame_, camera), camera.fovyDegrees},
              glm::length(camera.target - camera.eye), camera);
}

// Without `end` it ends at the pose alone.
void Navigation::transitTo(const CameraPose& pose, double aheadModelUnits,
                           std::optional<hlod::Camera> end) {
    stopMoves();
    drag_.reset();
    // Round what both look at, as far as there is such a thing.
    const Vec3d focus = pose.eye + aheadModelUnits * axesOf(frame_, pose.attitude).forward;
    const double fromAhead = isInPicture(focus) ? depthOf(focus) : depthOf(pivotWithoutSurface());
    const double least = leastDistance();
    transition_.emplace(frame_, pose_, std::max(fromAhead, least), pose,
                        std::max(aheadModelUnits, least));
    transitionEnd_ = end;
}

void Navigation::jumpTo(const hlod::Camera& camera) {
    if (!isUsable(camera)) return;
    stopMoves();
    drag_.reset();
    adopt(camera);
}

}  // namespace pagoda::viewer
