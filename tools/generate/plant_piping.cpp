// plant_piping.cpp: pipes, valves, cables and ducts of the power plant.
#include "tools/generate/plant_equipment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;
// What runs from wall to wall ends inside the walls, just short of the next room's.
constexpr double kEnd = 0.004;

struct Pipe {
    double y, radius;
    double z, upperZ;  // its two tiers
    int medium;
};

// From wall to wall, or down into the floor, or up to the other tier on the way.
std::vector<Vec3d> pipePath(const RoomSpace& room, const Pipe& pipe, Random& random) {
    const double end = room.sizeX - kEnd, start = kEnd;
    const double turn = random.range(0.12, 0.4) * room.sizeX;
    // Only beside the aisle is the floor free of equipment.
    const bool canDrop = std::abs(pipe.y - room.sizeY / 2) < 1.75;
    switch (canDrop ? random.integer(1, 2) : 3 * random.integer(0, 2)) {
        case 0:
            return {{start, pipe.y, pipe.z}, {end, pipe.y, pipe.z}};
        case 1:
            return {{start, pipe.y, pipe.z}, {turn, pipe.y, pipe.z}, {turn, pipe.y, -0.014}};
        case 2:
            return {{end, pipe.y, pipe.z},
                    {room.sizeX - turn, pipe.y, pipe.z},
                    {room.sizeX - turn, pipe.y, -0.014}};
        case 3: {
            const bool isRising = random.chance(0.5);
            if (!isRising) return {{start, pipe.y, pipe.upperZ}, {end, pipe.y, pipe.upperZ}};
            return {{start, pipe.y, pipe.z},
                    {turn, pipe.y, pipe.z},
                    {turn, pipe.y, pipe.upperZ},
                    {end, pipe.y, pipe.upperZ}};
        }
        default: {
            const double back = room.sizeX * random.range(0.65, 0.85);
            return {{start, pipe.y, pipe.z},     {turn, pipe.y, pipe.z},
                    {turn, pipe.y, pipe.upperZ}, {back, pipe.y, pipe.upperZ},
                    {back, pipe.y, pipe.z},      {end, pipe.y, pipe.z}};
        }
    }
}

void addPipe(RoomSpace& room, const Pipe& pipe, Random random) {
    SceneKit& kit = room.kit;
    kit.paint(room.colours.media[pipe.medium]);
    const std::vector<Vec3d> path = pipePath(room, pipe, random);
    kit.tube(room.at, path, pipe.radius, pipe.radius * 2.5 + 0.06);
    for (size_t i = 0; i + 1 < path.size(); ++i) {
        const Vec3d step = path[i + 1] - path[i];
        const double length = glm::length(step);
        if (length < 2.4 || !kit.keeps(random)) continue;
        const double below = std::abs(step.z) > 2.4 ? 2.1 : 0.0;  // where the valve is
        const double margin = std::min(0.35 * length, pipe.radius * 3 + 0.4);
        const Vec3d at =
            path[i] + step / length * random.range(margin, length - std::max(margin, below));
        addFlange(kit, room.at.aligned(at, step), pipe.radius, random);
        if (std::abs(step.z) > 2.4) {
            addValve(kit, room.colours, room.at.aligned({path[i].x, path[i].y, 1.25}, step),
                     pipe.radius);
        }
    }
}

// Angles across, hung from the ceiling.
void addHangers(RoomSpace& room, double y0, double y1, double z, Random& random) {
    SceneKit& kit = room.kit;
    kit.paint(room.colours.structure);
    const int count = std::max(2, static_cast<int>(room.sizeX / 3.2));
    for (int i = 0; i < count; ++i) {
        const double x = room.sizeX * (i + 0.5) / count + random.range(-0.2, 0.2);
        kit.box(room.at, {x - 0.05, y0, z - 0.1}, {x + 0.05, y1, z - 0.005});
        for (const double y : {y0 + 0.74, y1 - 0.74}) {  // clear of the cable trays
            kit.rod(room.at, {x, y, z - 0.06}, {x, y, room.height + 0.012}, 0.016);
        }
    }
}

}  // namespace

