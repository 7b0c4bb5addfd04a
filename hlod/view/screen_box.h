// screen_box.h: a box as it appears on the screen. Pure functions.
#pragma once

#include "hlod/view/camera.h"

namespace pagoda::hlod {

// Does the box reach the eye's side of the near plane? Then its projection says nothing, and it is
// taken as visible, unasked.
[[nodiscard]] bool crossesNear(const View& view, const Box3d& boxModel);

// Area of the box's outline (the convex hull of its projected corners) inside the picture, in
// pixels. The box does not cross the near plane (asserted). Clipped, because a box that one stands
// beside must not look hidden for reaching out of the picture.
[[nodiscard]] double boxPixels(const View& view, const Box3d& boxModel);

// The least rectangle of pixels that holds the box's projection, clipped to the picture, and the
// depth along the direction of view of its nearest corner, model units. Not crossing the near
// plane (asserted). Empty (min >= max) when the box lies outside of the picture.
struct ScreenRect {
    double minX = 0, minY = 0, maxX = 0, maxY = 0;  // pixels, from the top left
    double nearestModelUnits = 0;
    [[nodiscard]] bool isEmpty() const { return !(minX < maxX && minY < maxY); }
};
[[nodiscard]] ScreenRect screenRect(const View& view, const Box3d& boxModel);

}  // namespace pagoda::hlod
