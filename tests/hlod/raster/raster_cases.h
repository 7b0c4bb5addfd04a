// raster_cases.h: random views, boxes and meshes, and rays through pixels, for the rasterisers.
#pragma once

#include "hlod/raster/triangle_raster.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace pagoda::hlod::test {

inline constexpr int kWidthPx = 61, kHeightPx = 47;  // no multiples of the blocks

// One lattice unit is one model unit, the scene lies in [0, 1024]^3.
inline ooc::Lattice unitLattice() {
    ooc::Lattice lattice;
    lattice.extentBits = 10;
    return lattice;
}

class Cases {
public:
    explicit Cases(uint32_t seed) : random_(seed) {}
    double real(double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random_);
    }
    int whole(int least, int most) {
        return std::uniform_int_distribution<int>(least, most)(random_);
    }
    Vec3d point(double least, double most) {
        const double x = real(least, most), y = real(least, most);
        return {x, y, real(least, most)};
    }
    // Somewhere in or around the scene, rolled; one in eight looks straight along an axis.
    View view() {
        Camera camera;
        camera.widthPx = kWidthPx;
        camera.heightPx = kHeightPx;
        camera.fovyDegrees = real(20, 110);
        camera.eye = point(-300, 1300);
        camera.up = point(-1, 1);
        if (whole(0, 7) == 0) {
            camera.target = camera.eye;
            camera.target[whole(0, 2)] += whole(0, 1) == 0 ? 1.0 : -1.0;
        } else {
            camera.target = point(300, 700);
        }
        return View(camera, Box3d{Vec3d(0), Vec3d(1024)});
    }
    // Tiny, flat, rod-like or huge.
    Box3i box() {
        static constexpr double kSizes[] = {1.0, 12.0, 90.0, 900.0};
        const double size = kSizes[whole(0, 3)];
        Vec3i least(0), most(0);
        for (int axis = 0; axis < 3; ++axis) {
            const bool isFlat = whole(0, 3) == 0;
            least[axis] = whole(0, 1023 - (isFlat ? 0 : static_cast<int>(size)));
            most[axis] = least[axis] + (isFlat ? 0 : whole(1, static_cast<int>(size)));
        }
        Box3i box;
        box.extend(least);
        box.extend(most);
        return box;
    }
    SoftwareMesh mesh(const Box3i& box, int triangles) {
        SoftwareMesh mesh;
        for (int i = 0; i < 3 * triangles; ++i) {
            Vec3i point(0);
            for (int axis = 0; axis < 3; ++axis) point[axis] = whole(box.min[axis], box.max[axis]);
            mesh.positions.push_back(point);
            mesh.indices.push_back(static_cast<uint32_t>(i));
        }
        return mesh;
    }

private:
    std::mt19937 random_;
};

// From the eye through the centre of a pixel (from the bottom left), one unit along the view.
inline Vec3d rayThrough(const View& view, int column, int row) {
    const double x = 2.0 * (column + 0.5) / view.camera().widthPx - 1.0;
    const double y = 2.0 * (row + 0.5) / view.camera().heightPx - 1.0;
    return view.forward() + x * view.tanX() * view.right() + y * view.tanY() * view.up();
}

inline Box3d tightBox(const SoftwareMesh& mesh) {
    Box3d box;
    for (const Vec3i& point : mesh.positions) box.extend(Vec3d(point));
    return box;
}

}  // namespace pagoda::hlod::test
