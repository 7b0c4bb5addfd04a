// plant_boiler.cpp: the furnace with its walls of tubes, and the machines of the turbine hall.
#include "tools/generate/plant_site.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;

// Tubes up one side of the furnace, bound by buckstays; local x along the side, outside at -y.
void addWaterWall(Site& site, const Frame& at, double width, double z0, double z1, int side) {
    SceneKit& kit = site.kit;
    kit.beginObject(fmt::format("Water wall {}", side + 1));
    kit.paint(site.colours.boiler);
    const double pitch = 0.34, radius = 0.125;
    const int tubes = static_cast<int>((width - 0.6) / pitch);
    for (int i = 0; i < tubes; ++i) {
        const double x = 0.4 + i * pitch, hip = z0 + 4.5;
        const std::array<Vec3d, 4> path{Vec3d(x, 1.5, z0 + 0.3), Vec3d(x, -radius, hip),
                                        Vec3d(x, -radius, z1 - 0.6), Vec3d(x, 0.5, z1)};
        kit.tube(at, path, radius, 1.0, false);
    }
    kit.beginObject(fmt::format("Buckstays {}", side + 1));
    kit.paint(site.colours.structure);
    int level = 0;
    for (double z = z0 + 6; z < z1 - 1; z += 3.5, ++level) {
        const double out = -0.47 - 0.004 * side;
        addBeam(kit, at, {-0.35, out, z + 0.11 * side}, {width + 0.35, out, z + 0.11 * side}, 0.5);
    }
    kit.beginObject(fmt::format("Headers {}", side + 1));
    kit.paint(site.colours.insulation);
    kit.rod(at, {0.1, 1.5, z0 + 0.3 - 0.03 * side}, {width - 0.1, 1.5, z0 + 0.3 - 0.03 * side},
            0.32);
    kit.rod(at, {0.1, 0.5, z1 + 0.05 * side}, {width - 0.1, 0.5, z1 + 0.05 * side}, 0.36);
}

void addBurners(Site& site, const Frame& at, double width, double z0) {
    SceneKit& kit = site.kit;
    for (int row = 0; row < 3; ++row) {
        kit.beginObject(fmt::format("Burners {}", row + 1));
        for (int i = 0; i < 4; ++i) {
            const double x = width * (i + 0.8) / 4.6, z = z0 + 8.3 + 3.5 * row;
            kit.paint(site.colours.orange);
            kit.rod(at, {x, -1.25, z}, {x, -0.1, z}, 0.55);
            kit.rod(at, {x, -1.42, z}, {x, -1.26, z}, 0.68);
            kit.paint(site.colours.dark);
            const double aside = 0.95 + 0.55 * row, foot = -0.012 - 0.001 * row;
            const std::array<Vec3d, 3> coal{Vec3d(x, -1.35, z + 0.03),
                                            Vec3d(x + aside, -1.35, z + 0.03),
                                            Vec3d(x + aside, -1.35, foot)};
            kit.tube(at, coal, 0.2, 0.4);
        }
    }
}

// One casing on the shaft line: a barrel with flanges, split along the middle.
void addCasing(Site& site, const Frame& line, double from, double length, double radius,
               uint32_t material, const std::string& name) {
    SceneKit& kit = site.kit;
    kit.beginObject(name);
    kit.paint(material);
    std::vector<ProfilePoint> profile{{0, 0}, {radius * 0.45, 0}, {radius * 0.5, 0.25}};
    const int ribs = 5;
    for (int i = 0; i < ribs; ++i) {
        const double a = 0.3 + (length - 0.6) * i / ribs, b = a + (length - 0.6) / ribs;
        const double belly = radius * (0.82 + 0.18 * std::sin(kPi * (i + 0.5) / ribs));
        profile.insert(profile.end(), {{belly, a + 0.02},
                                       {belly, b - 0.16},
                                       {belly + 0.08, b - 0.16},
                                       {belly + 0.08, b - 0.02},
                                       {belly, b - 0.02}});
    }
    profile.insert(profile.end(),
                   {{radius * 0.5, length - 0.25}, {radius * 0.45, length}, {0, length}});
    kit.lathe({line.point({0, 0, from}), line.x, line.y, line.z}, profile);
    kit.paint(site.colours.steel);
    const Frame at = line.moved({0, 0, from});
    for (int k = 0; k < 2; ++k) {  // the split flange, bolted; line.x points down here
        const double sign = k == 0 ? 1 : -1;
        const double y0 = sign * radius * 0.78, y1 = sign * radius * 1.16;
        kit.box(at, {-0.09, std::min(y0, y1), 0.35}, {0.09, std::max(y0, y1), length - 0.35});
        for (double z = 0.55; z < length - 0.5; z += 0.45) {
            if (!kit.keeps(site.random)) continue;
            kit.rod(at, {-0.2, sign * radius * 1.09, z}, {0.2, sign * radius * 1.09, z}, 0.05);
        }
    }
}

