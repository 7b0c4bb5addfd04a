// box_raster.h: how many pixels of a box are nearer than a depth image, on the CPU: what an
// occlusion query counts, without a driver. Where reading depth is a memory copy, this is the
// depth pyramid and the query in one: blocks of 8x8 pixels know their farthest depth, so that most
// of a hidden box costs one comparison a block. One thread.
#pragma once

#include "hlod/view/camera.h"

#include <array>
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

    // Pixels whose centres the box covers with a front face that is not farther than the depth
    // there. The box is grown as GL queries grow it: by half a pixel and 1e-5 of its distance, so
    // that it never hides behind its own content. It does not cross the near plane (asserted).
    [[nodiscard]] uint64_t visiblePixels(const Box3d& boxModel) const;

private:
    struct Quad {
        std::array<Vec3d, 4> corners;  // (x w, y w, w): x and y in pixels from the bottom left
        double depth[3];               // reversed, of pixel (x, y): [0] x + [1] y + [2]
    };
    struct Rect {
        int x0, y0, x1, y1;  // inclusive
    };
    [[nodiscard]] Rect rectOf(const Quad& quad) const;
    [[nodiscard]] uint64_t visiblePixels(const Quad& quad) const;

    Vec3d eye_{0.0}, right_{0.0}, up_{0.0}, forward_{0.0};
    double tanX_ = 1, tanY_ = 1, near_ = 1;
    int width_ = 0, height_ = 0, blocksX_ = 0, blocksY_ = 0;
    std::span<const float> depths_;
    std::vector<float> farthest_;  // least reversed depth of each block
};

}  // namespace pagoda::hlod
