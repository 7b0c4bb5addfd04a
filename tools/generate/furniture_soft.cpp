// furniture_soft.cpp: seats, lamps, plants and what hangs on walls.
#include "tools/generate/furniture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;

}  // namespace

void Furnisher::sofa(const Frame& at, double width) {
    begin("Sofa");
    const uint32_t fabric = colours.fabrics[random.integer(0, 4)];
    kit.paint(fabric);
    const double depth = 0.88;
    kit.box(at, {-width / 2 + 0.02, -depth / 2 + 0.02, 0.117},
            {width / 2 - 0.02, depth / 2 - 0.03, 0.3});
    const int seats = std::max(1, static_cast<int>(width / 0.75));
    const double each = (width - 0.36) / seats;
    for (int i = 0; i < seats; ++i) {
        const double x = -width / 2 + 0.18 + each * (i + 0.5);
        cushion(at.moved({x, 0.08, 0.29}), each - 0.012, depth - 0.24, 0.17);
        const Frame back{at.point({x, -depth / 2 + 0.07, 0.62}), at.x, at.z, -at.y};
        cushion(back.moved({0, 0, -0.18}), each - 0.02, 0.42, 0.17);
    }
    for (const double x : {-width / 2 + 0.09, width / 2 - 0.09}) {
        cushion(at.moved({x, 0.01, 0.1 + 0.002 * (x > 0 ? 1 : 0)}), 0.18, depth - 0.03, 0.49);
    }
    cushion(at.moved({0, -depth / 2 + 0.06, 0.104}), width - 0.02, 0.16, 0.72);
    kit.paint(colours.walnut);
    for (const double x : {-width / 2 + 0.12, width / 2 - 0.12}) {
        for (const double y : {-depth / 2 + 0.12, depth / 2 - 0.12}) {
            kit.rod(at, {x, y, -0.012}, {x, y, 0.12}, 0.025);
        }
    }
}

void Furnisher::floorLamp(const Frame& at) {
    begin("Floor lamp");
    kit.paint(colours.brass);
    const double h = random.range(1.45, 1.7);
    const std::array<ProfilePoint, 7> stand{{{0, -0.012},
                                             {0.15, -0.012},
                                             {0.145, 0.02},
                                             {0.02, 0.04},
                                             {0.012, 0.1},
                                             {0.012, h - 0.1},
                                             {0, h - 0.1}}};
    kit.lathe(at, stand);
    kit.paint(colours.lamp);
    const double r = random.range(0.18, 0.26);
    const std::array<ProfilePoint, 5> shade{
        {{r, h - 0.3}, {r * 0.65, h}, {r * 0.65 - 0.004, h}, {r - 0.004, h - 0.3}, {r, h - 0.3}}};
    kit.lathe(at, shade);
    kit.ball(at.moved({0, 0, h - 0.14}), 0.05);
}

void Furnisher::plant(const Frame& at) {
    begin("Plant");
    kit.paint(random.chance(0.5) ? colours.clay : colours.white);
    const double r = random.range(0.16, 0.24), h = random.range(0.28, 0.42);
    const std::array<ProfilePoint, 6> pot{{{0, -0.012},
                                           {r * 0.75, -0.012},
                                           {r, h},
                                           {r * 0.92, h},
                                           {r * 0.88, h - 0.05},
                                           {0, h - 0.05}}};
    kit.lathe(at, pot);
    kit.paint(colours.leaf);
    const int leaves = random.integer(14, 26);
    for (int i = 0; i < leaves; ++i) {
        if (!kit.keeps(random)) continue;
        const double a = i * 2.399963, lean = random.range(0.15, 0.75),
                     reach = random.range(0.35, 0.8);
        const Vec3d way = glm::normalize(Vec3d(std::cos(a) * lean, std::sin(a) * lean, 1));
        const Vec3d foot(0.03 * std::cos(a), 0.03 * std::sin(a), h - 0.07);
        const Vec3d tip = foot + way * reach;
        const std::array<Vec3d, 2> stem{foot, tip};
        kit.tube(at, stem, 0.005, 0.1);
        const Frame blade = at.aligned(tip, way + Vec3d(std::cos(a), std::sin(a), -0.2) * 0.6);
        kit.blob(blade, {0.012, random.range(0.05, 0.09), random.range(0.14, 0.24)}, 0.15,
                 random.next());
    }
}