void addMachine(Site& site, const Frame& at, int number) {
    SceneKit& kit = site.kit;
    const double height = 1.9;
    kit.beginObject(fmt::format("Foundation {}", number));
    kit.paint(site.colours.concrete);
    kit.box(at, {-0.6, -2.3, -0.015}, {37.5, 2.3, 0.85});
    const Frame line = at.aligned({0, 0, height}, {1, 0, 0});
    const double places[5] = {0.4, 6.2, 13.4, 21.0, 29.8}, lengths[5] = {5, 6.4, 6.8, 8.0, 3.4};
    const double radii[5] = {1.0, 1.35, 1.95, 1.75, 0.9};
    const uint32_t paints[5] = {site.colours.insulation, site.colours.insulation,
                                site.colours.media[2], site.colours.motor, site.colours.pump};
    const char* names[5] = {"HP turbine", "IP turbine", "LP turbine", "Generator", "Exciter"};
    for (int i = 0; i < 5; ++i) {
        addCasing(site, line, places[i], lengths[i], radii[i], paints[i],
                  fmt::format("{} {}", names[i], number));
        kit.paint(site.colours.structure);
        for (const double end : {0.41, lengths[i] - 0.93}) {
            kit.box(at, {places[i] + end, -radii[i] * 0.8, 0.84},
                    {places[i] + end + 0.5, radii[i] * 0.8, height - radii[i] * 0.35});
        }
    }
    kit.beginObject(fmt::format("Shaft {}", number));
    kit.paint(site.colours.steel);
    kit.rod(line, {0, 0, -0.2}, {0, 0, 35.5}, 0.31);
    kit.beginObject(fmt::format("Crossover pipe {}", number));
    kit.paint(site.colours.insulation);
    const std::array<Vec3d, 4> crossover{
        Vec3d(9.2, 0.1, height + 1.0), Vec3d(9.2, 0.1, height + 3.1),
        Vec3d(16.6, 0.1, height + 3.1), Vec3d(16.6, 0.1, height + 1.5)};
    kit.tube(at, crossover, 0.55, 1.1);
    for (int i = 0; i < 4; ++i) {  // steam leads up out of the deck
        kit.beginObject(fmt::format("Steam lead {}.{}", number, i + 1));
        kit.paint(site.colours.media[0]);
        const double y = i % 2 == 0 ? 2.9 : -2.9, x = 1.6 + 1.7 * i;
        const std::array<Vec3d, 4> lead{Vec3d(x, y, -0.014), Vec3d(x, y, height + 0.6 + 0.3 * i),
                                        Vec3d(x, y * 0.25, height + 0.6 + 0.3 * i),
                                        Vec3d(x, y * 0.25, height)};
        kit.tube(at, lead, 0.2, 0.5);
        addValve(kit, site.colours, at.moved({x, y, 1.3}), 0.2);
    }
    kit.beginObject(fmt::format("Machine railing {}", number));
    kit.paint(site.colours.yellow);
    const std::array<Vec3d, 5> fence{Vec3d(-1.8, -3.9, 0), Vec3d(38.6, -3.9, 0),
                                     Vec3d(38.6, 3.9, 0), Vec3d(-1.8, 3.9, 0),
                                     Vec3d(-1.8, -2.4, 0)};
    addRailing(kit, at, fence);
}

