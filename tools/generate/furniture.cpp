#include "tools/generate/furniture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFoot = -0.012;  // feet end inside the floor

// A rectangle about the origin with round corners.
std::vector<glm::dvec2> roundedOutline(double x, double y, double r, double detail) {
    std::vector<glm::dvec2> outline;
    const int steps = std::clamp(static_cast<int>(std::lround(3 * std::sqrt(detail))), 1, 12);
    for (int corner = 0; corner < 4; ++corner) {
        const double cx = (corner == 0 || corner == 3 ? 1 : -1) * (x / 2 - r);
        const double cy = (corner < 2 ? 1 : -1) * (y / 2 - r);
        for (int i = 0; i <= steps; ++i) {
            const double a = kPi / 2 * (corner + static_cast<double>(i) / steps);
            outline.emplace_back(cx + r * std::cos(a), cy + r * std::sin(a));
        }
    }
    return outline;
}

}  // namespace

InteriorPalette::InteriorPalette(SceneKit& kit)
    : plaster(kit.addMaterial("plaster", 0xE4DFD3)),
      facade(kit.addMaterial("facade", 0xCDB79B)),
      ceiling(kit.addMaterial("ceiling", 0xF0EEE8)),
      stone(kit.addMaterial("stone", 0xB9B4AA)),
      oak(kit.addMaterial("oak", 0xC49A63)),
      walnut(kit.addMaterial("walnut", 0x7A5437)),
      birch(kit.addMaterial("birch", 0xDCC39B)),
      white(kit.addMaterial("white lacquer", 0xF1EFEA)),
      black(kit.addMaterial("black", 0x35363A)),
      steel(kit.addMaterial("steel", 0x8E9499)),
      chrome(kit.addMaterial("chrome", 0xC5CACE)),
      glass(kit.addMaterial("glass", 0xBFD9E0, 0.3)),
      screen(kit.addMaterial("screen", 0x2C4A66)),
      leaf(kit.addMaterial("leaf", 0x4F7F3F)),
      clay(kit.addMaterial("clay", 0xB3694A)),
      lamp(kit.addMaterial("lamp", 0xFFF3D0)),
      brass(kit.addMaterial("brass", 0xB8954A)),
      paper(kit.addMaterial("paper", 0xF4EFE0)),
      roof(kit.addMaterial("roof", 0x6B6660)),
      fabrics{kit.addMaterial("fabric blue", 0x4A6A8A), kit.addMaterial("fabric grey", 0x8A8782),
              kit.addMaterial("fabric rust", 0xB0603F), kit.addMaterial("fabric green", 0x6F8A63),
              kit.addMaterial("fabric sand", 0xCDBB99)},
      books{kit.addMaterial("book red", 0x9A3B34),   kit.addMaterial("book blue", 0x35557F),
            kit.addMaterial("book green", 0x4A6B4B), kit.addMaterial("book ochre", 0xC29A45),
            kit.addMaterial("book white", 0xE3DCCB), kit.addMaterial("book black", 0x3A3836),
            kit.addMaterial("book brown", 0x7C5A40), kit.addMaterial("book violet", 0x6B5478)},
      carpets{kit.addMaterial("carpet grey", 0x8D8F93), kit.addMaterial("carpet blue", 0x63788C),
              kit.addMaterial("carpet sand", 0xB8A98A), kit.addMaterial("carpet green", 0x76846F)},
      paints{kit.addMaterial("paint red", 0xC2453A), kit.addMaterial("paint yellow", 0xE0B84A),
             kit.addMaterial("paint teal", 0x3F8A8C), kit.addMaterial("paint navy", 0x2F3F66)} {
}

void Furnisher::begin(const char* name) {
    kit.beginObject(fmt::format("{} {}.{}", name, room, ++count_));
}

void Furnisher::cushion(const Frame& at, double x, double y, double z) {
    const double r = std::min({x, y, z}) * 0.3;
    // Three layers, the middle one proud: the edges read as soft.
    const std::vector<glm::dvec2> inner = roundedOutline(x - r, y - r, r, kit.detail());
    const std::vector<glm::dvec2> outer = roundedOutline(x, y, r * 1.4, kit.detail());
    kit.prism(at, inner, 0, z);
    kit.prism(at, outer, z * 0.2, z * 0.8);
}

