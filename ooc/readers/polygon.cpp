#include "ooc/readers/polygon.h"

#include <cmath>

namespace pagoda::ooc {
namespace {

constexpr int64_t kTestsPerSquare = 8;  // plain outlines take about three

// Twice the signed area of the triangle.
double area2(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

}  // namespace

std::span<const PolygonCutter::Triangle> PolygonCutter::cut(std::span<const Vec3d> corners) {
    triangles_.clear();
    if (corners.size() < 3) return triangles_;
    if (corners.size() == 3 || corners.size() > kMaxCutCorners || !project(corners) || isConvex()) {
        fan(corners.size());
    } else {
        clipEars();
    }
    return triangles_;
}

void PolygonCutter::fan(size_t cornerCount) {
    triangles_.reserve(cornerCount - 2);
    for (uint32_t k = 2; k < cornerCount; ++k) triangles_.push_back({0, k - 1, k});
}

// Drops the axis along which the polygon's area vector (Newell) is longest; the two others are
// ordered so that the outline is counter-clockwise. False: no area, or not finite.
bool PolygonCutter::project(std::span<const Vec3d> corners) {
    const Vec3d origin = corners[0];  // near it, so that far away from zero nothing cancels
    Vec3d area(0);
    for (size_t k = 1; k + 1 < corners.size(); ++k) {
        area += glm::cross(corners[k] - origin, corners[k + 1] - origin);
    }
    const Vec3d size = glm::abs(area);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (!(size[axis] > 0.0) || !std::isfinite(size.x + size.y + size.z)) return false;
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    const bool isFlipped = area[axis] < 0.0;
    points_.clear();
    for (const Vec3d& corner : corners) {
        const Vec3d local = corner - origin;
        points_.push_back(isFlipped ? Point(local[second], local[first])
                                    : Point(local[first], local[second]));
    }
    return true;
}

// Left turns only: a fan over a straight corner would leave a triangle without area. An outline
// that winds twice around passes as well; its fan is as good as any cut.
bool PolygonCutter::isConvex() const {
    const size_t n = points_.size();
    for (size_t k = 0; k < n; ++k) {
        if (area2(points_[k], points_[(k + 1) % n], points_[(k + 2) % n]) <= 0.0) return false;
    }
    return true;
}

// Candidates wait in a queue: at first all corners, then those beside a cut, which a cut can make
// ears (Eberly 1998). Corners freed in other ways show when the queue is empty and all that are
// left enter it again. Straight corners are cut only when nothing else is, since their triangles
// have no area. Hostile outlines could cost n^3, so the tests are bounded.
void PolygonCutter::clipEars() {
    const auto n = static_cast<uint32_t>(points_.size());
    previous_.resize(n);
    next_.resize(n);
    for (uint32_t k = 0; k < n; ++k) {
        previous_[k] = (k + n - 1) % n;
        next_[k] = (k + 1) % n;
    }
    uint32_t first = 0, left = n;  // a corner that is there, and how many are
    bool hasCut = true, takesStraight = false;
    int64_t testsLeft = kTestsPerSquare * n * n;
    queue_.clear();
    for (size_t at = 0; left > 3 && testsLeft > 0; ++at) {
        if (at == queue_.size()) {
            if (!hasCut && takesStraight) break;  // the outline crosses itself
            takesStraight = !hasCut;
            hasCut = false;
            queue_.clear();
            at = 0;
            for (uint32_t k = first, count = 0; count < left; k = next_[k], ++count) {
                queue_.push_back(k);
            }
        }
        const uint32_t corner = queue_[at];
        if (next_[corner] == corner) continue;  // cut already
        testsLeft -= left;
        if (!isEar(corner, takesStraight)) continue;
        const uint32_t before = previous_[corner], after = next_[corner];
        triangles_.push_back({before, corner, after});
        next_[before] = after;
        previous_[after] = before;
        next_[corner] = corner;
        first = after;
        --left;
        hasCut = true;
        if (takesStraight) queue_.resize(at + 1);  // better ones may be there again
        takesStraight = false;
        queue_.push_back(before);
        queue_.push_back(after);
    }
    for (uint32_t k = next_[first]; next_[k] != first; k = next_[k]) {
        triangles_.push_back({first, k, next_[k]});
    }
}

// A left turn (or a straight one) with no other corner inside or on the new edge. Corners at the
// same place as the ear's own are no obstacle: bridges to holes have them.
bool PolygonCutter::isEar(uint32_t corner, bool takesStraight) const {
    const uint32_t before = previous_[corner], after = next_[corner];
    const Point &a = points_[before], &b = points_[corner], &c = points_[after];
    const double turn = area2(a, b, c);
    if (turn < 0.0) return false;
    if (turn == 0.0) return takesStraight && glm::dot(a - b, c - b) <= 0.0;  // no spike back
    for (uint32_t k = next_[after]; k != before; k = next_[k]) {
        const Point& p = points_[k];
        if (p == a || p == b || p == c) continue;
        if (area2(a, b, p) >= 0.0 && area2(b, c, p) >= 0.0 && area2(c, a, p) >= 0.0) return false;
    }
    return true;
}

}  // namespace pagoda::ooc
