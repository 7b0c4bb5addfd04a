// box_raster.h: how many pixels of a box are nearer than a depth image, on the CPU: what an
// occlusion query counts, without a driver. Where reading depth is a memory copy, this is the
// depth pyramid and the query in one: blocks of 8x8 pixels know their farthest depth, so that most
// of a hidden box costs one comparison a block. One thread.
#pragma once

#include "hlod/raster/box_faces.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

class BoxRaster {
public:
    // `depths`: reversed (near / depth along the view; 0: nothing), rows from bottom to top, as
    // many as the view's picture has pixels. Copies nothing but the blocks' farthest depths;
    // `depths` outlives the calls below.
    void setDepths(const View& view, std::span<const float> depths);

    // Pixels whose centres the grown box (box_faces.h) covers with a front face that is not farther
    // than the depth there; all pixels when the eye is in it.
    [[nodiscard]] uint64_t visiblePixels(const Box3d& boxModel) const;
    // The same of each, in `pixels`.
    void visiblePixels(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) const;

private:
    [[nodiscard]] uint64_t visiblePixels(const BoxFace& face) const;

    BoxFaces faces_;
    int width_ = 0, height_ = 0, blocksX_ = 0, blocksY_ = 0;
    std::span<const float> depths_;
    std::vector<float> farthest_;  // least reversed depth of each block
};

}  // namespace pagoda::hlod