void Furnisher::officeChair(const Frame& at) {
    begin("Office chair");
    kit.paint(colours.black);
    for (int i = 0; i < 5; ++i) {
        const Frame arm = at.turned(2 * kPi * i / 5 + 0.2);
        const std::array<Vec3d, 2> leg{Vec3d(0.0, 0, 0.105 + 0.001 * i), Vec3d(0.29, 0, 0.075)};
        kit.tube(arm, leg, 0.021, 0.1);
        kit.ball(arm.moved({0.29, 0, 0.028}), 0.03);
    }
    kit.paint(colours.chrome);
    kit.rod(at, {0, 0, 0.09}, {0, 0, 0.43}, 0.027);
    kit.paint(colours.fabrics[random.integer(0, 4)]);
    cushion(at.moved({0, 0, 0.42}), 0.48, 0.47, 0.09);
    const Frame back = at.moved({0, -0.235, 0.58}).aligned({0, 0, 0}, {0, 1, 0.08});
    // The back cushion stands: its local z points forward.
    const Frame upright{back.origin, at.x, glm::cross(back.z, at.x), back.z};
    cushion(upright.moved({0, 0.21, 0}), 0.44, 0.52, 0.07);
    kit.paint(colours.black);
    const std::array<Vec3d, 3> spine{Vec3d(0, -0.05, 0.41), Vec3d(0, -0.27, 0.42),
                                     Vec3d(0, -0.25, 0.72)};
    kit.tube(at, spine, 0.018, 0.08);
    for (const double x : {-0.27, 0.27}) {
        const std::array<Vec3d, 4> rest{Vec3d(x * 0.8, 0, 0.44), Vec3d(x, 0, 0.45),
                                        Vec3d(x, 0, 0.64), Vec3d(x, 0.16, 0.655)};
        kit.tube(at, rest, 0.015, 0.05);
    }
}

void Furnisher::woodenChair(const Frame& at, uint32_t wood) {
    begin("Chair");
    kit.paint(wood);
    for (const double x : {-0.19, 0.19}) {
        kit.rod(at, {x, 0.19, kFoot}, {x * 0.95, 0.17, 0.44}, 0.017);
        const std::array<Vec3d, 3> leg{Vec3d(x, -0.21, kFoot), Vec3d(x * 0.97, -0.18, 0.45),
                                       Vec3d(x * 0.97, -0.25, 0.86)};
        kit.tube(at, leg, 0.016, 0.2);
    }
    kit.prism(at, roundedOutline(0.43, 0.42, 0.06, kit.detail()), 0.43, 0.455);
    for (int slat = 0; slat < 3; ++slat) {
        const double z = 0.58 + 0.1 * slat, y = -0.19 - (z - 0.45) * 0.17;
        kit.box(at, {-0.19, y - 0.01, z - 0.03}, {0.19, y + 0.005, z + 0.03});
    }
}

void Furnisher::cup(const Frame& at) {
    kit.paint(random.chance(0.5) ? colours.white : colours.paints[random.integer(0, 3)]);
    const std::array<ProfilePoint, 7> profile{{{0, -0.003},
                                               {0.03, -0.003},
                                               {0.038, 0.03},
                                               {0.04, 0.09},
                                               {0.036, 0.09},
                                               {0.034, 0.02},
                                               {0, 0.012}}};
    kit.lathe(at, profile);
    const std::array<Vec3d, 4> handle{Vec3d(0.036, 0, 0.075), Vec3d(0.066, 0, 0.07),
                                      Vec3d(0.062, 0, 0.028), Vec3d(0.034, 0, 0.025)};
    kit.tube(at, handle, 0.005, 0.012);
}

void Furnisher::deskLamp(const Frame& at) {
    kit.paint(colours.brass);
    const std::array<ProfilePoint, 5> base{
        {{0, -0.004}, {0.085, -0.004}, {0.08, 0.014}, {0.02, 0.026}, {0, 0.026}}};
    kit.lathe(at, base);
    const std::array<Vec3d, 4> arm{Vec3d(0, 0, 0.02), Vec3d(0, -0.02, 0.3), Vec3d(0, 0.16, 0.46),
                                   Vec3d(0, 0.22, 0.44)};
    kit.tube(at, arm, 0.008, 0.05);
    const std::array<ProfilePoint, 5> shade{
        {{0.078, 0}, {0.082, 0}, {0.032, 0.11}, {0, 0.125}, {0, 0.12}}};
    kit.lathe(at.aligned({0, 0.235, 0.35}, {0, -0.2, 1}), std::span(shade).first(4));
}

void Furnisher::keyboard(const Frame& at) {
    kit.paint(colours.black);
    kit.box(at, {-0.22, -0.07, -0.003}, {0.22, 0.07, 0.014});
    if (!kit.keeps(random)) return;
    kit.paint(colours.white);
    for (int row = 0; row < 5; ++row) {
        for (int key = 0; key < 14; ++key) {
            const double x = -0.21 + 0.03 * key + 0.004 * row, y = -0.062 + 0.025 * row;
            kit.box(at, {x, y, 0.012}, {std::min(x + 0.026, 0.216), y + 0.021, 0.021}, kNoBottom);
        }
    }
}

