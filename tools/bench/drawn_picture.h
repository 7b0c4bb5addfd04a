// drawn_picture.h: a frame's picture together with what its cut knew of the nodes in it.
#pragma once

#include "viewer/picture.h"
#include "viewer/renderer.h"

#include <cstdint>
#include <vector>

namespace pagoda::tools {

struct DrawnPicture {
    viewer::Picture picture;
    // Both of picture.nodes, in their order.
    std::vector<double> errorsModelUnits;
    std::vector<uint8_t> isStandIn;
    double tauPx = 0;  // effective
};

// The last frame's; fills in what Renderer::read() does. Not of a reference, which has no cut.
[[nodiscard]] DrawnPicture readDrawn(viewer::Renderer& renderer, hlod::FrameRecord& record);

}  // namespace pagoda::tools
