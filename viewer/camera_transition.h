// camera_transition.h: from one view to another in a moment, eased, round what is looked at rather
// than through it. Pure data; no clock of its own.
#pragma once

#include "viewer/turntable.h"

namespace pagoda::viewer {

struct CameraPose {
    Vec3d eye{0.0};
    Attitude attitude;
    double fovyDegrees = 45;
};

class CameraTransition {
public:
    static constexpr double kSeconds = 0.35;

    // From and to: each eye looks at a point so far ahead (> 0); the points are joined by a line,
    // the distances by ratio, the angles by the short way.
    CameraTransition(const UpFrame& frame, const CameraPose& from, double fromAheadModelUnits,
                     const CameraPose& to, double toAheadModelUnits);

    // Moves on; exactly `to` once isDone().
    [[nodiscard]] CameraPose advance(double seconds);
    [[nodiscard]] bool isDone() const { return passedS_ >= kSeconds; }

private:
    UpFrame frame_;
    CameraPose from_, to_;
    double fromAhead_, toAhead_;
    double passedS_ = 0;
};

}  // namespace pagoda::viewer