void Furnisher::desk(const Frame& at) {
    begin("Desk");
    const double w = random.range(1.5, 1.9), d = random.range(0.75, 0.85), h = 0.74;
    const uint32_t wood = random.chance(0.5)   ? colours.oak
                          : random.chance(0.5) ? colours.birch
                                               : colours.white;
    kit.paint(wood);
    kit.prism(at, roundedOutline(w, d, 0.03, kit.detail()), h - 0.028, h);
    kit.paint(colours.steel);
    for (const double x : {-w / 2 + 0.08, w / 2 - 0.08}) {
        for (const double y : {-d / 2 + 0.09, d / 2 - 0.09}) {
            kit.box(at, {x - 0.022, y - 0.022, kFoot}, {x + 0.022, y + 0.022, h - 0.02});
        }
        kit.box(at, {x - 0.016, -d / 2 + 0.1, h - 0.09}, {x + 0.016, d / 2 - 0.1, h - 0.034});
    }
    kit.paint(wood);
    const double side = random.chance(0.5) ? w / 2 - 0.36 : -w / 2 + 0.36;
    kit.box(at, {side - 0.2, -d / 2 + 0.12, 0.06}, {side + 0.2, d / 2 - 0.13, 0.66});
    for (int drawer = 0; drawer < 3; ++drawer) {
        const double z = 0.08 + 0.19 * drawer;
        kit.box(at, {side - 0.19, d / 2 - 0.14, z}, {side + 0.19, d / 2 - 0.112, z + 0.178});
        kit.rod(at, {side - 0.06, d / 2 - 0.095, z + 0.1}, {side + 0.06, d / 2 - 0.095, z + 0.1},
                0.006);
    }
    begin("Screen");
    const int screens = random.integer(1, 2);
    for (int i = 0; i < screens; ++i) {
        const Frame foot =
            at.moved({(i - 0.5 * (screens - 1)) * 0.64, -0.16, h}).turned(random.range(-0.2, 0.2));
        kit.paint(colours.black);
        kit.prism(foot, roundedOutline(0.24, 0.18, 0.04, kit.detail()), -0.004, 0.012);
        kit.rod(foot, {0, -0.04, 0.01}, {0, -0.04, 0.36}, 0.017);
        kit.box(foot, {-0.31, -0.03, 0.14}, {0.31, 0.012, 0.51});
        kit.paint(colours.screen);
        kit.box(foot, {-0.298, 0.004, 0.155}, {0.298, 0.0145, 0.498});
    }
    begin("Desk things");
    keyboard(at.moved({0.02, 0.14, h}));
    kit.paint(colours.black);
    kit.blob(at.moved({0.34, 0.15, h + 0.008}), {0.03, 0.05, 0.017}, 0.0, 1);
    cup(at.moved({-w / 2 + 0.27, random.range(-0.1, 0.15), h}).turned(random.range(0, 6)));
    if (random.chance(0.7))
        deskLamp(at.moved({w / 2 - 0.2, -0.2, h}).turned(random.range(0.2, 0.9)));
    kit.paint(colours.paper);
    const int sheets = random.integer(3, 9);
    for (int i = 0; i < sheets; ++i) {
        const Frame sheet =
            at.moved({-0.5, 0.08, h + 0.0025 + 0.004 * i}).turned(random.range(-0.25, 0.25));
        kit.box(sheet, {-0.105, -0.148, -0.0013}, {0.105, 0.148, 0.0013});
    }
}

void Furnisher::table(const Frame& at, double length, double width) {
    begin("Table");
    kit.paint(colours.walnut);
    kit.prism(at, roundedOutline(length, width, 0.12, kit.detail()), 0.715, 0.75);
    kit.paint(colours.black);
    const int legs = std::max(2, static_cast<int>(length / 1.6) + 1);
    for (int i = 0; i < legs; ++i) {
        const double x = (length - 0.9) * (static_cast<double>(i) / (legs - 1) - 0.5);
        kit.box(at, {x - 0.04, -width / 2 + 0.25, 0.01}, {x + 0.04, width / 2 - 0.25, 0.06});
        kit.box(at, {x - 0.03, -0.05, 0.05}, {x + 0.03, 0.05, 0.725});
    }
    begin("Cups");
    const int cups = static_cast<int>(length * 1.5);
    for (int i = 0; i < cups; ++i) {
        const double x = length * ((i + 0.5 + random.range(-0.2, 0.2)) / cups - 0.5) * 0.85;
        const double y = (i % 2 == 0 ? 1 : -1) * width * random.range(0.2, 0.38);
        cup(at.moved({x, y, 0.75}).turned(random.range(0, 6)));
    }
}