void addFlange(SceneKit& kit, const Frame& at, double pipeRadius, Random& random) {
    const double r = pipeRadius * 1.45 + 0.025, half = 0.014 + pipeRadius * 0.12;
    kit.rod(at, {0, 0, -half - 0.002}, {0, 0, -0.002}, r);
    kit.rod(at, {0, 0, 0.002}, {0, 0, half + 0.002}, r * 0.995);
    if (!kit.keeps(random) || pipeRadius < 0.07) return;
    const int bolts = pipeRadius > 0.1 ? 8 : 4;
    const double circle = (pipeRadius + r) / 2, size = 0.006 + 0.05 * pipeRadius;
    for (int i = 0; i < bolts; ++i) {
        const double a = 2 * kPi * (i + 0.5) / bolts;
        const Vec3d foot(circle * std::cos(a), circle * std::sin(a), 0);
        kit.rod(at, foot - Vec3d(0, 0, half + 0.018), foot + Vec3d(0, 0, half + 0.018), size);
    }
}

void addValve(SceneKit& kit, const PlantPalette& colours, const Frame& at, double pipeRadius) {
    const double r = pipeRadius;
    kit.paint(colours.steel);
    const std::array<ProfilePoint, 8> body{{{r * 0.9, -2.2 * r},
                                            {r * 1.3, -1.9 * r},
                                            {r * 1.75, -0.9 * r},
                                            {r * 1.85, -0.1 * r},
                                            {r * 1.75, 0.9 * r},
                                            {r * 1.3, 1.9 * r},
                                            {r * 0.9, 2.2 * r},
                                            {r * 0.88, 2.2 * r}}};
    kit.lathe(at, body);
    for (const double z : {-2.2 * r, 2.2 * r}) {
        kit.rod(at, {0, 0, z - 0.16 * r}, {0, 0, z + 0.16 * r}, r * 1.55 + 0.02);
    }
    kit.rod(at, {0, 1.2 * r, 0}, {0, 2.6 * r, 0}, r * 0.9);
    kit.rod(at, {0, 2.5 * r, 0}, {0, 2.8 * r, 0}, r * 1.2);
    kit.rod(at, {0, 2.7 * r, 0}, {0, 5.0 * r, 0}, r * 0.22);
    kit.paint(colours.red);
    const Frame wheel = at.aligned({0, 4.7 * r, 0}, {0, 1, 0});
    kit.ring(wheel, 1.9 * r, 0.18 * r);
    for (int spoke = 0; spoke < 3; ++spoke) {
        const double a = kPi * spoke / 3;
        const Vec3d end(1.85 * r * std::cos(a), 1.85 * r * std::sin(a), 0.01 * r * spoke);
        kit.rod(wheel, -end, end, 0.1 * r);
    }
}

void addPipeRack(RoomSpace& room, const std::string& tag) {
    Random& random = room.random;
    const double lower = kPlantClear + 0.1, upper = room.height - 1.1;
    for (int side = 0; side < 2; ++side) {
        const int medium = random.integer(0, 5), other = (medium + random.integer(1, 5)) % 6;
        room.kit.beginObject(std::string("Pipes ") + std::string(kMediumNames[medium]) + " " + tag);
        const double y0 = side == 0 ? 0.25 : room.sizeY / 2 + 1.1;
        const double y1 = side == 0 ? room.sizeY / 2 - 1.1 : room.sizeY - 0.25;
        double y = y0 + 0.15;
        while (y < y1 - 0.45) {
            const double radius = random.range(0.04, random.chance(0.3) ? 0.24 : 0.13);
            y += radius * 1.5 + 0.06;
            const Pipe pipe{y, radius, lower + radius + random.range(0.0, 0.02),
                            upper + random.range(-0.1, 0.15), random.chance(0.65) ? medium : other};
            y += radius * 1.5 + 0.06 + random.range(0.0, 0.15);
            const Random own = random.fork(7);
            (void)random.next();
            if (room.kit.keeps(random)) addPipe(room, pipe, own);
        }
        addHangers(room, y0 + 0.02, y1, lower, random);
    }
}

