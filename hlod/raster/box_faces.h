// box_faces.h: the front faces of a box as planes over the screen, so that a pixel is tested by a
// few products and sums, on the CPU (box_raster.h) or on the GPU. In double: all that needs care
// near the eye happens here. One thread.
#pragma once

#include "hlod/view/camera.h"

#include <array>
#include <cstdint>
#include <span>

namespace pagoda::hlod {

// a x + b y + c; x and y in pixels from the bottom left, pixel centres at +0.5.
struct ScreenPlane {
    double a = 0, b = 0, c = 0;
    [[nodiscard]] double at(double x, double y) const { return a * x + b * y + c; }
    // Greatest over a rectangle of pixel centres.
    [[nodiscard]] double greatest(double x0, double y0, double x1, double y1) const {
        return at(a > 0 ? x1 : x0, b > 0 ? y1 : y0);
    }
};

struct BoxFace {
    // Pixels [x0, x1] x [y0, y1] whose centres may lie inside, within the picture; may be empty.
    struct Rect {
        int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
        [[nodiscard]] bool isEmpty() const { return x0 > x1 || y0 > y1; }
    };
    std::array<ScreenPlane, 4> edges;  // none negative: inside. Of any scale
    ScreenPlane depth;                 // reversed: near / depth along the view
    Rect rect;
};

class BoxFaces {
public:
    void setView(const View& view);

    // The faces whose outer side the eye sees, at most three, in `faces`. None: the eye is in the
    // box. The box is grown as GL queries grow it: by half a pixel and 1e-5 of its distance, so
    // that it never hides behind its own content. Boxes that cross the near plane before that are
    // not asked about (crossesNear).
    [[nodiscard]] std::span<const BoxFace> facing(const Box3d& boxModel,
                                                  std::array<BoxFace, 3>& faces) const;

private:
    using Quad = std::array<Vec3d, 4>;  // corners (x w, y w, w): x and y in pixels
    [[nodiscard]] BoxFace::Rect rectOf(const Quad& quad) const;

    Vec3d eye_{0.0}, right_{0.0}, up_{0.0}, forward_{0.0};
    double tanX_ = 1, tanY_ = 1, near_ = 1;
    int width_ = 0, height_ = 0;
};

}  // namespace pagoda::hlod