void Furnisher::roundTable(const Frame& at, double radius) {
    begin("Round table");
    kit.paint(colours.oak);
    const std::array<ProfilePoint, 6> top{{{0, 0.715},
                                           {radius - 0.02, 0.715},
                                           {radius, 0.727},
                                           {radius, 0.74},
                                           {radius - 0.012, 0.75},
                                           {0, 0.75}}};
    kit.lathe(at, top);
    kit.paint(colours.black);
    const std::array<ProfilePoint, 8> foot{{{0, kFoot},
                                            {radius * 0.5, kFoot},
                                            {radius * 0.5, 0.02},
                                            {0.06, 0.07},
                                            {0.04, 0.16},
                                            {0.04, 0.6},
                                            {0.1, 0.72},
                                            {0, 0.72}}};
    kit.lathe(at, foot);
    begin("Vase");
    kit.paint(colours.clay);
    std::vector<ProfilePoint> vase{{0, 0.746}};
    const double belly = random.range(0.05, 0.09), height = random.range(0.2, 0.34);
    for (int i = 0; i <= 10; ++i) {
        const double t = i / 10.0;
        vase.push_back(
            {belly * (0.55 + 0.45 * std::sin(kPi * (0.15 + t * 0.95))), 0.746 + height * t});
    }
    kit.lathe(at.moved({0.05, 0.02, 0}), vase);
    kit.paint(colours.leaf);
    for (int i = 0; i < 7; ++i) {
        const double a = i * 2.4, lean = random.range(0.05, 0.16);
        const Vec3d way(std::cos(a), std::sin(a), 0);
        const Vec3d base = Vec3d(0.05, 0.02, 0.76 + 0.001 * i) + 0.016 * way;
        const std::array<Vec3d, 3> stem{base, base + 0.3 * lean * way + Vec3d(0, 0, height * 1.1),
                                        base + lean * way + Vec3d(0, 0, height * 1.7)};
        kit.tube(at, stem, 0.004, 0.1);
        kit.blob(at.moved(stem[2]), {0.028, 0.028, 0.045}, 0.25, random.next());
    }
}

void Furnisher::book(const Frame& at, double thickness, double height, double depth) {
    kit.paint(colours.books[random.integer(0, 7)]);
    const double board = std::min(0.003, thickness * 0.2);
    if (!kit.keeps(random)) {
        kit.box(at, {0, 0, 0}, {thickness, depth, height});
        return;
    }
    // The cover as a U seen from above, its spine towards the room, and the pages within.
    const std::array<glm::dvec2, 8> cover{
        glm::dvec2(0, 0),       {board, 0},
        {board, depth - board}, {thickness - board, depth - board},
        {thickness - board, 0}, {thickness, 0},
        {thickness, depth},     {0, depth}};
    kit.prism(at, cover, 0, height);
    kit.paint(colours.paper);
    kit.box(at, {board * 0.5, 0.006, 0.004},
            {thickness - board * 0.5, depth - board * 0.5, height - 0.004});
}

void Furnisher::shelf(const Frame& at, double width, double height) {
    begin("Shelf");
    const double depth = random.range(0.28, 0.34), board = 0.022;
    kit.paint(random.chance(0.4)   ? colours.walnut
              : random.chance(0.5) ? colours.oak
                                   : colours.white);
    kit.box(at, {-width / 2, 0.006, kFoot}, {-width / 2 + board, depth, height});
    kit.box(at, {width / 2 - board, 0.006, kFoot}, {width / 2, depth, height});
    kit.box(at, {-width / 2 + 0.004, 0.008, 0.03}, {width / 2 - 0.004, 0.016, height - 0.004});
    const int boards = std::max(2, static_cast<int>(std::lround(height / 0.36)));
    const double pitch = (height - 0.1) / boards;
    for (int i = 0; i <= boards; ++i) {
        const double z = 0.06 + i * pitch;
        kit.box(at, {-width / 2 + 0.007, 0.012, z}, {width / 2 - 0.007, depth - 0.004, z + board});
    }
    begin("Books");
    for (int i = 0; i < boards; ++i) {
        const double z = 0.06 + i * pitch + board - 0.002;
        double x = -width / 2 + board + 0.006;
        while (true) {
            const double thickness = random.range(0.014, 0.05),
                         tall = random.range(0.17, pitch - 0.05);
            const double deep = random.range(0.13, 0.22), gap = random.chance(0.05) ? 0.1 : 0.0015;
            if (x + thickness > width / 2 - board - 0.006) break;
            const Frame foot = at.moved(
                {x, depth - 0.02 - deep - random.range(0, 0.02), z + 0.0004 * random.unit()});
            book(foot, thickness, tall, deep);
            x += thickness + gap;
        }
    }
}

}  // namespace pagoda::tools
