// poses.h: from a finely sampled way to one pose a frame, each a step of bounded size.
// Upright space, model units. Pure functions.
#pragma once

#include "ooc/base/box.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace pagoda::tools {

struct Pose {
    Vec3d eye{0.0};
    Vec3d gaze{1.0, 0.0, 0.0};  // unit length
};

// What a frame changes at most, and at least by one of the two: so every frame shows something
// new, and none jumps.
struct Pace {
    double moveModelUnits = 0, turnDegrees = 0;
    double leastMoveModelUnits = 0, leastTurnDegrees = 1;
};

// Bounds with a margin for rounding: the least step is 0.2% of the diagonal or 1 degree.
[[nodiscard]] Pace paceOf(double moveModelUnits, double turnDegrees, double diagonalModelUnits);

using ClearTest = std::function<bool(const Vec3d& from, const Vec3d& to)>;

// Poses along the samples, joined by straight lines, from the first one on: each as far on as
// `pace` lets it. Where the straight line between two eyes is not clear, the step is shortened
// towards the least one. At most `frames`; fewer where the samples end, unless the way `isClosed`.
[[nodiscard]] std::vector<Pose> march(const std::vector<Pose>& samples, const Pace& pace,
                                      size_t frames, bool isClosed, const ClearTest& isClear = {});

// Gaussian average over neighbours; ends are mirrored, or joined when `isClosed`.
[[nodiscard]] std::vector<Vec3d> smoothed(const std::vector<Vec3d>& values, double sigmaSamples,
                                          bool isClosed);
[[nodiscard]] std::vector<double> smoothed(const std::vector<double>& values, double sigmaSamples);

// Points `spacing` apart along the polyline (the last step may be shorter).
[[nodiscard]] std::vector<Vec3d> resampled(const std::vector<Vec3d>& points, double spacing);

[[nodiscard]] double degreesBetween(const Vec3d& a, const Vec3d& b);
// Azimuth from +x, elevation from the horizontal.
[[nodiscard]] Vec3d directionOf(double azimuthRadians, double elevationRadians);

}  // namespace pagoda::tools
