// gpu_depth_tests.h: a depth pyramid on the GPU, as two-pass occlusion culling has it: one
// reduction of the depths drawn so far, one dispatch for all boxes that are known by then, one
// small read-back. Depths never leave the GPU.
//
// Each level of the pyramid has a fourth of the width and height of the one below, and knows the
// farthest and the nearest depth under each of its texels. A front face (hlod/raster/box_faces.h)
// begins at the level where it covers up to 128 texels, and goes down texel by texel: outside or
// behind the farthest is 0, inside and before the nearest counts whole, the rest is looked at one
// level below, to single pixels. Planes are rounded outwards, so that a box counts at least as many
// pixels as BoxRaster says; more only by that rounding, and where a face is so ragged that it would
// cost more than a fixed number of tests.
//
// Each call of visiblePixels() waits for the GPU. Render thread only, context current.
#pragma once

#include "hlod/raster/box_faces.h"
#include "viewer/depth_tests.h"
#include "viewer/gl_names.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pagoda::viewer {

class GpuDepthTests final : public DepthTests {
public:
    // `restoreState` goes back to the state of opaque drawing after other programs have run.
    GpuDepthTests(std::function<void()> flushDraws, std::function<void()> restoreState);

private:
    // As the shader reads it (std430). Planes over pixels from the rectangle's first.
    struct Face {
        float edges[4][4];  // the last of each is unused
        float depth[4];
        int32_t rect[4];  // x0, y0, x1, y1
        uint32_t box;
        uint32_t firstLevel;
        uint32_t unused[2];
    };
    static_assert(sizeof(Face) == 112);
    // One level of the pyramid, from 1 on. Level 0 is the pixels.
    struct Level {
        int32_t width, height;
        int32_t offset;  // in texels
    };

    void takeDepths() override;
    void test(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) override;
    void layOut(int widthPx, int heightPx);
    [[nodiscard]] Face makeFace(const hlod::BoxFace& face, uint32_t box) const;

    std::function<void()> restoreState_;
    GlProgram takeProgram_, reduceProgram_, testProgram_;
    GlBuffer levelsBuffer_, pushesBuffer_, facesBuffer_, resultsBuffer_;
    GlTexture pushedDepths_;  // level 0 where depths are pushed; else the target's own
    int pushedWidth_ = 0, pushedHeight_ = 0;
    int widthPx_ = 0, heightPx_ = 0;
    std::vector<Level> levels_;
    hlod::BoxFaces boxFaces_;
    std::vector<Face> faces_;
    std::vector<uint32_t> results_;
};

}  // namespace pagoda::viewer
