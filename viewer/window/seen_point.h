// seen_point.h: from a pixel of a frame back to the model. Main thread, context current.
#pragma once

#include "hlod/view/camera.h"
#include "viewer/frame_target.h"

#include <optional>

namespace pagoda::viewer {

// Through a pixel's centre, 1 long along the direction of view.
[[nodiscard]] Vec3d pixelDirection(const hlod::View& view, int xPx, int yPx);

// The model's point that a pixel shows at its centre.
struct SeenPoint {
    Vec3d pointModel{0.0};
    double distanceModelUnits = 0.0;  // along the direction of view
};
// Nothing where nothing opaque is. `view` is the one that `target` was drawn with; pixels from the
// top left.
[[nodiscard]] std::optional<SeenPoint> seenPoint(const FrameTarget& target, const hlod::View& view,
                                                 int xPx, int yPx);
// To the nearest of some places in the picture; infinite where nothing is.
[[nodiscard]] double nearestSeen(const FrameTarget& target, const hlod::View& view);

}  // namespace pagoda::viewer
