#include "tools/generate/building.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pagoda::tools {

void addSlab(SceneKit& kit, const Frame& at, const Rectangle& area, double thickness,
             std::span<const Rectangle> holes) {
    std::vector<Rectangle> local(holes.begin(), holes.end());
    for (Rectangle& hole : local) {
        hole = {hole.u0 - area.u0, hole.v0 - area.v0, hole.u1 - area.u0, hole.v1 - area.v0};
    }
    kit.plate(at.moved({area.u0, area.v0, -thickness}), area.u1 - area.u0, area.v1 - area.v0,
              thickness, local);
}

void addWall(SceneKit& kit, const Frame& at, double length, double height, double thickness,
             std::span<const Rectangle> holes) {
    const Frame upright{at.point({0, thickness / 2, -kPoke}), at.x, at.z, -at.y};
    std::vector<Rectangle> local(holes.begin(), holes.end());
    for (Rectangle& hole : local) {
        hole.v0 = hole.v0 <= 0 ? 0 : hole.v0 + kPoke;
        hole.v1 += kPoke;
    }
    kit.plate(upright, length, height + 2 * kPoke, thickness, local);
}

void addDoor(SceneKit& kit, const Frame& at, const DoorStyle& style) {
    const double w = style.width, h = style.height, half = style.wallThickness / 2;
    kit.paint(style.frameMaterial);
    kit.box(at, {-0.03, -half - 0.02, -0.011}, {0.045, half + 0.02, h - 0.025});
    kit.box(at, {w - 0.045, -half - 0.02, -0.011}, {w + 0.03, half + 0.02, h - 0.025});
    kit.box(at, {-0.05, -half - 0.027, h - 0.05}, {w + 0.05, half + 0.027, h + 0.03});
    const Frame leaf = at.moved({0.058, half + 0.005, 0}).turned(style.openRadians);
    kit.paint(style.leafMaterial);
    kit.box(leaf, {0, -0.022, 0.008}, {w - 0.12, 0.022, h - 0.06});
    kit.paint(style.handleMaterial);
    for (const double side : {-1.0, 1.0}) {
        const std::array<Vec3d, 3> handle{Vec3d(w - 0.19, side * 0.012, 1.02),
                                          Vec3d(w - 0.19, side * 0.067, 1.02),
                                          Vec3d(w - 0.31, side * 0.067, 1.02)};
        kit.tube(leaf, handle, 0.009, 0.012);
        kit.rod(leaf, {w - 0.19, side * 0.015, 1.021}, {w - 0.19, side * 0.029, 1.021}, 0.024);
    }
}

void addWindow(SceneKit& kit, const Frame& at, const WindowStyle& style) {
    const double w = style.width, h = style.height;
    const double y0 = -style.wallThickness / 2 + 0.09, y1 = y0 + 0.07;
    kit.paint(style.frameMaterial);
    // The frame's outer edge is in the wall; bars end in the frame.
    kit.box(at, {-0.02, y0, -0.02}, {0.05, y1, h + 0.02});
    kit.box(at, {w - 0.05, y0, -0.02}, {w + 0.02, y1, h + 0.02});
    kit.box(at, {0.03, y0 + 0.004, -0.025}, {w - 0.03, y1 - 0.004, 0.053});
    kit.box(at, {0.03, y0 + 0.004, h - 0.053}, {w - 0.03, y1 - 0.004, h + 0.025});
    for (int i = 1; i < style.columns; ++i) {
        const double x = w * i / style.columns;
        kit.box(at, {x - 0.025, y0 + 0.008, 0.04}, {x + 0.025, y1 - 0.008, h - 0.04});
    }
    for (int i = 1; i < style.rows; ++i) {
        const double z = h * i / style.rows;
        kit.box(at, {0.035, y0 + 0.012, z - 0.025}, {w - 0.035, y1 - 0.012, z + 0.025});
    }
    if (style.hasSill) {
        const double outside = -style.wallThickness / 2;
        kit.box(at, {-0.06, outside - 0.07, -0.034}, {w + 0.06, y0 + 0.02, 0.012});
    }
    kit.paint(style.glassMaterial);
    kit.box(at, {0.04, y0 + 0.028, 0.045}, {w - 0.04, y0 + 0.040, h - 0.045});
}

