// city.cpp: a grid of streets and blocks. Each block is closed by houses of its own height, colour
// and roof around a yard; facades have window openings with frames, glass and sills. More triangles
// make more blocks.
#include "tools/generate/city_house.h"
#include "tools/generate/detail_search.h"
#include "tools/generate/generator.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pagoda::tools {
namespace {

constexpr double kBlockX = 84, kBlockY = 62, kStreet = 18, kDepthOfHouse = 12.5;
constexpr double kWalk = 3.6, kCurb = 0.14;  // pavement: width and height above the street
constexpr double kTrianglesPerBlock = 150000;

void addTree(SceneKit& kit, const CityPalette& colours, const Frame& at, Random random) {
    const double h = random.range(2.2, 3.2), r = random.range(1.3, 2.1);
    kit.paint(colours.bark);
    const std::array<ProfilePoint, 4> trunk{
        {{0.24, -0.02}, {0.15, 0.5}, {0.12, h + 0.6}, {0, h + 0.6}}};
    kit.lathe(at, trunk);
    kit.paint(colours.leaf);
    for (int i = 0; i < 5; ++i) {
        const double a = 2.4 * i, d = i == 0 ? 0 : r * 0.55;
        const Frame crown = at.moved(
            {d * std::cos(a), d * std::sin(a), h + r * (i == 0 ? 1.1 : random.range(0.5, 0.9))});
        kit.blob(crown, Vec3d(r * 0.75, r * 0.75, r * 0.7), 0.22, random.next());
    }
}

void addStreetLamp(SceneKit& kit, const CityPalette& colours, const Frame& at) {
    kit.paint(colours.dark);
    const std::array<Vec3d, 4> pole{Vec3d(0, 0, -0.02), Vec3d(0, 0, 6.6), Vec3d(0, -1.4, 7.2),
                                    Vec3d(0, -2.0, 7.2)};
    kit.tube(at, pole, 0.07, 0.8);
    kit.paint(colours.lamp);
    kit.box(at, {-0.14, -2.5, 7.12}, {0.14, -1.9, 7.25});
}

void addCar(SceneKit& kit, const CityPalette& colours, const Frame& at, Random random) {
    kit.paint(colours.paints[static_cast<size_t>(random.integer(0, 4))]);
    const std::array<glm::dvec2, 8> body{
        glm::dvec2(-2.1, 0.28), {2.1, 0.28},  {2.15, 0.6}, {1.9, 0.85}, {0.9, 0.95},
        {-1.5, 0.98},           {-2.05, 0.9}, {-2.15, 0.6}};
    const Frame side{at.point({0, 0.85, 0}), at.x, at.z, -at.y};
    kit.prism(side, body, 0, 1.7);
    kit.paint(colours.glass);
    const std::array<glm::dvec2, 4> cabin{
        glm::dvec2(-1.45, 0.93), {0.95, 0.9}, {0.3, 1.42}, {-1.0, 1.44}};
    kit.prism(side.moved({0, 0, 0.1}), cabin, 0, 1.5);
    for (const double x : {-1.3, 1.3}) {
        for (const double y : {-0.83, 0.65}) {
            kit.paint(colours.tyre);
            kit.rod(at, {x, y, 0.31}, {x, y + 0.19, 0.31}, 0.31);
            kit.paint(colours.metal);
            kit.rod(at, {x, y - 0.006, 0.31}, {x, y + 0.196, 0.31}, 0.18);
        }
    }
}

void addBlock(SceneKit& kit, const CityPalette& colours, const Frame& at, Random random,
              const std::string& name) {
    kit.beginGroup("Block " + name);
    kit.beginObject("Pavement " + name);
    kit.paint(colours.pavement);
    const std::array<Rectangle, 1> yard{
        {{kWalk + kDepthOfHouse + 0.6, kWalk + kDepthOfHouse + 0.6,
          kBlockX - kWalk - kDepthOfHouse - 0.6, kBlockY - kWalk - kDepthOfHouse - 0.6}}};
    addSlab(kit, at, {0, 0, kBlockX, kBlockY}, 0.4, yard);
    kit.beginObject("Yard " + name);
    kit.paint(colours.grass);
    const Rectangle& y = yard[0];
    const uint64_t bumps = random.next();
    kit.sheet(at.moved({y.u0 - 0.2, y.v0 - 0.2, -0.15}), y.u1 - y.u0 + 0.4, y.v1 - y.v0 + 0.4, 40,
              [&](double px, double py) {
                  return 0.12 * valueNoise({px * 0.3, py * 0.3, 0.5}, bumps);
              });
    int house = 0;
    for (int side = 0; side < 4; ++side) {
        const bool isLong = side % 2 == 0;
        const double length = (isLong ? kBlockX : kBlockY - 2 * kDepthOfHouse - 0.04) - 2 * kWalk;
        const Vec3d corner[4] = {{kWalk, kWalk, 0},
                                 {kBlockX - kWalk, kWalk + kDepthOfHouse + 0.02, 0},
                                 {kBlockX - kWalk, kBlockY - kWalk, 0},
                                 {kWalk, kBlockY - kWalk - kDepthOfHouse - 0.02, 0}};
        const int count = std::max(1, static_cast<int>(std::lround(length / random.range(13, 18))));
        double x = 0;
        for (int i = 0; i < count; ++i) {
            const double width =
                i + 1 == count ? length - x : length / count * random.range(0.85, 1.15);
            const Frame front = at.moved(corner[side]).quarterTurned(side).moved({x, 0, 0});
            addHouse({kit, colours, front, width, kDepthOfHouse,
                      random.fork(static_cast<uint64_t>(++house)),
                      fmt::format("{}.{}", name, house)});
            x += width;
        }
    }
    kit.beginObject("Trees " + name);
    for (int i = 0; i < 14; ++i) {
        const bool inYard = i < 6;
        const double side = i % 2 == 0 ? 0.9 : kBlockY - 0.9;
        const Vec3d place =
            inYard ? Vec3d(random.range(y.u0 + 3, y.u1 - 3), random.range(y.v0 + 3, y.v1 - 3), -0.2)
                   : Vec3d(8 + (i - 6) / 2 * 21.0 + random.range(-1, 1), side, 0);
        if (kit.keeps(random))
            addTree(kit, colours, at.moved(place), random.fork(static_cast<uint64_t>(i)));
    }
    kit.beginObject("Lamps " + name);
    for (int i = 0; i < 4; ++i) {
        addStreetLamp(kit, colours, at.moved({14 + i * 19.0, 0.5, 0}));
        addStreetLamp(kit, colours, at.moved({14.3 + i * 19.0, kBlockY - 0.5, 0}).quarterTurned(2));
    }
    kit.beginObject("Cars " + name);
    for (int i = 0; i < 12; ++i) {
        const double x = 5 + i * 6.3 + random.range(0, 0.8),
                     lane = i % 2 == 0 ? -1.4 : kBlockY + 1.4;
        if (random.chance(0.7))
            addCar(kit, colours, at.moved({x, lane, -kCurb}),
                   random.fork(static_cast<uint64_t>(50 + i)));
    }
    kit.endGroup();
}

void addStreets(SceneKit& kit, const CityPalette& colours, int nx, int ny) {
    kit.beginObject("Streets");
    kit.paint(colours.asphalt);
    const double x = nx * (kBlockX + kStreet) + kStreet, y = ny * (kBlockY + kStreet) + kStreet;
    addSlab(kit, Frame{}.moved({-kStreet, -kStreet, -kCurb}), {0, 0, x, y}, 0.21);
    kit.beginObject("Road markings");
    kit.paint(colours.line);
    for (int j = 0; j <= ny; ++j) {
        const double cy = j * (kBlockY + kStreet) - kStreet / 2;
        for (double cx = 0; cx < x - kStreet; cx += 6) {
            if (std::fmod(cx, kBlockX + kStreet) > kBlockX - 3) continue;
            kit.box(Frame{}, {cx, cy - 0.08, -kCurb - 0.01}, {cx + 3, cy + 0.08, -kCurb + 0.006});
        }
    }
    for (int i = 0; i <= nx; ++i) {
        const double cx = i * (kBlockX + kStreet) - kStreet / 2;
        for (double cy = 0; cy < y - kStreet; cy += 6) {
            if (std::fmod(cy, kBlockY + kStreet) > kBlockY - 3) continue;
            kit.box(Frame{}, {cx - 0.08, cy, -kCurb - 0.01}, {cx + 0.08, cy + 3, -kCurb + 0.006});
        }
    }
}

void buildCity(SceneKit& kit, int nx, int ny, uint64_t seed) {
    const CityPalette colours(kit);
    addStreets(kit, colours, nx, ny);
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            const Frame at = Frame{}.moved({i * (kBlockX + kStreet), j * (kBlockY + kStreet), 0});
            addBlock(kit, colours, at, Random(seed).fork(static_cast<uint64_t>(j * 65536 + i)),
                     fmt::format("{}-{}", j + 1, i + 1));
        }
    }
    kit.flush();
}

}  // namespace

SceneViews generateCity(ooc::TriangleSink& sink, const GenerateOptions& options) {
    const double blocks =
        std::max(1.0, static_cast<double>(options.triangles) / kTrianglesPerBlock);
    const int nx = std::max(1, static_cast<int>(std::lround(std::sqrt(blocks * 0.85))));
    const int ny = std::max(1, static_cast<int>(std::lround(blocks / nx)));
    const double detail = findDetail(options.triangles, "city",
                                     [&](SceneKit& kit) { buildCity(kit, nx, ny, options.seed); });
    SceneKit kit(&sink, detail);
    buildCity(kit, nx, ny, options.seed);
    const double x = nx * (kBlockX + kStreet), y = ny * (kBlockY + kStreet);
    SceneViews views;
    views.outside = {{{-0.25 * x - 40, -0.3 * y - 30, 0.35 * x + 50}, {0.45 * x, 0.4 * y, 0}},
                     {{-9, -9, 6}, {0.3 * x, 12, 7}},
                     {{0.55 * x, -45, 40}, {0.4 * x, 40, 8}}};
    return views;
}

}  // namespace pagoda::tools
