#include "viewer/window/seen_point.h"

#include <algorithm>
#include <limits>

namespace pagoda::viewer {

Vec3d pixelDirection(const hlod::View& view, int xPx, int yPx) {
    const hlod::Camera& camera = view.camera();
    const double x = 2.0 * (xPx + 0.5) / camera.widthPx - 1.0;
    const double y = 1.0 - 2.0 * (yPx + 0.5) / camera.heightPx;
    return view.forward() + view.right() * (x * view.tanX()) + view.up() * (y * view.tanY());
}

std::optional<SeenPoint> seenPoint(const FrameTarget& target, const hlod::View& view, int xPx,
                                   int yPx) {
    const PixelSample sample = target.sample(xPx, yPx);
    if (!(sample.reversedDepth > 0.0f)) return std::nullopt;
    const double along = view.nearModelUnits() / static_cast<double>(sample.reversedDepth);
    return SeenPoint{view.eye() + pixelDirection(view, xPx, yPx) * along, along};
}

double nearestSeen(const FrameTarget& target, const hlod::View& view) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int row = 1; row <= 3; ++row) {
        for (int column = 1; column <= 3; ++column) {
            const auto seen =
                seenPoint(target, view, target.widthPx() * column / 4, target.heightPx() * row / 4);
            if (seen) nearest = std::min(nearest, seen->distanceModelUnits);
        }
    }
    return nearest;
}

}  // namespace pagoda::viewer
