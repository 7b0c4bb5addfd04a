// box.h: axis-aligned boxes, closed on both sides. Box3i holds lattice points, Box3d model units.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <limits>

namespace pagoda {

using Vec3d = glm::dvec3;
using Vec3f = glm::vec3;
using Vec3i = glm::ivec3;

template <typename Scalar>
struct Box3 {
    using Point = glm::vec<3, Scalar, glm::defaultp>;

    // Empty until extended: min > max.
    Point min{std::numeric_limits<Scalar>::max()};
    Point max{std::numeric_limits<Scalar>::lowest()};

    [[nodiscard]] bool isEmpty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
    void extend(const Point& point) {
        min = glm::min(min, point);
        max = glm::max(max, point);
    }
    void extend(const Box3& other) {
        min = glm::min(min, other.min);
        max = glm::max(max, other.max);
    }
    [[nodiscard]] bool contains(const Point& point) const {
        return glm::all(glm::lessThanEqual(min, point)) && glm::all(glm::lessThanEqual(point, max));
    }
    [[nodiscard]] bool contains(const Box3& other) const {
        return contains(other.min) && contains(other.max);
    }
    [[nodiscard]] bool operator==(const Box3& other) const = default;
};

using Box3d = Box3<double>;
using Box3i = Box3<int32_t>;

}  // namespace pagoda