void Furnisher::radiator(const Frame& at, double width) {
    begin("Radiator");
    kit.paint(colours.white);
    const int columns = static_cast<int>(width / 0.065);
    for (int i = 0; i < columns; ++i) {
        const double x = width * ((i + 0.5) / columns - 0.5);
        for (const double y : {0.06, 0.11}) kit.rod(at, {x, y, 0.13}, {x, y, 0.72}, 0.021);
    }
    for (const double z : {0.15, 0.7}) {
        kit.rod(at, {-width / 2, 0.085, z}, {width / 2, 0.085, z}, 0.026);
    }
    const std::array<Vec3d, 3> pipe{Vec3d(width / 2 - 0.01, 0.085, 0.152),
                                    Vec3d(width / 2 + 0.09, 0.085, 0.152),
                                    Vec3d(width / 2 + 0.09, 0.085, -0.013)};
    kit.tube(at, pipe, 0.011, 0.03);
    kit.rod(at, {width / 2 + 0.09, 0.07, 0.15}, {width / 2 + 0.09, 0.18, 0.15}, 0.022);
}

void Furnisher::picture(const Frame& at, double width, double height) {
    begin("Picture");
    kit.paint(random.chance(0.5) ? colours.black : colours.oak);
    for (const double x : {-width / 2, width / 2}) {
        kit.box(at, {x - 0.015, -0.02, -0.02}, {x + 0.015, 0.03, height + 0.02});
    }
    for (const double z : {0.0, height}) {
        kit.box(at, {-width / 2 - 0.01, -0.021, z - 0.015}, {width / 2 + 0.01, 0.028, z + 0.015});
    }
    kit.paint(colours.paper);
    kit.box(at, {-width / 2 + 0.005, -0.022, 0.005}, {width / 2 - 0.005, 0.01, height - 0.005});
    for (int i = 0; i < 4; ++i) {  // shapes on the canvas
        kit.paint(colours.paints[random.integer(0, 3)]);
        const double x = (-0.42 + 0.21 * i) * width, z = random.range(0.12, 0.5) * height;
        kit.box(at, {x, -0.011 - 0.0012 * i, z},
                {x + random.range(0.08, 0.19) * width, 0.0125 + 0.0018 * i,
                 z + random.range(0.1, 0.35) * height});
    }
}

void Furnisher::whiteboard(const Frame& at, double width) {
    begin("Whiteboard");
    kit.paint(colours.white);
    kit.box(at, {-width / 2, -0.02, 0.9}, {width / 2, 0.018, 2.1});
    kit.paint(colours.steel);
    for (const double z : {0.89, 2.11})
        kit.rod(at, {-width / 2 - 0.007, 0.01, z}, {width / 2 + 0.007, 0.01, z}, 0.018);
    kit.box(at, {-width * 0.3, 0.005, 0.86}, {width * 0.3, 0.09, 0.873});
    for (int i = 0; i < 4; ++i) {
        kit.paint(colours.paints[i]);
        kit.rod(at, {-0.3 + 0.16 * i, 0.05, 0.883}, {-0.17 + 0.16 * i, 0.055, 0.883}, 0.008);
    }
}

void Furnisher::kitchen(const Frame& at, double width) {
    begin("Kitchen");
    const int units = std::max(2, static_cast<int>(width / 0.6));
    const double w = width / units;
    kit.paint(colours.black);
    kit.box(at, {-width / 2 + 0.02, 0.02, -0.012}, {width / 2 - 0.02, 0.52, 0.1});
    for (int i = 0; i < units; ++i) {
        const double x = -width / 2 + i * w;
        kit.paint(colours.white);
        kit.box(at, {x + 0.003, 0.004, 0.09}, {x + w - 0.003, 0.56, 0.862});
        kit.box(at, {x + 0.006, 0.55, 0.105}, {x + w - 0.006, 0.58, 0.845});
        kit.box(at, {x + 0.003, -0.02, 1.45}, {x + w - 0.003, 0.33, 2.15 - 0.004 * i});
        kit.box(at, {x + 0.007, 0.32, 1.46}, {x + w - 0.007, 0.35, 2.13 - 0.004 * i});
        kit.paint(colours.steel);
        kit.rod(at, {x + 0.1, 0.6, 0.78}, {x + w - 0.1, 0.6, 0.78}, 0.008);
        kit.rod(at, {x + 0.1, 0.37, 1.52}, {x + w - 0.1, 0.37, 1.52}, 0.008);
    }
    kit.paint(colours.stone);
    kit.box(at, {-width / 2 - 0.01, -0.015, 0.855}, {width / 2 + 0.01, 0.61, 0.9});
    kit.paint(colours.chrome);
    const std::array<Vec3d, 4> tap{Vec3d(0, 0.12, 0.89), Vec3d(0, 0.12, 1.2), Vec3d(0, 0.32, 1.2),
                                   Vec3d(0, 0.32, 1.1)};
    kit.tube(at, tap, 0.014, 0.08);
    begin("Crockery");
    for (int i = 0; i < 8; ++i) {
        if (i >= 3 && i <= 4) continue;  // the sink
        cup(at.moved({-width / 2 + 0.2 + (width - 0.4) * i / 7.0, random.range(0.2, 0.4), 0.9})
                .turned(random.range(0, 6)));
    }
}