// The glazed control room at the end of the hall.
void addControlRoom(Site& site, const Frame& at) {
    SceneKit& kit = site.kit;
    const double w = 13, d = 7, h = 3.2;
    kit.beginObject("Control room");
    kit.paint(site.colours.wall);
    const std::vector<Rectangle> windows{
        {0.6, 0.95, 4.2, 2.6}, {4.7, 0.95, 8.3, 2.6}, {8.8, 0.95, 12.4, 2.6}};
    const Frame front = at.moved({d, w, 0}).quarterTurned(3);
    addWall(kit, front, w, h, 0.16, windows);
    for (const Rectangle& hole : windows) {
        addWindow(kit, front.moved({hole.u0, 0, hole.v0}),
                  {.width = hole.u1 - hole.u0,
                   .height = hole.v1 - hole.v0,
                   .wallThickness = 0.24,
                   .columns = 2,
                   .rows = 1,
                   .frameMaterial = site.colours.steel,
                   .glassMaterial = site.colours.glass,
                   .hasSill = false});
    }
    kit.paint(site.colours.wall);
    for (const double y : {0.0, w}) {
        addWall(kit, at.moved({0.004, y == 0 ? 0.083 : w - 0.083, 0.005}), d - 0.07, h - 0.03,
                0.16);
    }
    kit.paint(site.colours.cladding);
    kit.box(at, {0.002, -0.1, h - 0.007}, {d + 0.3, w + 0.1, h + 0.2});
    kit.beginObject("Control desks");
    for (int i = 0; i < 6; ++i) {
        const double y = 1.0 + 1.85 * i;
        kit.paint(site.colours.cabinet);
        kit.box(at, {4.6, y, -0.012}, {5.5, y + 1.6, 0.75});
        kit.box(at, {4.5, y - 0.03, 0.745}, {5.6, y + 1.63, 0.79});
        kit.paint(site.colours.dark);
        for (int k = 0; k < 2; ++k) {
            kit.box(at, {5.25, y + 0.1 + 0.75 * k, 0.9}, {5.3, y + 0.75 + 0.75 * k, 1.32});
            kit.box(at, {5.26, y + 0.38 + 0.75 * k, 0.785}, {5.29, y + 0.46 + 0.75 * k, 0.95});
        }
    }
}

}  // namespace

void addBoiler(Site site, const Vec3d& centre, double width, double z0, double z1) {
    SceneKit& kit = site.kit;
    kit.beginGroup("Boiler");
    const Frame middle = site.at.moved(centre);
    for (int side = 0; side < 4; ++side) {
        const Frame at = middle.quarterTurned(side).moved({-width / 2, -width / 2, 0});
        addWaterWall(site, at, width, z0, z1, side);
        if (side % 2 == 0) addBurners(site, at, width, z0);
    }
    kit.beginObject("Furnace casing");
    kit.paint(site.colours.dark);
    kit.box(middle, {0.35 - width / 2, 0.35 - width / 2, z0 + 4.4},
            {width / 2 - 0.35, width / 2 - 0.35, z1 - 0.9});
    kit.beginObject("Steam drum");
    kit.paint(site.colours.insulation);
    const Frame drum = middle.aligned({-width / 2 + 1, 2.3, z1 - 0.1}, {1, 0, 0});
    const double l = width - 2;
    const std::array<ProfilePoint, 8> shell{{{0, 0},
                                             {0.7, 0.1},
                                             {1.05, 0.5},
                                             {1.1, 0.9},
                                             {1.1, l - 0.9},
                                             {1.05, l - 0.5},
                                             {0.7, l - 0.1},
                                             {0, l}}};
    kit.lathe(drum, shell);
    kit.beginObject("Downcomers");
    for (int i = 0; i < 6; ++i) {
        kit.paint(i % 2 == 0 ? site.colours.insulation : site.colours.media[0]);
        const double x = (i - 2.5) * width / 6.5, out = width / 2 + 1.25 + 0.02 * i;
        const std::array<Vec3d, 5> path{Vec3d(x, 2.3, z1 - 0.5), Vec3d(x, 4.4, z1 - 0.8),
                                        Vec3d(x, out, z1 - 0.8), Vec3d(x, out, z0 + 2.2),
                                        Vec3d(x, out - 2.9, z0 + 0.4)};
        kit.tube(middle, path, 0.24, 0.7);
    }
    kit.endGroup();
}

