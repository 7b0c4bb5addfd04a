// plant_outside.cpp: what stands around the buildings of the power plant, and the ground.
#include "tools/generate/plant_site.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kYard = -0.1;  // top of the asphalt

void addChimney(Site& site, const Vec3d& foot) {
    const int sections = 9;
    const double section = 12;
    for (int i = 0; i < sections; ++i) {
        site.kit.beginObject(fmt::format("Chimney section {}", i + 1));
        const bool isBand = i >= 5;
        site.kit.paint(!isBand      ? site.colours.concrete
                       : i % 2 == 1 ? site.colours.red
                                    : site.colours.white);
        const auto radius = [](double z) { return 5.2 - 2.3 * std::pow(z / 108, 0.7); };
        std::vector<ProfilePoint> profile;
        const double z0 = i * section + (i == 0 ? -0.02 : 0.004), z1 = (i + 1) * section - 0.004;
        for (int k = 0; k <= 4; ++k) {
            const double z = std::lerp(z0, z1, k / 4.0);
            profile.push_back({radius(std::max(z, 0.0)), z});
        }
        profile.push_back({radius(z1) - 0.45, z1});
        profile.push_back({radius(z0 < 0 ? 0 : z0) - 0.45, z0});
        site.kit.lathe(site.at.moved(foot), profile);
        if (i % 3 != 2) continue;
        site.kit.beginObject(fmt::format("Chimney gallery {}", i / 3 + 1));
        site.kit.paint(site.colours.steel);
        const Frame gallery = site.at.moved(foot + Vec3d(0, 0, z1 - 2));
        const double r = radius(z1 - 2);
        const std::array<ProfilePoint, 5> floor{
            {{r - 0.1, 0}, {r + 1.1, 0}, {r + 1.1, 0.06}, {r - 0.1, 0.06}, {r - 0.1, 0}}};
        site.kit.lathe(gallery, floor);
        site.kit.paint(site.colours.yellow);
        for (const double up : {0.55, 1.1}) site.kit.ring(gallery.moved({0, 0, up}), r + 1.0, 0.03);
        for (int post = 0; post < 20; ++post) {
            const double a = 2 * kPi * post / 20, pr = r + 1.0;
            site.kit.rod(gallery, {pr * std::cos(a), pr * std::sin(a), 0.04},
                         {pr * std::cos(a), pr * std::sin(a), 1.1}, 0.025);
        }
    }
}

void addCoolingTower(Site& site, const Vec3d& foot, int number) {
    SceneKit& kit = site.kit;
    const double height = 84, throat = 62;
    const auto radius = [&](double z) {
        return 19 * std::sqrt(1 + std::pow((z - throat) / 42, 2));
    };
    const Frame at = site.at.moved(foot);
    kit.beginObject(fmt::format("Cooling tower {}", number));
    kit.paint(site.colours.concrete);
    std::vector<ProfilePoint> shell;
    const int rows = std::max(8, static_cast<int>(28 * std::sqrt(std::min(4.0, kit.detail()))));
    const double base = 8;
    for (int i = 0; i <= rows; ++i) {
        const double z = std::lerp(base, height, static_cast<double>(i) / rows);
        shell.push_back({radius(z), z});
    }
    for (int i = rows; i >= 0; --i) {
        const double z = std::lerp(base, height, static_cast<double>(i) / rows);
        shell.push_back({radius(z) - 0.6, z});
    }
    shell.push_back(shell.front());
    kit.lathe(at, shell);
    kit.beginObject(fmt::format("Cooling tower legs {}", number));
    const int pairs = 24;
    for (int i = 0; i < pairs; ++i) {
        for (const double lean : {-0.5, 0.5}) {
            const double a = 2 * kPi * i / pairs, b = 2 * kPi * (i + lean) / pairs;
            const double r0 = radius(0) - 0.3, r1 = radius(base) - 0.3;
            kit.rod(at, {r0 * std::cos(a), r0 * std::sin(a), -0.2},
                    {r1 * std::cos(b), r1 * std::sin(b), base + 0.25}, 0.42);
        }
    }
    kit.beginObject(fmt::format("Cooling tower basin {}", number));
    const double r = radius(0) + 2.5;
    const std::array<ProfilePoint, 5> rim{
        {{r - 0.5, -0.3}, {r, -0.3}, {r, 1.1}, {r - 0.5, 1.1}, {r - 0.5, -0.3}}};
    kit.lathe(at, rim);
}