void Furnisher::pendantLamps(const Frame& at, int count, double pitch, double drop) {
    begin("Pendant lamps");
    for (int i = 0; i < count; ++i) {
        const Frame lamp = at.moved({(i - 0.5 * (count - 1)) * pitch, 0, -drop});
        kit.paint(colours.black);
        kit.rod(lamp, {0, 0, 0.2}, {0, 0, drop + 0.012}, 0.004);
        const std::array<ProfilePoint, 7> shade{
            {{0.2, 0}, {0.19, 0.05}, {0.12, 0.15}, {0.04, 0.2}, {0, 0.21}, {0, 0.205}, {0.19, 0}}};
        kit.lathe(lamp, std::span(shade).first(5));
        kit.paint(colours.lamp);
        kit.ball(lamp.moved({0, 0, 0.07}), 0.055);
    }
}

void Furnisher::ceilingPanel(const Frame& at) {
    begin("Ceiling lamp");
    kit.paint(colours.white);
    kit.box(at, {-0.62, -0.31, -0.05}, {0.62, 0.31, 0.012});
    kit.paint(colours.lamp);
    for (int i = 0; i < 4; ++i) {
        const double y = -0.225 + 0.15 * i;
        kit.rod(at, {-0.58, y, -0.062}, {0.58, y, -0.062}, 0.02);
    }
    if (!kit.keeps(random)) return;
    kit.paint(colours.steel);
    for (int i = 0; i < 16; ++i) {  // louvre
        const double x = -0.56 + 0.0745 * i;
        kit.box(at, {x, -0.3, -0.1}, {x + 0.004, 0.3, -0.045});
    }
}

void Furnisher::curtain(const Frame& at, double width, double height) {
    begin("Curtain");
    if (curtainFabric_ < 0) curtainFabric_ = random.integer(0, 4);
    kit.paint(colours.fabrics[curtainFabric_]);
    const int waves = static_cast<int>(std::lround(width / 0.1));
    const double phase = random.range(0, 6);
    const int across = waves * std::max(4, static_cast<int>(6 * std::sqrt(kit.detail())));
    const int up = std::max(3, static_cast<int>(6 * std::sqrt(kit.detail())));
    const auto corner = [&](int i, int j) {
        const double x = width * i / across, z = height * j / up;
        const double fold =
            std::sin(2 * kPi * waves * x / width + phase + 0.25 * std::sin(z * 2.3));
        return at.point({x, 0.03 * fold * (1.15 - 0.35 * z / height), z});
    };
    for (int j = 0; j < up; ++j) {
        for (int i = 0; i < across; ++i) {
            kit.quad(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
        }
    }
}

void Furnisher::crates(const Frame& at, double width) {
    begin("Rack");
    kit.paint(colours.steel);
    const double depth = 0.5, height = 2.1;
    for (const double x : {-width / 2, width / 2}) {
        for (const double y : {0.03, depth}) {
            kit.box(at, {x - 0.02, y - 0.018, -0.012}, {x + 0.02, y + 0.018, height});
        }
    }
    for (int level = 0; level < 4; ++level) {
        const double z = 0.12 + 0.55 * level;
        kit.box(at, {-width / 2 + 0.006, 0.016, z}, {width / 2 - 0.006, depth + 0.012, z + 0.025});
        begin("Crates");
        for (double x = -width / 2 + 0.05; x < width / 2 - 0.36;) {
            const double w = random.range(0.22, 0.36), h = random.range(0.15, 0.42),
                         d = random.range(0.3, 0.42);
            kit.paint(random.chance(0.6) ? colours.birch : colours.paints[random.integer(0, 3)]);
            const Frame box = at.moved({x, 0.05, z + 0.022 + 0.002 * random.unit()});
            kit.box(box, {0, 0, 0}, {w, d, h});
            kit.box(box, {-0.006, -0.006, h - 0.035}, {w + 0.006, d + 0.006, h + 0.005});
            kit.paint(colours.paper);
            kit.box(box, {w * 0.3, d - 0.01, h * 0.3}, {w * 0.7, d + 0.003, h * 0.62});
            x += w + random.range(0.02, 0.1);
        }
        kit.paint(colours.steel);
        if (level < 3) begin("Rack board");
    }
}

}  // namespace pagoda::tools
