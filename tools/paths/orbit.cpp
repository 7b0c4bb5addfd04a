#include "tools/generate/random.h"
#include "tools/paths/makers.h"
#include "tools/paths/poses.h"
#include "tools/paths/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFovyDegrees = 45;
constexpr double kElevation = 0.35, kSway = 0.15;  // radians

// From where all of the box is in view, whatever the azimuth and elevation of the orbit, in a
// square picture and so in any wider one.
double orbitRadius(const PathScene& scene, double fovyDegrees) {
    constexpr double kMargin = 1.04;
    const Vec3d half = 0.5 * (scene.box.max - scene.box.min);
    const double tangent = std::tan(fovyDegrees * kPi / 360);
    double radius = 0;
    for (int i = 0; i < 90 * 8; ++i) {
        const Vec3d corner(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y,
                           i & 4 ? half.z : -half.z);
        const double azimuth = (i >> 3) * kPi / 45;
        for (const double elevation : {kElevation - kSway, kElevation, kElevation + kSway}) {
            const Vec3d outward = directionOf(azimuth, elevation);
            const Vec3d right(-std::sin(azimuth), std::cos(azimuth), 0);
            const double across = std::max(std::abs(glm::dot(corner, right)),
                                           std::abs(glm::dot(corner, glm::cross(outward, right))));
            radius = std::max(radius, kMargin * across / tangent + glm::dot(corner, outward));
        }
    }
    return radius;
}

}  // namespace

PathFrames makeOrbit(const PathScene& scene, const PathOptions& options) {
    Random random = Random(options.seed).fork(1);
    const double start = random.range(0.0, 2 * kPi), swayStart = random.range(0.0, 2 * kPi);
    // A degree of azimuth turns the gaze by its cosine of elevation only.
    const double least = kPi / 180 / std::cos(kElevation + kSway) * (1 + 1e-6);
    const double step =
        std::max(least, 2 * kPi / static_cast<double>(options.frames)) * options.speed;
    const double wide = options.fovyDegrees > 0 ? options.fovyDegrees : kFovyDegrees;
    const double fovy = 2 * std::atan(std::tan(wide * kPi / 360) / options.zoom) * 180 / kPi;
    const double radius = orbitRadius(scene, wide);
    const Vec3d centre = 0.5 * (scene.box.min + scene.box.max);
    PathFrames frames;
    for (size_t i = 0; i < options.frames; ++i) {
        const double turn = static_cast<double>(i) * step;
        // Two waves whose lengths share no multiple: no turn repeats another.
        const double sway = 0.6 * std::sin(swayStart + 1.618 * turn) + 0.4 * std::sin(0.577 * turn);
        const Vec3d outward = directionOf(start + turn, kElevation + kSway * sway);
        frames.push_back(cameraAt(scene, centre + radius * outward, -outward, radius, fovy));
    }
    return frames;
}

}  // namespace pagoda::tools
