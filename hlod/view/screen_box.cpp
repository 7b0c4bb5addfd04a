#include "hlod/view/screen_box.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace pagoda::hlod {
namespace {

using Point = glm::dvec2;

// Corner i has bits x, y, z of i; pixels from the top left, depth along the direction of view.
struct Projected {
    std::array<Point, 8> corners;
    double nearest = std::numeric_limits<double>::max();
};

// What one of the box's two ends on each axis adds to a coordinate along `direction`.
struct Shares {
    std::array<Vec3d, 2> ends;
    Shares(const Vec3d& direction, const Vec3d& least, const Vec3d& most)
        : ends{direction * least, direction * most} {}
    [[nodiscard]] double at(size_t corner) const {
        return ends[corner & 1].x + ends[(corner >> 1) & 1].y + ends[(corner >> 2) & 1].z;
    }
};

Projected project(const View& view, const Box3d& box) {
    const double scaleX = 0.5 * view.camera().widthPx, scaleY = 0.5 * view.camera().heightPx;
    const Vec3d least = box.min - view.eye(), most = box.max - view.eye();
    const Shares forward(view.forward(), least, most), right(view.right(), least, most),
        up(view.up(), least, most);
    Projected projected;
    for (size_t i = 0; i < 8; ++i) {
        const double depth = forward.at(i);
        assert(depth > 0.0);
        projected.nearest = std::min(projected.nearest, depth);
        projected.corners[i] = {scaleX * (1.0 + right.at(i) / (depth * view.tanX())),
                                scaleY * (1.0 - up.at(i) / (depth * view.tanY()))};
    }
    return projected;
}

double cross(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// A quad has at most one corner more for each side it is clipped by; rounding may add some.
struct Polygon {
    std::array<Point, 16> points;
    size_t count = 0;
    void add(const Point& point) { points[count++] = point; }
};

// Keeps what lies on the side of the line where sign * (coordinate - limit) <= 0.
Polygon clip(const Polygon& polygon, glm::length_t axis, double sign, double limit) {
    Polygon clipped;
    for (size_t i = 0; i < polygon.count; ++i) {
        const Point &a = polygon.points[i], &b = polygon.points[(i + 1) % polygon.count];
        const double outA = sign * (a[axis] - limit), outB = sign * (b[axis] - limit);
        if (outA <= 0.0) clipped.add(a);
        if ((outA < 0.0 && outB > 0.0) || (outA > 0.0 && outB < 0.0)) {
            clipped.add(a + (b - a) * (outA / (outA - outB)));
        }
    }
    return clipped;
}

double area(const Polygon& polygon) {
    double twice = 0.0;
    for (size_t i = 2; i < polygon.count; ++i) {
        twice += cross(polygon.points[0], polygon.points[i - 1], polygon.points[i]);
    }
    return 0.5 * twice;
}

double areaInside(Polygon polygon, double width, double height) {
    polygon = clip(polygon, 0, -1.0, 0.0);
    polygon = clip(polygon, 0, 1.0, width);
    polygon = clip(polygon, 1, -1.0, 0.0);
    polygon = clip(polygon, 1, 1.0, height);
    return area(polygon);
}

// Corners around the faces: least and greatest x, y, z.
constexpr size_t kFaces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                 {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};

bool isInside(const std::array<Point, 8>& corners, double width, double height) {
    return std::all_of(corners.begin(), corners.end(), [&](const Point& point) {
        return point.x >= 0.0 && point.x <= width && point.y >= 0.0 && point.y <= height;
    });
}

}  // namespace

bool crossesNear(const View& view, const Box3d& box) {
    const Vec3d centre = 0.5 * (box.min + box.max) - view.eye();
    const Vec3d halfSize = 0.5 * (box.max - box.min);
    return glm::dot(view.forward(), centre) - glm::dot(glm::abs(view.forward()), halfSize) <=
           view.nearModelUnits();
}

// The faces that the eye is in front of tile the outline.
double boxPixels(const View& view, const Box3d& box) {
    const std::array<Point, 8> corners = project(view, box).corners;
    const double width = view.camera().widthPx, height = view.camera().heightPx;
    const bool isWhole = isInside(corners, width, height);
    double pixels = 0.0;
    for (size_t face = 0; face < 6; ++face) {
        const auto axis = static_cast<glm::length_t>(face / 2);
        const bool isSeen =
            face % 2 == 0 ? view.eye()[axis] < box.min[axis] : view.eye()[axis] > box.max[axis];
        if (!isSeen) continue;
        Polygon quad;
        for (const size_t corner : kFaces[face]) quad.add(corners[corner]);
        pixels += std::abs(isWhole ? area(quad) : areaInside(quad, width, height));
    }
    return pixels;
}

ScreenRect screenRect(const View& view, const Box3d& box) {
    const Projected projected = project(view, box);
    Point least = projected.corners[0], most = projected.corners[0];
    for (const Point& corner : projected.corners) {
        least = glm::min(least, corner);
        most = glm::max(most, corner);
    }
    const Point size(view.camera().widthPx, view.camera().heightPx);
    least = glm::max(least, Point(0.0));
    most = glm::min(most, size);
    return {least.x, least.y, most.x, most.y, projected.nearest};
}

}  // namespace pagoda::hlod