void addRailing(SceneKit& kit, const Frame& at, std::span<const Vec3d> path, double height) {
    for (size_t i = 0; i + 1 < path.size(); ++i) {
        const Vec3d step = path[i + 1] - path[i];
        const int posts = std::max(1, static_cast<int>(std::lround(glm::length(step) / 1.3)));
        for (int k = i == 0 ? 0 : 1; k <= posts; ++k) {
            const Vec3d foot = path[i] + step * (static_cast<double>(k) / posts);
            kit.rod(at, foot + Vec3d(0, 0, -0.0137), foot + Vec3d(0, 0, height), 0.022);
        }
    }
    for (const double level : {height, height * 0.52}) {
        std::vector<Vec3d> rail(path.begin(), path.end());
        for (Vec3d& point : rail) point.z += level;
        kit.tube(at, rail, level == height ? 0.025 : 0.018, 0.06);
    }
}

void addLadder(SceneKit& kit, const Frame& at, double height, bool hasCage) {
    for (const double x : {-0.22, 0.22}) {
        kit.box(at, {x - 0.008, 0.155, 0.006}, {x + 0.008, 0.215, height});
        for (double z = 0.5; z < height; z += 2.1) {
            kit.rod(at, {x, -0.01, z}, {x, 0.17, z}, 0.012);
        }
    }
    const int rungs = static_cast<int>(height / 0.28);
    for (int i = 1; i < rungs; ++i) {
        kit.rod(at, {-0.221, 0.185, i * 0.28}, {0.221, 0.185, i * 0.28}, 0.0125);
    }
    if (!hasCage) return;
    for (double z = 2.5; z < height; z += 0.85) {
        const std::array<Vec3d, 5> hoop{Vec3d(-0.226, 0.2, z), Vec3d(-0.37, 0.45, z),
                                        Vec3d(0, 0.93, z), Vec3d(0.37, 0.45, z),
                                        Vec3d(0.226, 0.2, z)};
        kit.tube(at, hoop, 0.014, 0.3);
    }
    for (const double x : {-0.27, 0.0, 0.27}) {
        const double y = x == 0 ? 0.72 : 0.6;
        kit.box(at, {x - 0.02, y, 2.45}, {x + 0.02, y + 0.008, height - 0.03});
    }
}

void addStairs(SceneKit& kit, const Frame& at, double width, double run, double rise) {
    const int steps = std::max(2, static_cast<int>(std::lround(rise / 0.18)));
    const double dx = run / steps, dz = rise / steps;
    for (int i = 0; i < steps; ++i) {
        kit.box(at, {i * dx - 0.013, 0.012, (i + 1) * dz - 0.052},
                {(i + 1) * dx + 0.017, width - 0.012, (i + 1) * dz - 0.007});
    }
    const double toe = 0.238 * run / rise;  // where its lower edge meets the floor
    const std::array<glm::dvec2, 5> stringer{glm::dvec2(0, -0.012), glm::dvec2(toe, -0.012),
                                             glm::dvec2(run, rise - 0.25),
                                             glm::dvec2(run, rise + 0.015), glm::dvec2(0, 0.065)};
    for (const double y : {0.0, width}) {
        const Frame upright{at.point({0, y + 0.02, 0}), at.x, at.z, -at.y};
        kit.prism(upright, stringer, 0, 0.04);
    }
}

void addBeam(SceneKit& kit, const Frame& at, const Vec3d& a, const Vec3d& b, double depth) {
    const double half = depth / 2, wide = depth * 0.31, web = depth * 0.025, flange = depth * 0.05;
    const std::array<glm::dvec2, 12> section{
        glm::dvec2(-wide, -half),         glm::dvec2(wide, -half),
        glm::dvec2(wide, -half + flange), glm::dvec2(web, -half + flange),
        glm::dvec2(web, half - flange),   glm::dvec2(wide, half - flange),
        glm::dvec2(wide, half),           glm::dvec2(-wide, half),
        glm::dvec2(-wide, half - flange), glm::dvec2(-web, half - flange),
        glm::dvec2(-web, -half + flange), glm::dvec2(-wide, -half + flange)};
    Frame along = at.aligned(a, b - a);
    // The web upright: section y along the local z where the beam lies flat.
    const Vec3d up = std::abs(along.z.z) < 0.9 ? Vec3d(0, 0, 1) : at.x;
    along.y = glm::normalize(up - glm::dot(up, along.z) * along.z);
    along.x = glm::cross(along.y, along.z);
    kit.prism(along, section, 0, glm::distance(a, b));
}

}  // namespace pagoda::tools