void addCableTrays(RoomSpace& room, const std::string& tag) {
    SceneKit& kit = room.kit;
    Random& random = room.random;
    kit.beginObject("Cable trays " + tag);
    const double z0 = room.height - 0.62;
    for (int tray = 0; tray < 2; ++tray) {
        const double y = (tray == 0 ? 0.31 : room.sizeY - 0.91) + random.range(0.0, 0.05);
        const double z = z0 + random.range(0.0, 0.2), w = 0.55;
        kit.paint(room.colours.galvanised);
        for (const double side : {y, y + w}) {
            kit.box(room.at, {kEnd, side - 0.004, z}, {room.sizeX - kEnd, side + 0.004, z + 0.09});
        }
        const int rungs = static_cast<int>(room.sizeX / 0.3);
        for (int i = 0; i < rungs; ++i) {
            const double x = room.sizeX * (i + 0.5) / rungs;
            kit.box(room.at, {x - 0.015, y - 0.002, z + 0.008},
                    {x + 0.015, y + w + 0.002, z + 0.025});
        }
        const int cables = random.integer(6, 11);
        for (int i = 0; i < cables; ++i) {
            if (!kit.keeps(random)) continue;
            kit.paint(random.chance(0.25) ? room.colours.orange : room.colours.cable);
            const double radius = random.range(0.012, 0.022);
            const double cy = y + 0.05 + (w - 0.1) * (i + 0.5) / cables;
            std::vector<Vec3d> path;
            const int bends = 3;
            for (int k = 0; k <= bends; ++k) {
                path.emplace_back(
                    std::lerp(kEnd, room.sizeX - kEnd, static_cast<double>(k) / bends),
                    cy + random.range(-0.012, 0.012),
                    z + 0.026 + radius + random.range(0.0, 0.008));
            }
            kit.tube(room.at, path, radius, 0.5, false);
        }
    }
}

void addDucts(RoomSpace& room, const std::string& tag) {
    SceneKit& kit = room.kit;
    Random& random = room.random;
    kit.beginObject("Duct " + tag);
    kit.paint(room.colours.duct);
    const double w = random.range(0.6, 1.0), h = random.range(0.4, 0.55);
    const double y = room.sizeY / 2 - w / 2 + random.range(-0.3, 0.3), z = room.height - h - 0.35;
    const int pieces = std::max(2, static_cast<int>(room.sizeX / 1.5));
    const double piece = room.sizeX / pieces;
    kit.box(room.at, {kEnd, y, z}, {room.sizeX - kEnd, y + w, z + h});
    for (int i = 0; i < pieces; ++i) {
        const double x = piece * (i + 0.5);
        kit.box(room.at, {x - 0.02, y - 0.035, z - 0.035},
                {x + 0.02, y + w + 0.035, z + h + 0.035});
        for (const double side : {y - 0.02, y + w + 0.02}) {
            kit.rod(room.at, {x, side, z + 0.05}, {x, side, room.height + 0.013}, 0.008);
        }
        if (i % 2 == 1 || !kit.keeps(random)) continue;
        kit.box(room.at, {x + 0.25, y + 0.1, z - 0.06}, {x + 0.75, y + w - 0.1, z + 0.01});
        for (int blade = 0; blade < 6; ++blade) {  // of the grille
            const double bx = x + 0.29 + blade * 0.075;
            kit.box(room.at, {bx, y + 0.13, z - 0.082}, {bx + 0.03, y + w - 0.13, z - 0.055});
        }
    }
}

