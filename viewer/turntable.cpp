#include "viewer/turntable.h"

#include <cmath>
#include <numbers>

namespace pagoda::viewer {
namespace {

// Sine of the angle to the vertical below which a direction has no heading of its own.
constexpr double kVertical = 1e-6;
// Rounding, not roll: a camera's own axes come from target - eye.
constexpr double kLevel = 1e-7;

double shortWay(double radians) {
    return std::remainder(radians, 2 * std::numbers::pi);
}

}  // namespace

UpFrame upFrame(const Vec3d& up) {
    UpFrame frame;
    const Vec3d scaled = up / glm::max(glm::max(std::abs(up.x), std::abs(up.y)), std::abs(up.z));
    frame.up = glm::normalize(scaled);
    const Vec3d aside = std::abs(frame.up.x) < 0.9 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    frame.right = glm::normalize(aside - glm::dot(aside, frame.up) * frame.up);
    frame.into = glm::cross(frame.up, frame.right);
    return frame;
}

ViewAxes axesOf(const UpFrame& frame, const Attitude& attitude) {
    const double cosYaw = std::cos(attitude.yaw), sinYaw = std::sin(attitude.yaw);
    const Vec3d heading = cosYaw * frame.right + sinYaw * frame.into;
    const Vec3d level = sinYaw * frame.right - cosYaw * frame.into;
    const double cosPitch = std::cos(attitude.pitch), sinPitch = std::sin(attitude.pitch);
    ViewAxes axes;
    axes.forward = cosPitch * heading + sinPitch * frame.up;
    const Vec3d above = cosPitch * frame.up - sinPitch * heading;
    axes.right = level;
    axes.up = above;
    if (attitude.roll != 0.0) {
        const double cosRoll = std::cos(attitude.roll), sinRoll = std::sin(attitude.roll);
        axes.right = cosRoll * level - sinRoll * above;
        axes.up = sinRoll * level + cosRoll * above;
    }
    return axes;
}

Attitude levelAttitude(const UpFrame& frame, const Vec3d& forward) {
    const double x = glm::dot(forward, frame.right), y = glm::dot(forward, frame.into);
    const double z = glm::dot(forward, frame.up), flat = std::hypot(x, y);
    const bool hasHeading = flat > kVertical;
    return {hasHeading ? std::atan2(y, x) : std::numbers::pi / 2, std::atan2(z, flat), 0};
}

Attitude attitudeOf(const UpFrame& frame, const hlod::Camera& camera) {
    const hlod::View view(camera, {});
    Attitude attitude = levelAttitude(frame, view.forward());
    const bool isVertical = std::cos(attitude.pitch) <= kVertical;
    if (isVertical) {
        attitude.yaw =
            std::atan2(glm::dot(view.right(), frame.right), -glm::dot(view.right(), frame.into));
    }
    const ViewAxes level = axesOf(frame, attitude);
    attitude.roll =
        std::atan2(-glm::dot(view.right(), level.up), glm::dot(view.right(), level.right));
    if (std::abs(attitude.roll) < kLevel) attitude.roll = 0;
    return attitude;
}

Attitude between(const Attitude& a, const Attitude& b, double t) {
    return {a.yaw + t * shortWay(b.yaw - a.yaw), a.pitch + t * (b.pitch - a.pitch),
            a.roll + t * shortWay(b.roll - a.roll)};
}

bool isFinite(const Vec3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool isUsable(const hlod::Camera& camera) {
    return isFinite(camera.eye) && isFinite(camera.target) && isFinite(camera.up) &&
           camera.eye != camera.target && camera.fovyDegrees > 0 && camera.fovyDegrees < 180 &&
           std::isfinite(camera.nearModelUnits);
}

bool isUsable(const Box3d& box) {
    return !box.isEmpty() && isFinite(box.min) && isFinite(box.max) &&
           std::isfinite(glm::length(box.max - box.min));
}

}  // namespace pagoda::viewer
