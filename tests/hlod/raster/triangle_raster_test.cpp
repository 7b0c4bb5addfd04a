// The z-buffer against rays through every pixel, and shared edges that run through pixel centres.
#include "tests/hlod/raster/raster_cases.h"

#include <gtest/gtest.h>

#include <limits>

namespace pagoda::hlod {
namespace {

using test::Cases;

struct Hit {
    double depth = std::numeric_limits<double>::infinity();
    uint32_t triangle = 0;
    bool isSure = true;  // no edge and no second surface within rounding
};

// Moeller and Trumbore, with the distance to the nearest edge as a share of the triangle.
Hit cast(const View& view, const SoftwareMesh& mesh, const Vec3d& ray) {
    Hit best;
    double second = std::numeric_limits<double>::infinity();
    for (uint32_t i = 0; 3 * i + 2 < mesh.indices.size(); ++i) {
        const Vec3d a = Vec3d(mesh.positions[mesh.indices[3 * i]]) - view.eye();
        const Vec3d u = Vec3d(mesh.positions[mesh.indices[3 * i + 1]]) - view.eye() - a;
        const Vec3d v = Vec3d(mesh.positions[mesh.indices[3 * i + 2]]) - view.eye() - a;
        if (glm::cross(u, v) == Vec3d(0.0)) continue;  // no area
        const Vec3d p = glm::cross(ray, v);
        const double det = glm::dot(u, p);
        if (std::abs(det) < 1e-9 * glm::length(u) * glm::length(v)) {
            best.isSure = false;  // nearly edge-on
            continue;
        }
        const double s = glm::dot(-a, p) / det;
        const double t = glm::dot(ray, glm::cross(-a, u)) / det;
        const double margin = std::min({s, t, 1.0 - s - t});
        const double depth = glm::dot(v, glm::cross(-a, u)) / det;
        if (depth < view.nearModelUnits() * (1.0 - 1e-9)) continue;
        if (std::abs(margin) < 1e-7) best.isSure = false;
        if (margin < 0.0) continue;
        if (depth < best.depth) {
            second = best.depth;
            best.depth = depth;
            best.triangle = i;
        } else {
            second = std::min(second, depth);
        }
    }
    // Depths are stored as float.
    if (second < best.depth * (1.0 + 1e-6)) best.isSure = false;
    return best;
}

TEST(TriangleRaster, ShowsTheTriangleThatTheRayThroughAPixelMeetsFirst) {
    Cases cases(21);
    size_t unsure = 0, pixels = 0, covered = 0;
    for (int i = 0; i < 150; ++i) {
        const View view = cases.view();
        const SoftwareMesh mesh =
            cases.mesh(i % 3 == 0 ? cases.box() : Box3i{Vec3i(0), Vec3i(1024)}, cases.whole(1, 40));
        TriangleRaster raster(test::unitLattice());
        raster.begin(view);
        raster.draw(mesh, ooc::NodeId::root());
        const SoftwarePicture& picture = raster.picture();
        for (int row = 0; row < test::kHeightPx; ++row) {
            for (int column = 0; column < test::kWidthPx; ++column) {
                const Hit hit = cast(view, mesh, test::rayThrough(view, column, row));
                const auto at = static_cast<size_t>(row * test::kWidthPx + column);
                ++pixels;
                unsure += !hit.isSure;
                if (!hit.isSure) continue;
                const bool isHit = std::isfinite(hit.depth);
                ASSERT_EQ(picture.nodeOrdinals[at] != 0, isHit) << i << ' ' << column << ' ' << row;
                covered += isHit;
                if (!isHit) continue;
                ASSERT_EQ(picture.triangles[at], hit.triangle) << i;
                ASSERT_NEAR(view.nearModelUnits() / static_cast<double>(picture.depths[at]),
                            hit.depth, 1e-6 * hit.depth);
            }
        }
    }
    EXPECT_LT(unsure, pixels / 100);
    EXPECT_GT(covered, pixels / 10);
}

// A square of 32 x 32 cells, two triangles each, whose edges (and no corners) run through pixel
// centres.
SoftwareMesh grid(bool isUpperHalf, const Vec3i& shift) {
    SoftwareMesh mesh;
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
            if ((y >= 16) != isUpperHalf) continue;
            const auto first = static_cast<uint32_t>(mesh.positions.size());
            for (int corner = 0; corner < 4; ++corner) {
                mesh.positions.push_back(shift +
                                         Vec3i(8 * (x + (corner & 1)), 8 * (y + corner / 2), 0));
            }
            for (const uint32_t index : {0u, 1u, 2u, 2u, 1u, 3u})
                mesh.indices.push_back(first + index);
        }
    }
    return mesh;
}

TEST(TriangleRaster, MeshesThatShareAnEdgeNeitherOverlapNorLeaveAGap) {
    Camera camera;
    camera.widthPx = camera.heightPx = 33;
    camera.fovyDegrees = 90.0;
    camera.up = {0, 1, 0};
    const std::pair<double, Vec3i> setups[] = {
        {0.0, {4, 0, 0}}, {0.0, {0, 4, 0}}, {13.0, {0, 4, 0}}};
    for (const auto& [tilt, shift] : setups) {
        // 33 pixels over 264 units: 8 units a pixel, centres on multiples of 8.
        camera.eye = Vec3d(128, 128, 132);
        camera.target = camera.eye - Vec3d(tilt, 0, 132);
        const View view(camera, Box3d{Vec3d(0), Vec3d(256)});
        const auto draw = [&, moved = shift](bool isUpperFirst) {
            TriangleRaster raster(test::unitLattice());
            raster.begin(view);
            const ooc::NodeId root = ooc::NodeId::root();
            raster.draw(grid(isUpperFirst, moved), root.child(isUpperFirst ? 1 : 0));
            raster.draw(grid(!isUpperFirst, moved), root.child(isUpperFirst ? 0 : 1));
            return raster.picture();
        };
        const SoftwarePicture one = draw(false), other = draw(true);
        for (int row = 6; row < 27; ++row) {
            for (int column = 5; column < 28; ++column) {
                const auto at = static_cast<size_t>(row * 33 + column);
                ASSERT_GT(one.nodeOrdinals[at], 0u) << column << ' ' << row;
                EXPECT_EQ(one.nodeAt(at), other.nodeAt(at)) << column << ' ' << row;
                EXPECT_EQ(one.triangles[at], other.triangles[at]);
            }
        }
    }
}

TEST(TriangleRaster, WhatIsAsNearAsWhatIsThereLoses) {
    Cases cases(22);
    const View view = cases.view();
    const SoftwareMesh mesh = cases.mesh({Vec3i(0), Vec3i(1024)}, 30);
    TriangleRaster raster(test::unitLattice());
    raster.begin(view);
    raster.draw(mesh, ooc::NodeId::root());
    const SoftwarePicture once = raster.picture();
    ASSERT_GT(once.coveredPixels(), 100u);
    raster.draw(mesh, ooc::NodeId::root().child(0));
    EXPECT_EQ(raster.picture().nodeOrdinals, once.nodeOrdinals);
}

}  // namespace
}  // namespace pagoda::hlod
