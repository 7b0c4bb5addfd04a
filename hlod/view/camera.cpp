#include "hlod/view/camera.h"

#include "ooc/base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pagoda::hlod {
namespace {

// Share of the picture's half size that a framed box may fill.
constexpr double kFrameFill = 0.94;

struct Axes {
    Vec3d right, up, forward;
};

Axes makeAxes(const Vec3d& toTarget, const Vec3d& upHint) {
    Axes axes;
    axes.forward = glm::normalize(toTarget);
    axes.right = glm::cross(axes.forward, upHint);
    if (!(glm::length(axes.right) > 1e-9 * glm::length(upHint))) {
        // Looking along the up vector: any right vector will do, the same one each time.
        const Vec3d other = std::abs(axes.forward.y) < 0.9
                                ? Vec3d(0, 1, 0)
                                : Vec3d(0, 0, axes.forward.y > 0 ? 1 : -1);
        axes.right = glm::cross(axes.forward, other);
    }
    axes.right = glm::normalize(axes.right);
    axes.up = glm::cross(axes.right, axes.forward);
    return axes;
}

std::array<Vec3d, 8> corners(const Box3d& box) {
    std::array<Vec3d, 8> points;
    for (size_t i = 0; i < 8; ++i) {
        points[i] = {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                     (i & 4) != 0 ? box.max.z : box.min.z};
    }
    return points;
}

// "+x-y": sums the named half axes; zero vector when the name is not of this form.
Vec3d signedAxes(std::string_view name) {
    Vec3d direction(0.0);
    if (name.empty() || name.size() % 2 != 0) return direction;
    for (size_t i = 0; i < name.size(); i += 2) {
        const int axis = name[i + 1] - 'x';
        if ((name[i] != '+' && name[i] != '-') || axis < 0 || axis > 2) return Vec3d(0.0);
        if (direction[axis] != 0.0) return Vec3d(0.0);
        direction[axis] = name[i] == '+' ? 1.0 : -1.0;
    }
    return direction;
}

}  // namespace

Vec3d upVector(UpAxis up) {
    return up == UpAxis::Y ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1);
}

Vec3d viewDirection(std::string_view name, UpAxis up) {
    const Vec3d above = upVector(up);
    const Vec3d front = up == UpAxis::Y ? Vec3d(0, 0, 1) : Vec3d(0, -1, 0);
    const Vec3d right(1, 0, 0);
    Vec3d direction = signedAxes(name);
    if (name == "front") direction = front;
    if (name == "back") direction = -front;
    if (name == "right") direction = right;
    if (name == "left") direction = -right;
    if (name == "top") direction = above;
    if (name == "bottom") direction = -above;
    if (name == "iso") direction = 0.8 * right + front + 0.7 * above;
    if (direction == Vec3d(0.0)) {
        throw Error("", "", "no view is called '" + std::string(name) + "'",
                    "use front, back, left, right, top, bottom, iso, or a corner such as +x+y+z");
    }
    return glm::normalize(direction);
}

Camera frameBox(const Camera& camera, const Box3d& box, const Vec3d& direction, UpAxis up) {
    // From above or below, the picture's up is where the front view looks: away from the viewer.
    const Vec3d above = upVector(up);
    const bool isVertical = std::abs(glm::dot(direction, above)) > 0.999;
    const Vec3d intoFront = up == UpAxis::Y ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0);
    const double side = glm::dot(direction, above) > 0 ? 1.0 : -1.0;
    return frameBox(camera, box, direction, isVertical ? intoFront * side : above);
}

