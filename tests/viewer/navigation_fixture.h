// navigation_fixture.h: scenes and a projection of their own for the tests of Navigation.
#pragma once

#include "viewer/navigation.h"

#include <glm/glm.hpp>

#include <cmath>
#include <random>

namespace pagoda::viewer::test {

inline constexpr Vec3d kUpZ{0, 0, 1}, kUpY{0, 1, 0};

struct Axes {
    Vec3d right, up, forward;
};
inline Axes axesOf(const hlod::Camera& camera) {
    Axes axes;
    axes.forward = glm::normalize(camera.target - camera.eye);
    axes.right = glm::normalize(glm::cross(axes.forward, camera.up));
    axes.up = glm::cross(axes.right, axes.forward);
    return axes;
}

// By the definition of Camera, not by what is under test.
inline glm::dvec2 project(const hlod::Camera& camera, const Vec3d& point) {
    const Axes axes = axesOf(camera);
    const Vec3d offset = point - camera.eye;
    const double halfHeight = std::tan(camera.fovyDegrees * 3.14159265358979323846 / 360);
    const double scale = 0.5 * camera.heightPx / (glm::dot(offset, axes.forward) * halfHeight);
    return {0.5 * camera.widthPx + glm::dot(offset, axes.right) * scale,
            0.5 * camera.heightPx - glm::dot(offset, axes.up) * scale};
}

inline double depthOf(const hlod::Camera& camera, const Vec3d& point) {
    return glm::dot(point - camera.eye, axesOf(camera).forward);
}

inline bool isFinite(const hlod::Camera& camera) {
    bool isGood = std::isfinite(camera.fovyDegrees) && camera.eye != camera.target;
    for (int i = 0; i < 3; ++i) {
        isGood = isGood && std::isfinite(camera.eye[i]) && std::isfinite(camera.target[i]) &&
                 std::isfinite(camera.up[i]);
    }
    return isGood;
}

struct Place {
    double scale = 1;
    Vec3d origin{0.0};
    Vec3d up = kUpZ;
    [[nodiscard]] Box3d box() const { return {origin - Vec3d(scale), origin + Vec3d(scale)}; }
    [[nodiscard]] hlod::Camera home() const {
        hlod::Camera camera;
        camera.eye = origin + scale * Vec3d(2.0, -3.0, 1.5);
        camera.target = origin;
        camera.up = up;
        camera.widthPx = 800;
        camera.heightPx = 600;
        return camera;
    }
    [[nodiscard]] Navigation navigation() const { return {home(), box(), up}; }
    // What coordinates of this size can tell apart.
    [[nodiscard]] double roundingModelUnits() const {
        return 1e-15 * (glm::length(origin) + 100 * scale);
    }
};

// Small, plain, large and georeferenced scenes, and a millimetre's world a kilometre away.
inline constexpr Place kPlaces[] = {{1, Vec3d(0.0), kUpZ},
                                    {1e-6, Vec3d(0.0), kUpY},
                                    {1e6, Vec3d(3e5, -2e5, 1e5), kUpZ},
                                    {1, Vec3d(1e7, -1e7, 1e7), kUpY},
                                    {100, Vec3d(4.5e6, 5.4e6, 300), kUpZ},
                                    {1e-3, Vec3d(0, 1e3, 0), Vec3d(0.3, -0.2, 0.9)}};

class Dice {
public:
    explicit Dice(uint64_t seed) : random_(seed) {}
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
    }
    size_t below(size_t count) { return random_() % count; }
    glm::dvec2 px() { return {between(0, 800), between(0, 600)}; }
    Vec3d pointIn(const Box3d& box) {
        return {between(box.min.x, box.max.x), between(box.min.y, box.max.y),
                between(box.min.z, box.max.z)};
    }
    Vec3d direction() {
        while (true) {
            const Vec3d v = pointIn({Vec3d(-1.0), Vec3d(1.0)});
            if (glm::length(v) > 0.1 && glm::length(v) < 1) return glm::normalize(v);
        }
    }

private:
    std::mt19937_64 random_;
};

}  // namespace pagoda::viewer::test
