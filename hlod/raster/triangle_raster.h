// triangle_raster.h: a small exact z-buffer: meshes of lattice points into depths and ids, in
// double, without snapping. For tests and soaks, not for speed at large pictures. A pixel belongs
// to a triangle when the ray through its centre meets it; triangles that share an edge, in one mesh
// or in two, neither overlap nor leave a gap along it, but at its ends within rounding of a pixel
// centre (homogeneous rasterisation, Olano and Greer 1997: nothing behind the eye is clipped). One
// thread.
#pragma once

#include "hlod/raster/software_pages.h"
#include "hlod/view/camera.h"
#include "ooc/lattice.h"
#include "ooc/node_id.h"

#include <cstdint>
#include <vector>

namespace pagoda::hlod {

// Rows run from bottom to top, as BoxRaster reads them.
struct SoftwarePicture {
    int widthPx = 0, heightPx = 0;
    std::vector<float> depths;           // near / depth along the view; 0: nothing
    std::vector<uint32_t> nodeOrdinals;  // 0 for none, else 1 + index into nodes
    std::vector<uint32_t> triangles;     // its number in the node's page
    std::vector<ooc::NodeId> nodes;

    [[nodiscard]] size_t pixelCount() const { return depths.size(); }
    [[nodiscard]] uint64_t coveredPixels() const;
    // Of a covered pixel.
    [[nodiscard]] ooc::NodeId nodeAt(size_t pixel) const { return nodes[nodeOrdinals[pixel] - 1]; }
};

class TriangleRaster {
public:
    explicit TriangleRaster(const ooc::Lattice& lattice) : lattice_(lattice) {}

    // Empties the picture.
    void begin(const View& view);
    // Both sides; nothing before the near plane. What is as near as what is there loses.
    void draw(const SoftwareMesh& mesh, ooc::NodeId node);
    [[nodiscard]] const SoftwarePicture& picture() const noexcept { return picture_; }

private:
    struct Corner {
        Vec3d place;     // (x w, y w, w): x and y in pixels from the bottom left, w the depth
        double x, y;     // valid at or behind the near plane
        bool isInFront;  // ... of the near plane: not to be seen
    };
    struct Span {
        int x0, y0, x1, y1;  // inclusive
    };
    [[nodiscard]] bool findSpan(const Corner& a, const Corner& b, const Corner& c,
                                Span& span) const;
    void fill(const Corner& a, const Corner& b, const Corner& c, const Span& span,
              uint32_t triangle);

    ooc::Lattice lattice_;
    Vec3d columns_[3], offset_{0.0};  // lattice point to Corner::place
    double near_ = 1.0;
    std::vector<Corner> corners_;
    SoftwarePicture picture_;
};

}  // namespace pagoda::hlod
