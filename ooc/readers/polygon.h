// polygon.h: cuts polygons into triangles, also concave ones and such as are not quite flat.
#pragma once

#include "ooc/base/box.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::ooc {

// Ear clipping takes time with the square of the corners; polygons of more are cut as a fan.
inline constexpr size_t kMaxCutCorners = 1024;

// Keeps its buffers between polygons. One thread.
class PolygonCutter {
public:
    using Triangle = std::array<uint32_t, 3>;  // places in `corners`, in the polygon's sense

    // Always n - 2 triangles for n >= 3 corners, none below; convex polygons and those of more than
    // kMaxCutCorners (or with a corner that is not finite) as a fan from the first corner, others
    // by ear clipping in the plane that fits best. Where no ear is left (the outline crosses
    // itself) the rest is a fan. Valid until the next call.
    [[nodiscard]] std::span<const Triangle> cut(std::span<const Vec3d> corners);

private:
    using Point = glm::dvec2;

    void fan(size_t cornerCount);
    [[nodiscard]] bool project(std::span<const Vec3d> corners);
    [[nodiscard]] bool isConvex() const;
    void clipEars();
    [[nodiscard]] bool isEar(uint32_t corner, bool takesStraight) const;

    std::vector<Point> points_;              // counter-clockwise
    std::vector<uint32_t> previous_, next_;  // a ring; next_ of a cut corner is itself
    std::vector<uint32_t> queue_;
    std::vector<Triangle> triangles_;
};

}  // namespace pagoda::ooc
