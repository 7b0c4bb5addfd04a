#include "hlod/view/screen_box.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

namespace pagoda::hlod {
namespace {

using Point = glm::dvec2;

// Corner i has bits x, y, z of i; pixels from the top left, depth along the direction of view.
struct Projected {
    std::array<Point, 8> corners;
    double nearest = std::numeric_limits<double>::max();
};

Projected project(const View& view, const Box3d& box) {
    const double scaleX = 0.5 * view.camera().widthPx, scaleY = 0.5 * view.camera().heightPx;
    Projected projected;
    for (size_t i = 0; i < 8; ++i) {
        const Vec3d corner((i & 1) != 0 ? box.max.x : box.min.x,
                           (i & 2) != 0 ? box.max.y : box.min.y,
                           (i & 4) != 0 ? box.max.z : box.min.z);
        const Vec3d offset = corner - view.eye();
        const double depth = glm::dot(view.forward(), offset);
        assert(depth > 0.0);
        projected.nearest = std::min(projected.nearest, depth);
        projected.corners[i] = {
            scaleX * (1.0 + glm::dot(view.right(), offset) / (depth * view.tanX())),
            scaleY * (1.0 - glm::dot(view.up(), offset) / (depth * view.tanY()))};
    }
    return projected;
}

double cross(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Polygons of at most 8 corners, one more for each side they are clipped by.
struct Polygon {
    std::array<Point, 16> points;
    size_t count = 0;
    void add(const Point& point) { points[count++] = point; }
};

// Monotone chain.
Polygon convexHull(std::array<Point, 8> points) {
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    Polygon hull;
    const auto addTurning = [&](const Point& point, size_t least) {
        while (hull.count > least &&
               cross(hull.points[hull.count - 2], hull.points[hull.count - 1], point) <= 0.0) {
            --hull.count;
        }
        hull.add(point);
    };
    for (size_t i = 0; i < 8; ++i) addTurning(points[i], 1);
    const size_t lower = hull.count;
    for (size_t i = 7; i-- > 0;) addTurning(points[i], lower);
    --hull.count;  // the first point again
    return hull;
}

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

}  // namespace

bool crossesNear(const View& view, const Box3d& box) {
    const Vec3d centre = 0.5 * (box.min + box.max) - view.eye();
    const Vec3d halfSize = 0.5 * (box.max - box.min);
    return glm::dot(view.forward(), centre) - glm::dot(glm::abs(view.forward()), halfSize) <=
           view.nearModelUnits();
}

double boxPixels(const View& view, const Box3d& box) {
    Polygon hull = convexHull(project(view, box).corners);
    const double width = view.camera().widthPx, height = view.camera().heightPx;
    hull = clip(hull, 0, -1.0, 0.0);
    hull = clip(hull, 0, 1.0, width);
    hull = clip(hull, 1, -1.0, 0.0);
    hull = clip(hull, 1, 1.0, height);
    return std::max(area(hull), 0.0);
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