Camera frameBox(const Camera& camera, const Box3d& box, const Vec3d& direction, const Vec3d& up) {
    Camera framed = camera;
    const Vec3d centre = box.isEmpty() ? Vec3d(0.0) : 0.5 * (box.min + box.max);
    framed.up = up;
    const Axes axes = makeAxes(-direction, framed.up);
    const double tanY = std::tan(glm::radians(camera.fovyDegrees) / 2) * kFrameFill;
    const double tanX = tanY * camera.widthPx / camera.heightPx;
    // Sides of the frustum as lines in (x, depth) and (y, depth) that must enclose every corner:
    // the nearest eye, moved sideways so that the box is in the middle of the picture.
    const double tans[2] = {tanX, tanY};
    const Vec3d sideways[2] = {axes.right, axes.up};
    double least[2], most[2], eyeDistance = 0.0;
    for (size_t i = 0; i < 2 && !box.isEmpty(); ++i) {
        least[i] = std::numeric_limits<double>::max();
        most[i] = std::numeric_limits<double>::lowest();
        for (const Vec3d& corner : corners(box)) {
            const double across = glm::dot(sideways[i], corner - centre);
            const double widening = glm::dot(axes.forward, corner - centre) * tans[i];
            least[i] = std::min(least[i], across + widening);
            most[i] = std::max(most[i], across - widening);
        }
        eyeDistance = std::max(eyeDistance, (most[i] - least[i]) / (2 * tans[i]));
    }
    framed.target = centre;
    if (eyeDistance > 0.0) {
        framed.target +=
            0.5 * (least[0] + most[0]) * axes.right + 0.5 * (least[1] + most[1]) * axes.up;
    } else {
        eyeDistance = 1.0;
    }
    framed.eye = framed.target + direction * eyeDistance;
    return framed;
}

View::View(const Camera& camera, const Box3d& sceneBox, const Clip& clip)
    : camera_(camera), clip_(clip) {
    const Axes axes = makeAxes(camera.target - camera.eye, camera.up);
    right_ = axes.right;
    up_ = axes.up;
    forward_ = axes.forward;
    tanY_ = std::tan(glm::radians(camera.fovyDegrees) / 2);
    tanX_ = tanY_ * camera.widthPx / camera.heightPx;
    sideNormals_ = {glm::normalize(forward_ * tanX_ + right_),
                    glm::normalize(forward_ * tanX_ - right_),
                    glm::normalize(forward_ * tanY_ + up_), glm::normalize(forward_ * tanY_ - up_)};
    near_ = camera.nearModelUnits;
    if (near_ > 0.0) return;
    if (sceneBox.isEmpty()) {
        near_ = 1e-3;
        return;
    }
    // A point at distance d inside the frustum lies at least d * cosCorner before the eye's plane.
    const double cosCorner = 1.0 / std::sqrt(1.0 + tanX_ * tanX_ + tanY_ * tanY_);
    const double diagonal = glm::length(sceneBox.max - sceneBox.min);
    near_ = std::max(0.9 * cosCorner * distanceTo(sceneBox), 1e-6 * diagonal);
    if (!(near_ > 0.0)) near_ = 1e-3;
}

bool View::intersectsFrustum(const Box3d& box) const {
    const Vec3d centre = 0.5 * (box.min + box.max) - camera_.eye;
    const Vec3d halfSize = 0.5 * (box.max - box.min);
    for (const Vec3d& normal : sideNormals_) {
        if (glm::dot(normal, centre) + glm::dot(glm::abs(normal), halfSize) < 0.0) return false;
    }
    if (glm::dot(forward_, centre) + glm::dot(glm::abs(forward_), halfSize) < near_) return false;
    return !clip_.removes(box);
}

double View::ssePx(double errorModelUnits, const Box3d& box) const {
    if (!(errorModelUnits > 0.0)) return 0.0;
    const double eyeDistance = std::max(distanceTo(box), near_);
    return errorModelUnits * camera_.heightPx / (2.0 * tanY_ * eyeDistance);
}

double View::distanceTo(const Box3d& box) const {
    return distance(camera_.eye, box);
}

double distance(const Vec3d& point, const Box3d& box) {
    const Vec3d outside = glm::max(glm::max(box.min - point, point - box.max), Vec3d(0.0));
    return glm::length(outside);
}

}  // namespace pagoda::hlod