void addTankFarm(Site& site, const Vec3d& corner) {
    SceneKit& kit = site.kit;
    for (int i = 0; i < 6; ++i) {
        const double r = 5.5 + 0.55 * (i % 3), h = 9 + 1.4 * (i % 2), x = corner.x + 17.0 * (i % 2),
                     y = corner.y + 17.0 * (i / 2);
        const Frame at = site.at.moved({x, y, kYard});
        kit.beginObject(fmt::format("Tank {}", i + 1));
        kit.paint(i % 2 == 0 ? site.colours.white : site.colours.insulation);
        std::vector<ProfilePoint> profile{{r, -0.015}};
        for (double z = 1.8; z < h; z += 1.8) {
            profile.insert(profile.end(),
                           {{r, z}, {r + 0.03, z}, {r + 0.03, z + 0.07}, {r, z + 0.07}});
        }
        profile.insert(profile.end(), {{r, h}, {r * 0.5, h + 0.85}, {0, h + 1.05}});
        kit.lathe(at, profile);
        kit.beginObject(fmt::format("Tank stairs {}", i + 1));
        kit.paint(site.colours.yellow);
        const int steps = static_cast<int>(h / 0.2237);
        std::vector<Vec3d> rail;
        for (int k = 0; k < steps; ++k) {  // winding up the shell
            const double a = 0.3 + k * 0.28 / r, z = 0.2071 + k * 0.2237;
            const Frame step = at.turned(a).moved({r, 0, z});
            kit.box(step, {-0.05, -0.14, 0}, {0.85, 0.14, 0.035});
            if (k % 5 == 0) {
                rail.push_back({(r + 0.83) * std::cos(a), (r + 0.83) * std::sin(a), z + 1.1});
                kit.rod(step, {0.83, 0, 0.02}, {0.83, 0, 1.1}, 0.02);
            }
        }
        kit.tube(at, rail, 0.025, 0.4);
    }
}

// A trestle with pipes from (x0) to (x1) at y; loops take up their stretch.
void addPipeBridge(Site& site, double x0, double x1, double y) {
    SceneKit& kit = site.kit;
    const int bays = static_cast<int>(std::abs(x1 - x0) / 7.5);
    kit.beginObject("Pipe bridge");
    kit.paint(site.colours.structure);
    for (int i = 0; i <= bays; ++i) {
        const double x = std::lerp(x0, x1, static_cast<double>(i) / bays);
        for (const double dy : {0.0, 5.0}) {
            addBeam(kit, site.at, {x, y + dy, kYard - 0.015}, {x, y + dy, 7.0}, 0.35);
        }
        for (const double z : {4.7, 6.6}) {
            addBeam(kit, site.at, {x + 0.01, y - 0.4, z}, {x + 0.01, y + 5.4, z}, 0.28);
        }
        if (i < bays && i % 2 == 0) {
            const double next = std::lerp(x0, x1, (i + 1.0) / bays);
            kit.rod(site.at, {x, y + 0.003, 0.4}, {next, y + 0.003, 4.4}, 0.05);
            kit.rod(site.at, {x, y + 5.003, 0.4}, {next, y + 5.003, 4.4}, 0.05);
        }
    }
    for (int line = 0; line < 12; ++line) {
        const int tier = line / 6, medium = line % 6;
        kit.beginObject(fmt::format("Bridge line {} {}", line + 1, kMediumNames[medium]));
        kit.paint(site.colours.media[medium]);
        const double r = 0.09 + 0.13 * site.random.unit();
        const double py = y + 0.45 + 0.82 * (line % 6), z = (tier == 0 ? 4.845 : 6.745) + r;
        std::vector<Vec3d> path{{x0, py, z}};
        const double loop = std::lerp(x0, x1, 0.35 + 0.05 * (line % 6));
        const double sign = x1 > x0 ? 1 : -1;
        path.insert(path.end(), {{loop, py, z},
                                 {loop, py, z + 1.1 + r},
                                 {loop + sign * 1.7, py, z + 1.1 + r},
                                 {loop + sign * 1.7, py, z},
                                 {x1, py, z}});
        kit.tube(site.at, path, r, r * 2 + 0.1);
        for (int k = 0; k < 5; ++k) {
            if (!kit.keeps(site.random)) continue;
            const double x = std::lerp(x0, x1, (k + 0.6) / 8.0 + (k > 2 ? 0.3 : 0));
            addFlange(kit, site.at.aligned({x, py, z}, {1, 0, 0}), r, site.random);
        }
    }
}

