// node_colours.h: what a node is painted with, to see what a traversal does. Pure functions.
#pragma once

#include "viewer/gl_device.h"
#include "viewer/window/view_settings.h"

namespace pagoda::viewer {

// Empty for the model's own colours.
[[nodiscard]] NodeTint tintOf(Colouring colouring, double tauPx);

// sRGB, opaque; distinct for neighbouring levels.
[[nodiscard]] glm::u8vec3 levelColour(int depth);
// Red where the error is all that is allowed (`share` 1), green at an eighth, blue from a 64th on.
[[nodiscard]] glm::u8vec3 errorColour(double share);

}  // namespace pagoda::viewer