void addFittings(RoomSpace& room, const std::string& tag) {
    SceneKit& kit = room.kit;
    Random& random = room.random;
    kit.beginObject("Fittings " + tag);
    kit.paint(room.colours.yellow);  // lines along the aisles
    constexpr double kHalf = 1.0, kLine = 0.09;
    const double mx = room.sizeX / 2, my = room.sizeY / 2, edge = 0.4;
    for (const double sign : {-1.0, 1.0}) {
        const double y = my + sign * kHalf, x = mx + sign * kHalf;
        kit.box(room.at, {edge, y - kLine / 2, -0.01}, {mx - kHalf - 0.1, y + kLine / 2, 0.004});
        kit.box(room.at, {mx + kHalf + 0.1, y - kLine / 2, -0.01},
                {room.sizeX - edge, y + kLine / 2, 0.004});
        kit.box(room.at, {x - kLine / 2, edge, -0.01}, {x + kLine / 2, my - kHalf - 0.1, 0.005});
        kit.box(room.at, {x - kLine / 2, my + kHalf + 0.1, -0.01},
                {x + kLine / 2, room.sizeY - edge, 0.005});
    }
    for (int side = 0; side < 4; ++side) {  // what hangs on the walls, right of the doors
        const double half = (side % 2 == 0 ? room.sizeY : room.sizeX) / 2 - 0.185;
        const Frame wall = room.at.moved({mx, my, 0}).quarterTurned(side).moved({1.0, -half, 0});
        if (!kit.keeps(random) || (room.wallMask >> side & 1u) == 0) continue;
        kit.paint(room.colours.red);
        const std::array<ProfilePoint, 7> bottle{{{0, 0.85},
                                                  {0.08, 0.85},
                                                  {0.085, 0.9},
                                                  {0.085, 1.3},
                                                  {0.05, 1.37},
                                                  {0.02, 1.4},
                                                  {0, 1.47}}};
        kit.lathe(wall.moved({0.25, 0.12, 0}), bottle);
        kit.box(wall, {0.1, -0.1, 1.75}, {0.4, 0.012, 2.05});
        kit.paint(room.colours.cabinet);
        kit.box(wall, {0.62, -0.1, 1.1}, {1.12, 0.16, 1.8});
        kit.box(wall, {0.64, 0.15, 1.12}, {1.1, 0.175, 1.78});
        kit.paint(room.colours.galvanised);
        for (int k = 0; k < 3; ++k) {
            const double x = 0.7 + 0.14 * k, r = random.range(0.012, 0.022);
            kit.rod(wall, {x, 0.03 + r, 1.75}, {x, 0.03 + r, room.height + 0.011}, r);
        }
    }
}

void addLamps(RoomSpace& room, const std::string& tag) {
    SceneKit& kit = room.kit;
    kit.beginObject("Lamps " + tag);
    for (int i = 0; i < 4; ++i) {
        // Over the aisles, which cross in the middle.
        const double x = room.sizeX * (i == 0 ? 0.25 : i == 1 ? 0.75 : 0.5);
        const double y = room.sizeY * (i == 2 ? 0.25 : i == 3 ? 0.75 : 0.503), z = 3.45 + 0.02 * i;
        kit.paint(room.colours.white);
        kit.box(room.at, {x - 0.62, y - 0.07, z}, {x + 0.62, y + 0.07, z + 0.05});
        kit.paint(room.colours.lamp);
        for (const double side : {-0.032, 0.032}) {
            kit.rod(room.at, {x - 0.58, y + side, z - 0.015}, {x + 0.58, y + side, z - 0.015},
                    0.018);
        }
        kit.paint(room.colours.dark);
        for (const double side : {-0.5, 0.5}) {
            kit.rod(room.at, {x + side, y, z + 0.04}, {x + side, y, room.height + 0.014}, 0.006);
        }
    }
}

}  // namespace pagoda::tools
