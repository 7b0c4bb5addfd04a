#include "viewer/section.h"

#include <algorithm>
#include <cmath>

namespace pagoda::viewer {
namespace {

// Least and greatest of dot(normal, point) over the box.
struct Span {
    double least, most;
    Span(const Vec3d& normal, const Box3d& box) {
        const double middle = glm::dot(normal, 0.5 * (box.min + box.max));
        const double half = glm::dot(glm::abs(normal), 0.5 * (box.max - box.min));
        least = middle - half;
        most = middle + half;
    }
};

}  // namespace

Vec3d Section::normal() const {
    const double azimuth = glm::radians(azimuthDegrees), elevation = glm::radians(elevationDegrees);
    Vec3d normal(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                 std::sin(elevation));
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(normal[axis]) < 1e-12) normal[axis] = 0.0;  // along axes exactly
    }
    return glm::normalize(normal);
}

hlod::SectionPlane Section::plane(const Box3d& sceneBox) const {
    const Vec3d n = normal();
    const Span span(n, sceneBox);
    return {n, glm::mix(span.least, span.most, share)};
}

void Section::setNormal(const Vec3d& normal) {
    const Vec3d n = glm::normalize(normal);
    azimuthDegrees = glm::degrees(std::atan2(n.y, n.x));
    elevationDegrees = glm::degrees(std::asin(std::clamp(n.z, -1.0, 1.0)));
}

void Section::setPlane(const Vec3d& normal, const Vec3d& point, const Box3d& sceneBox) {
    setNormal(normal);
    const Vec3d n = this->normal();
    const Span span(n, sceneBox);
    const double length = span.most - span.least;
    share = length > 0.0 ? std::clamp((glm::dot(n, point) - span.least) / length, 0.0, 1.0) : 0.5;
}

void Section::flip() {
    setNormal(-normal());
    share = 1.0 - share;
}

}  // namespace pagoda::viewer
