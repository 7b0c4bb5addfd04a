// frame_target.h: what a frame is drawn into: colour (sRGB8 + coverage), two R32UI ids, float
// depth. Render thread only, context current.
#pragma once

#include "viewer/gl_names.h"
#include "viewer/picture.h"

#include <vector>

namespace pagoda::viewer {

// What was drawn at one pixel.
struct PixelSample {
    float reversedDepth = 0.0f;  // near / distance along the view; 0: no opaque surface
    uint32_t nodeOrdinal = 0;    // 0: none
    uint32_t triangle = 0;       // its number in the node's page; beyond them, zippers
};

class FrameTarget {
public:
    // Throws Error when the driver has no textures of that size.
    FrameTarget(int widthPx, int heightPx);

    // Binds it and clears it.
    void begin(const Background& background);
    // Paints the background where nothing opaque is, so that it costs what is seen of it. Between
    // opaque and translucent draws; programs and arrays must be bound anew.
    void paintBackground();
    // Which outputs the next draws write: all, or colour alone, blended, with depth left as it is.
    void beginOpaque();
    void beginTranslucent();
    // Waits for the GPU and reads everything but `nodes`. Depths are near / value along the view.
    [[nodiscard]] Picture read(double nearModelUnits) const;

    // The depths alone, reversed as they are stored, rows from bottom to top. Waits for the GPU.
    void readDepths(std::vector<float>& depths) const;
    // The node ordinals alone, in the same order.
    void readNodeOrdinals(std::vector<uint32_t>& ordinals) const;
    // For shaders, between draws: D32F, and R32UI.
    [[nodiscard]] GlId depthTexture() const noexcept { return depth_.id(); }
    [[nodiscard]] GlId nodeOrdinalTexture() const noexcept { return nodeOrdinals_.id(); }

    // Of the last frame, y from the top. Outside the picture: nothing.
    [[nodiscard]] PixelSample sample(int xPx, int yPx) const;

    // Binds it for colour alone: overlays, over what has been drawn and behind what is nearer.
    void beginOverlay();
    // Copies the colours to the window's own framebuffer, which is bound afterwards.
    void blitToWindow(int widthPx, int heightPx) const;

    [[nodiscard]] int widthPx() const noexcept { return widthPx_; }
    [[nodiscard]] int heightPx() const noexcept { return heightPx_; }

private:
    int widthPx_, heightPx_;
    GlTexture colour_, nodeOrdinals_, triangles_, depth_;
    GlFramebuffer framebuffer_;
    GlProgram backgroundProgram_;
    GlVertexArray emptyArray_;
};

}  // namespace pagoda::viewer
