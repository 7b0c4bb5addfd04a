// device.h: what a frame is drawn with. A seam: GL (viewer/) and a software rasteriser
// (hlod/raster/). Render thread only.
#pragma once

#include "hlod/view/camera.h"
#include "hlod/view/frame_cut.h"
#include "hlod/view/frame_record.h"
#include "hlod/view/visibility.h"

namespace pagoda::hlod {

class Device {
public:
    virtual ~Device() = default;
    // What the view's clip cuts away or hides is not drawn by devices for pictures.
    virtual void beginFrame(const View& view) = 0;
    // Draws the opaque part of a node whose page is uploaded. Draws may be gathered until an answer
    // depends on them.
    virtual void draw(const Node& node) = 0;
    // Does it draw on the CPUs that everything else runs on? Then CPU time tells what a frame
    // costs.
    [[nodiscard]] virtual bool drawsOnCpu() const { return false; }
    // Count, or test, against what was drawn so far; null where the device has none.
    [[nodiscard]] virtual CountingVisibility* counting() = 0;
    [[nodiscard]] virtual PyramidVisibility* pyramid() = 0;
    // Draws what is left (zippers, translucent parts, overlays) and fills in drawnNodes,
    // drawnTriangles and the like, queries, and the milliseconds that queries and draws took before
    // this call.
    virtual void endFrame(const FrameCut& cut, FrameRecord& record) = 0;
};

}  // namespace pagoda::hlod
