// turntable.h: where a camera looks, as angles about the world's up: without roll the horizon is
// level, and straight up and down are no special places. Radians; pure functions.
#pragma once

#include "hlod/view/camera.h"

namespace pagoda::viewer {

// The world seen from the front: orthonormal, right-handed (right x into = up). Z up gives x and y,
// y up gives x and -z.
struct UpFrame {
    Vec3d right{1, 0, 0}, into{0, 1, 0}, up{0, 0, 1};
};
// Of any vector that is finite and not zero.
[[nodiscard]] UpFrame upFrame(const Vec3d& up);

struct Attitude {
    double yaw = 0;    // of the direction of view, from `right` towards `into`
    double pitch = 0;  // above the horizon, in [-pi/2, pi/2]
    double roll = 0;   // 0: the horizon is level
};

// The picture's axes in the world: orthonormal.
struct ViewAxes {
    Vec3d right, up, forward;
};
[[nodiscard]] ViewAxes axesOf(const UpFrame& frame, const Attitude& attitude);
[[nodiscard]] Attitude attitudeOf(const UpFrame& frame, const hlod::Camera& camera);
// Level, along `forward` (unit length); straight up and down as seen from the front.
[[nodiscard]] Attitude levelAttitude(const UpFrame& frame, const Vec3d& forward);

// Between two attitudes by the shorter way round, `t` in [0, 1]; exact at both ends but for whole
// turns.
[[nodiscard]] Attitude between(const Attitude& a, const Attitude& b, double t);

[[nodiscard]] bool isFinite(const Vec3d& v);
// All finite, the eye not at its target, an angle of view that is one.
[[nodiscard]] bool isUsable(const hlod::Camera& camera);
[[nodiscard]] bool isUsable(const Box3d& box);  // not empty, of finite size; may be a point

}  // namespace pagoda::viewer
