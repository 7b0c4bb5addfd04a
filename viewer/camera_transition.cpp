#include "viewer/camera_transition.h"

#include <algorithm>
#include <cmath>

namespace pagoda::viewer {

CameraTransition::CameraTransition(const UpFrame& frame, const CameraPose& from,
                                   double fromAheadModelUnits, const CameraPose& to,
                                   double toAheadModelUnits)
    : frame_(frame),
      from_(from),
      to_(to),
      fromAhead_(fromAheadModelUnits),
      toAhead_(toAheadModelUnits) {
}

CameraPose CameraTransition::advance(double seconds) {
    passedS_ += seconds;
    if (isDone()) return to_;
    const double s = passedS_ / kSeconds;
    const double t = s * s * (3 - 2 * s);
    CameraPose pose;
    pose.attitude = between(from_.attitude, to_.attitude, t);
    pose.fovyDegrees = from_.fovyDegrees + t * (to_.fovyDegrees - from_.fovyDegrees);
    // Sums of differences from the first eye: far from the origin, points lose what these keep.
    const Vec3d fromOffset = axesOf(frame_, from_.attitude).forward * fromAhead_;
    const Vec3d toOffset = axesOf(frame_, to_.attitude).forward * toAhead_;
    const Vec3d focusShift = (to_.eye - from_.eye) + (toOffset - fromOffset);
    const double ahead = fromAhead_ * std::pow(toAhead_ / fromAhead_, t);
    const Vec3d offset = axesOf(frame_, pose.attitude).forward * ahead;
    pose.eye = from_.eye + (fromOffset + t * focusShift - offset);
    return pose;
}

}  // namespace pagoda::viewer
