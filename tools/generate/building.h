// building.h: what buildings are made of: slabs, walls with openings, doors, windows, railings,
// ladders, stairs. Parts that meet poke kPoke into each other, so that no faces coincide.
#pragma once

#include "tools/generate/scene_kit.h"

#include <span>
#include <vector>

namespace pagoda::tools {

inline constexpr double kPoke = 0.02;  // metres

// Top at local z = 0, from (x0, y0) to (x1, y1).
void addSlab(SceneKit& kit, const Frame& at, const Rectangle& area, double thickness,
             std::span<const Rectangle> holes = {});
// Along local x from 0, upright, its middle plane at y = 0. It reaches kPoke below z = 0 and above
// `height`. Holes in (x, z); one that begins at z <= 0 is a doorway.
void addWall(SceneKit& kit, const Frame& at, double length, double height, double thickness,
             std::span<const Rectangle> holes = {});

struct DoorStyle {
    double width = 1.0, height = 2.1, wallThickness = 0.2;
    double openRadians = 1.4;
    uint32_t frameMaterial = 0, leafMaterial = 0, handleMaterial = 0;
};
// In a doorway that begins at local x = 0; hinged there.
void addDoor(SceneKit& kit, const Frame& at, const DoorStyle& style);

struct WindowStyle {
    double width = 1.2, height = 1.4, wallThickness = 0.3;
    int columns = 2, rows = 1;
    uint32_t frameMaterial = 0, glassMaterial = 0;
    bool hasSill = true;
};
// Fills an opening whose lower left corner is the local origin; outside is at -y.
void addWindow(SceneKit& kit, const Frame& at, const WindowStyle& style);

// Hand rail, knee rail and posts along a path on the floor.
void addRailing(SceneKit& kit, const Frame& at, std::span<const Vec3d> path, double height = 1.1);
// Against a wall at y = 0, climbing along z; with a safety cage above 2.5 m.
void addLadder(SceneKit& kit, const Frame& at, double height, bool hasCage);
// Steps climb along +x from the origin, `width` along +y; open below.
void addStairs(SceneKit& kit, const Frame& at, double width, double run, double rise);
// A rolled beam (I section) from a to b.
void addBeam(SceneKit& kit, const Frame& at, const Vec3d& a, const Vec3d& b, double depth);

}  // namespace pagoda::tools