void addTransformer(Site& site, const Vec3d& place, int number) {
    SceneKit& kit = site.kit;
    const Frame at = site.at.moved(place + Vec3d(0, 0, kYard));
    kit.beginObject(fmt::format("Transformer {}", number));
    kit.paint(site.colours.concrete);
    kit.box(at, {-0.6, -0.6, -0.02}, {6.8, 4.2, 0.35});
    kit.paint(site.colours.cabinet);
    kit.box(at, {0.4, 0.5, 0.34}, {5.8, 3.1, 3.3});
    kit.box(at, {0.3, 0.4, 3.29}, {5.9, 3.2, 3.45});
    for (int i = 0; i < 24; ++i) {  // radiators
        const double x = 0.55 + 0.215 * i;
        kit.box(at, {x, -0.35, 0.7}, {x + 0.05, 0.46, 3.0});
        kit.box(at, {x, 3.14, 0.71}, {x + 0.05, 3.95, 3.01});
    }
    kit.rod(at, {0.6, 1.1, 4.4}, {3.6, 1.1, 4.4}, 0.42);
    for (const double x : {1.0, 3.2}) kit.rod(at, {x, 1.1, 3.4}, {x, 1.1, 4.1}, 0.1);
    kit.beginObject(fmt::format("Bushings {}", number));
    kit.paint(site.colours.brick);
    for (int i = 0; i < 3; ++i) {
        const Frame foot =
            at.moved({1.2 + 1.7 * i, 2.3, 3.43}).aligned({0, 0, 0}, {0.12 * (i - 1), 0.1, 1});
        std::vector<ProfilePoint> ribs{{0.17, 0}};
        for (int k = 0; k < 12; ++k) {
            const double z = 0.1 + 0.13 * k, r = 0.26 - 0.008 * k;
            ribs.insert(ribs.end(), {{0.13, z}, {r, z + 0.03}, {r, z + 0.05}, {0.13, z + 0.09}});
        }
        ribs.insert(ribs.end(), {{0.06, 1.72}, {0.06, 2.0}, {0, 2.0}});
        kit.lathe(foot, ribs);
    }
}

// Electrostatic precipitators between boiler house and chimney, with hoppers and flue ducts.
void addFlueGas(Site& site, double x0, double x1, double y) {
    SceneKit& kit = site.kit;
    for (int i = 0; i < 2; ++i) {
        const double y0 = y + (i == 0 ? -16 : 2.5), y1 = y0 + 13.5;
        kit.beginObject(fmt::format("Precipitator {}", i + 1));
        kit.paint(site.colours.cladding);
        kit.box(site.at, {x0, y0, 8}, {x1, y1, 22});
        kit.paint(site.colours.structure);
        for (double x = x0 + 0.25; x < x1; x += 2.1) {
            for (double z = 8.4; z < 22; z += 3.1) {
                kit.box(site.at, {x, y0 - 0.17, z}, {x + 0.18, y0 + 0.05, z + 2.9});
                kit.box(site.at, {x, y1 - 0.05, z}, {x + 0.18, y1 + 0.17, z + 2.9});
            }
        }
        for (int k = 0; k < 4; ++k) {
            const double hx = x0 + (x1 - x0) * (k % 2 + 0.5) / 2,
                         hy = y0 + 13.5 * (k / 2 + 0.5) / 2;
            const Frame hopper = site.at.moved({hx, hy, 0}).turned(kPi / 4);
            const std::array<ProfilePoint, 4> cone{{{0, 3.4}, {0.35, 3.4}, {3.3, 8.2}, {0, 8.2}}};
            kit.paint(site.colours.steel);
            kit.lathe(hopper, cone);
            for (const double sx : {-2.9, 2.9}) {
                addBeam(kit, site.at, {hx + sx, hy + 2.6, kYard - 0.02}, {hx + sx, hy + 2.6, 8.3},
                        0.4);
                addBeam(kit, site.at, {hx + sx, hy - 2.6, kYard - 0.02}, {hx + sx, hy - 2.6, 8.3},
                        0.4);
            }
        }
        kit.beginObject(fmt::format("Flue duct {}", i + 1));
        kit.paint(site.colours.duct);
        const double dy = (y0 + y1) / 2;
        kit.box(site.at, {x0 - 7, dy - 2.5, 13}, {x0 + 0.1, dy + 2.5, 18});
        kit.box(site.at, {x1 - 0.1, dy - 2.2, 12.2}, {x1 + 12, dy + 2.2, 16.8});
        kit.beginObject(fmt::format("Roof railing {}", i + 1));
        kit.paint(site.colours.yellow);
        const std::array<Vec3d, 5> fence{
            Vec3d(x0 + 0.3, y0 + 0.3, 22), Vec3d(x1 - 0.3, y0 + 0.3, 22),
            Vec3d(x1 - 0.3, y1 - 0.3, 22), Vec3d(x0 + 0.3, y1 - 0.3, 22),
            Vec3d(x0 + 0.3, y0 + 0.6, 22)};
        addRailing(kit, site.at, fence);
    }
}