void addTurbines(Site site, double length, double width, double z) {
    for (int i = 0; i < 2; ++i) {
        addMachine(site, site.at.moved({18.5, width * (0.27 + 0.46 * i), z}), i + 1);
    }
    addControlRoom(site, site.at.moved({0.4, width / 2 - 6.5, z}));
    (void)length;
}

void addHallFrame(Site site, double length, double width, double z0, double z1) {
    SceneKit& kit = site.kit;
    const int bays = 9;
    const double eaves = z1 - 3.2;
    for (int i = 0; i <= bays; ++i) {
        kit.beginObject(fmt::format("Frame {}", i + 1));
        kit.paint(site.colours.structure);
        const double x = 0.75 + (length - 1.5) * i / bays;
        for (const double y : {0.62, width - 0.62}) {
            addBeam(kit, site.at, {x, y, z0 - 0.013}, {x, y, z1 + 0.012}, 0.6);
        }
        addBeam(kit, site.at, {x + 0.01, 0.9, z1 - 0.31}, {x + 0.01, width - 0.9, z1 - 0.31}, 0.4);
        addBeam(kit, site.at, {x + 0.02, 0.85, eaves}, {x + 0.02, width - 0.85, eaves}, 0.35);
        const int webs = 12;
        for (int k = 0; k < webs; ++k) {
            const double y0 = 1 + (width - 2) * k / webs, y1 = 1 + (width - 2) * (k + 1) / webs;
            const bool rises = k % 2 == 0;
            const double beside = x + 0.015 + (rises ? 0.0 : 0.011);
            kit.rod(site.at, {beside, y0, rises ? eaves + 0.1 : z1 - 0.4},
                    {beside, y1, rises ? z1 - 0.4 : eaves + 0.1}, 0.07);
        }
    }
    kit.beginObject("Crane runway");
    kit.paint(site.colours.structure);
    for (const double y : {1.3, width - 1.3}) {
        addBeam(kit, site.at, {0.3, y, eaves - 2.2}, {length - 0.3, y, eaves - 2.2}, 0.7);
    }
    kit.beginObject("Crane");
    kit.paint(site.colours.yellow);
    const double cx = length * 0.62;
    for (const double x : {cx, cx + 2.6}) {
        kit.box(site.at, {x, 0.85, eaves - 1.8}, {x + 0.75, width - 0.85, eaves - 0.55});
    }
    for (const double y : {0.95, width - 1.75}) {
        kit.box(site.at, {cx - 0.6, y, eaves - 1.845}, {cx + 4, y + 0.8, eaves - 1.2});
    }
    kit.beginObject("Crane trolley");
    kit.paint(site.colours.red);
    kit.box(site.at, {cx - 0.15, width * 0.4, eaves - 0.54},
            {cx + 3.5, width * 0.4 + 2.2, eaves - 0.2});
    kit.paint(site.colours.steel);
    kit.rod(site.at, {cx + 1.7, width * 0.4 + 0.3, eaves - 0.18},
            {cx + 1.7, width * 0.4 + 1.9, eaves - 0.18}, 0.4);
    for (int k = 0; k < 4; ++k) {
        const double rx = cx + 1.55 + 0.1 * k;
        kit.rod(site.at, {rx, width * 0.4 + 1.1, eaves - 5}, {rx, width * 0.4 + 1.1, eaves - 0.3},
                0.018);
    }
    kit.paint(site.colours.yellow);
    kit.box(site.at, {cx + 1.4, width * 0.4 + 0.85, eaves - 5.6},
            {cx + 2, width * 0.4 + 1.35, eaves - 4.95});
    const std::array<Vec3d, 6> hook{Vec3d(cx + 1.7, width * 0.4 + 1.1, eaves - 5.5),
                                    Vec3d(cx + 1.7, width * 0.4 + 1.1, eaves - 6.1),
                                    Vec3d(cx + 2.1, width * 0.4 + 1.1, eaves - 6.3),
                                    Vec3d(cx + 2.05, width * 0.4 + 1.1, eaves - 6.8),
                                    Vec3d(cx + 1.55, width * 0.4 + 1.1, eaves - 6.85),
                                    Vec3d(cx + 1.35, width * 0.4 + 1.1, eaves - 6.45)};
    kit.tube(site.at, hook, 0.09, 0.3);
}

}  // namespace pagoda::tools