void addGround(Site& site) {
    SceneKit& kit = site.kit;
    kit.beginObject("Yard");
    kit.paint(site.colours.asphalt);
    const int nx = 8, ny = 8;
    const double px = 32, py = 20;
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {  // slabs with joints
            const double x = -66 + i * px, y = -36 + j * py,
                         top = kYard - 0.02 * site.random.unit();
            kit.box(site.at, {x + 0.02, y + 0.02, -0.5}, {x + px - 0.02, y + py - 0.02, top});
        }
    }
    kit.beginObject("Ground");
    kit.paint(site.colours.ground);
    const uint64_t seed = site.random.next();
    kit.sheet(site.at.moved({-120, -70, -0.4}), 370, 210, 90, [&](double x, double y) {
        const bool isRim = x < 0.01 || y < 0.01 || x > 369.9 || y > 209.9;
        return isRim ? -0.02 : 0.1 * valueNoise({x * 0.05, y * 0.05, 0.5}, seed);
    });
}

}  // namespace

void addRoofPlant(Site site, double length, double width) {
    SceneKit& kit = site.kit;
    kit.beginObject("Roof railing");
    kit.paint(site.colours.yellow);
    const std::array<Vec3d, 5> edge{Vec3d(0.2, 0.2, 0), Vec3d(length - 0.2, 0.2, 0),
                                    Vec3d(length - 0.2, width - 0.2, 0), Vec3d(0.2, width - 0.2, 0),
                                    Vec3d(0.2, 0.5, 0)};
    addRailing(kit, site.at, edge);
    const int nx = static_cast<int>(length / 9), ny = static_cast<int>(width / 9);
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            Random random = site.random.fork(static_cast<uint64_t>(j * 64 + i));
            if (!random.chance(0.7)) continue;
            const Frame at = site.at.moved({length * (i + 0.5) / nx + random.range(-1.5, 1.5),
                                            width * (j + 0.5) / ny + random.range(-1.5, 1.5), 0});
            kit.beginObject(fmt::format("Roof unit {}.{}", j + 1, i + 1));
            if (random.chance(0.5)) {  // a fan in its box, with a duct
                const double h = random.range(1.2, 2.2);
                kit.paint(site.colours.duct);
                kit.box(at, {-1.6, -1.1, -0.02}, {1.6, 1.1, h});
                const std::array<Vec3d, 3> elbow{Vec3d(1.5, 0, 0.95), Vec3d(2.7, 0, 0.95),
                                                 Vec3d(2.7, 0, -0.03)};
                kit.tube(at, elbow, 0.26, 0.4);
                kit.paint(site.colours.dark);
                kit.ring(at.moved({0, 0, h + 0.02}), 0.8, 0.07);
                for (int blade = 0; blade < 5; ++blade) {
                    kit.box(at.turned(2 * kPi * blade / 5), {0.1, -0.15, h + 0.03 + 0.004 * blade},
                            {0.76, 0.15, h + 0.05 + 0.004 * blade});
                }
            } else {  // a vent pipe with its hat
                const double r = random.range(0.3, 0.7), h = random.range(1.5, 4.0);
                kit.paint(site.colours.galvanised);
                const std::array<ProfilePoint, 8> vent{{{r * 1.4, -0.02},
                                                        {r * 1.4, 0.25},
                                                        {r, 0.45},
                                                        {r, h},
                                                        {r * 0.6, h},
                                                        {r * 0.6, h + 0.3},
                                                        {r * 1.5, h + 0.32},
                                                        {0, h + 0.32 + r * 0.6}}};
                kit.lathe(at, vent);
            }
        }
    }
}

void addSurroundings(Site site) {
    addGround(site);
    addChimney(site, {168, 25, kYard});
    addFlueGas(site, 138, 153, 26);
    addCoolingTower(site, {8, 84, -0.15}, 1);
    addCoolingTower(site, {92, 99, -0.15}, 2);
    addTankFarm(site, {-52, -24, 0});
    addPipeBridge(site, 128, -40, -14);
    for (int i = 0; i < 3; ++i) addTransformer(site, {6.0 + 14 * i, -9, 0}, i + 1);
}

}  // namespace pagoda::tools
