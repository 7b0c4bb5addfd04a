#include "tools/generate/plant_equipment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;

// Upright vessel with dished ends on a skirt, nozzles, manhole and ladder.
void addVessel(Zone& zone, const std::string& tag) {
    SceneKit& kit = zone.kit;
    Random& random = zone.random;
    kit.beginObject("Vessel " + tag);
    const double r = random.range(0.9, zone.size * 0.36);
    const double top = random.range(0.72, 0.93) * kPlantClear, skirt = random.range(0.5, 0.8);
    const Frame at = zone.at.moved({zone.size * 0.52, zone.size * 0.52, 0});
    kit.paint(random.chance(0.5) ? zone.colours.insulation : zone.colours.white);
    std::vector<ProfilePoint> profile;
    constexpr int kDish = 7;
    for (int i = 0; i <= kDish; ++i) {
        const double a = kPi / 2 * i / kDish;
        profile.push_back({i == 0 ? 0 : r * std::sin(a), skirt + 0.45 * r * (1 - std::cos(a))});
    }
    const double shoulder = top - 0.45 * r;
    const int bands = random.integer(2, 4);
    for (int i = 1; i <= bands; ++i) {  // insulation bands
        const double z =
            std::lerp(skirt + 0.45 * r, shoulder, static_cast<double>(i) / (bands + 1));
        profile.insert(profile.end(),
                       {{r, z - 0.04}, {r + 0.02, z - 0.04}, {r + 0.02, z + 0.04}, {r, z + 0.04}});
    }
    for (int i = kDish; i >= 0; --i) {
        const double a = kPi / 2 * i / kDish;
        profile.push_back({i == 0 ? 0 : r * std::sin(a), shoulder + 0.45 * r * std::cos(a)});
    }
    kit.lathe(at, profile);
    kit.paint(zone.colours.structure);
    const std::array<ProfilePoint, 4> ringFoot{{{r * 0.84, -0.012},
                                                {r * 0.9, -0.012},
                                                {r * 0.9, skirt + 0.2 * r},
                                                {r * 0.84, skirt + 0.2 * r}}};
    kit.lathe(at, ringFoot);
    kit.paint(zone.colours.steel);
    const int nozzles = random.integer(3, 6);
    for (int i = 0; i < nozzles; ++i) {
        const double angle = random.range(0.1, 6.2), z = random.range(skirt + 0.5 * r, shoulder);
        const double radius = random.range(0.05, 0.14);
        const Frame out = at.turned(angle).moved({0, 0, z});
        kit.rod(out, {r - 0.05, 0, 0}, {r + 0.22, 0, 0}, radius);
        addFlange(kit, out.aligned({r + 0.2, 0, 0}, {1, 0, 0}), radius, random);
    }
    const Frame manhole = at.turned(random.range(0, 6.2)).moved({0, 0, skirt + 0.62 * r + 0.3});
    kit.rod(manhole, {r - 0.04, 0, 0}, {r + 0.12, 0, 0}, 0.28);
    kit.rod(manhole, {r + 0.125, 0, 0}, {r + 0.16, 0, 0}, 0.35);
    kit.beginObject("Ladder " + tag);
    kit.paint(zone.colours.yellow);
    const Frame rungs = at.turned(kPi / 4 + 0.3).moved({0, -0.05, 0});
    addLadder(kit, {rungs.point({r + 0.02, 0, 0.01}), -rungs.y, rungs.x, rungs.z}, top - 0.4, true);
}

// Lying vessel on two saddles, with a level gauge and piping.
void addDrum(Zone& zone, const std::string& tag) {
    SceneKit& kit = zone.kit;
    Random& random = zone.random;
    kit.beginObject("Drum " + tag);
    const double r = random.range(0.55, 1.0), length = zone.size * random.range(0.72, 0.86);
    const double z = r + random.range(0.5, 1.1);
    const Frame along = zone.at.aligned({zone.size * 0.07 + 0.1, zone.size * 0.5, z}, {1, 0, 0});
    kit.paint(random.chance(0.4) ? zone.colours.insulation
                                 : zone.colours.media[random.integer(0, 5)]);
    std::vector<ProfilePoint> profile;
    constexpr int kDish = 6;
    for (int i = 0; i <= kDish; ++i) {
        const double a = kPi / 2 * i / kDish;
        profile.push_back({i == 0 ? 0 : r * std::sin(a), 0.4 * r * (1 - std::cos(a))});
    }
    for (int i = kDish; i >= 0; --i) {
        const double a = kPi / 2 * i / kDish;
        profile.push_back({i == 0 ? 0 : r * std::sin(a), length - 0.4 * r * (1 - std::cos(a))});
    }
    kit.lathe(along, profile);
    kit.paint(zone.colours.structure);
    for (const double x : {0.24, 0.76}) {
        const double cx = zone.size * 0.07 + 0.1 + length * x, cy = zone.size * 0.5;
        kit.box(zone.at, {cx - 0.11, cy - r * 0.8, 0.055}, {cx + 0.11, cy + r * 0.8, z - 0.45 * r});
        kit.box(zone.at, {cx - 0.2, cy - r * 0.9, -0.012}, {cx + 0.2, cy + r * 0.9, 0.06});
    }
    kit.beginObject("Gauges " + tag);
    const int count = random.integer(2, 4);
    for (int i = 0; i < count; ++i) {
        const double x = zone.size * 0.1 + length * (i + 0.6) / (count + 0.4);
        const double y = zone.size * 0.5, up = random.range(0.3, 0.7);
        kit.paint(zone.colours.steel);
        kit.rod(zone.at, {x, y, z + r - 0.06}, {x, y, z + r + up}, 0.045);
        addFlange(kit, zone.at.moved({x, y, z + r + 0.5 * up}), 0.045, random);
        kit.paint(zone.colours.white);
        kit.rod(zone.at, {x, y + 0.04, z + r + up + 0.09}, {x, y - 0.03, z + r + up + 0.09}, 0.11);
    }
}

void addPumpSet(SceneKit& kit, const PlantPalette& colours, const Frame& at, double scale,
                Random& random) {
    const double s = scale;
    kit.paint(colours.concrete);
    kit.box(at, {0, 0, -0.015}, {2.3 * s, 0.9 * s, 0.16});
    kit.paint(colours.structure);
    kit.box(at, {0.07 * s, 0.1 * s, 0.15}, {2.2 * s, 0.8 * s, 0.26});
    const double z = 0.26 + 0.42 * s;
    // Motor: finned barrel, feet, terminal box, fan cover.
    kit.paint(colours.motor);
    const Frame motor = at.aligned({1.12 * s, 0.45 * s, z}, {1, 0, 0});
    std::vector<ProfilePoint> barrel{{0, 0}, {0.2 * s, 0}, {0.24 * s, 0.05 * s}};
    const int fins = 7;
    for (int i = 0; i < fins; ++i) {
        const double a = (0.09 + 0.1 * i) * s;
        barrel.insert(
            barrel.end(),
            {{0.24 * s, a}, {0.275 * s, a}, {0.275 * s, a + 0.05 * s}, {0.24 * s, a + 0.05 * s}});
    }
    barrel.insert(barrel.end(),
                  {{0.26 * s, 0.8 * s}, {0.26 * s, 0.95 * s}, {0.12 * s, 0.99 * s}, {0, 0.99 * s}});
    kit.lathe(motor, barrel);
    kit.box(at, {1.3 * s, 0.22 * s, 0.25}, {1.38 * s, 0.68 * s, z - 0.1 * s});
    kit.box(at, {1.75 * s, 0.22 * s, 0.25}, {1.83 * s, 0.68 * s, z - 0.1 * s});
    kit.box(at, {1.45 * s, 0.33 * s, z + 0.2 * s}, {1.72 * s, 0.57 * s, z + 0.4 * s});
    kit.paint(colours.yellow);  // coupling guard
    kit.rod(at, {0.85 * s, 0.45 * s, z}, {1.116 * s, 0.45 * s, z}, 0.15 * s);
    // Pump: volute, bearing bracket, suction and discharge.
    kit.paint(colours.pump);
    const Frame pump = at.aligned({0.3 * s, 0.45 * s, z}, {1, 0, 0});
    const std::array<ProfilePoint, 9> volute{{{0, 0},
                                              {0.22 * s, 0},
                                              {0.36 * s, 0.06 * s},
                                              {0.4 * s, 0.15 * s},
                                              {0.36 * s, 0.25 * s},
                                              {0.2 * s, 0.31 * s},
                                              {0.13 * s, 0.36 * s},
                                              {0.13 * s, 0.57 * s},
                                              {0, 0.57 * s}}};
    kit.lathe(pump, volute);
    kit.box(at, {0.34 * s, 0.2 * s, 0.25}, {0.5 * s, 0.7 * s, z - 0.2 * s});
    kit.paint(colours.media[1]);
    const double d = 0.11 * s, up = 1.15 * s + random.range(0.0, 0.5);
    const std::array<Vec3d, 3> suction{Vec3d(0.31 * s, 0.45 * s, z), Vec3d(-0.12 * s, 0.45 * s, z),
                                       Vec3d(-0.12 * s, 0.45 * s, -0.013)};
    kit.tube(at, suction, d, 0.2 * s);
    addFlange(kit, at.aligned({0.24 * s, 0.45 * s, z}, {1, 0, 0}), d, random);
    kit.rod(at, {0.45 * s, 0.45 * s, z + 0.3 * s}, {0.45 * s, 0.45 * s, z + up}, d * 0.9);
    addFlange(kit, at.moved({0.45 * s, 0.45 * s, z + 0.5 * s}), d * 0.9, random);
    addValve(kit, colours, at.moved({0.45 * s, 0.45 * s, z + 0.95 * s}), d * 0.9);
}

void addPumps(Zone& zone, const std::string& tag) {
    const int count = zone.random.integer(2, 3);
    const double pitch = zone.size / count;
    for (int i = 0; i < count; ++i) {
        zone.kit.beginObject("Pump " + tag + static_cast<char>('A' + i));
        const double scale = std::min(zone.random.range(1.0, 1.45), pitch * 0.95);
        addPumpSet(zone.kit, zone.colours,
                   zone.at.moved({0.9 + zone.random.range(0, 0.5), pitch * (i + 0.1), 0}), scale,
                   zone.random);
    }
}

// A header with a row of valves and branches.
void addValveStation(Zone& zone, const std::string& tag) {
    SceneKit& kit = zone.kit;
    Random& random = zone.random;
    const int medium = random.integer(0, 5), rows = random.integer(2, 3);
    for (int row = 0; row < rows; ++row) {
        kit.beginObject("Valves " + tag + static_cast<char>('A' + row));
        const double y = 0.7 + row * zone.size / (rows + 0.4), r = random.range(0.08, 0.15);
        const double z = random.range(0.45, 0.7), top = random.range(2.2, 2.9);
        const int count = random.integer(4, 7);
        kit.paint(zone.colours.media[medium]);
        kit.rod(zone.at, {0.15, y, z}, {zone.size * 0.95, y, z}, r);
        kit.rod(zone.at, {0.25, y + 0.01, top}, {zone.size * 0.93, y + 0.01, top}, r * 0.93);
        for (int i = 0; i < count; ++i) {
            const double x = 0.5 + (zone.size * 0.92 - 0.5) * i / count,
                         d = r * random.range(0.5, 0.8);
            kit.paint(zone.colours.media[medium]);
            kit.rod(zone.at, {x, y + 0.004, z + r * 0.5}, {x, y + 0.004, top - r * 0.4}, d);
            addFlange(kit, zone.at.moved({x, y + 0.004, z + r + 0.16}), d, random);
            addValve(kit, zone.colours, zone.at.moved({x, y + 0.004, 1.35}), d);
            kit.paint(zone.colours.steel);
            addFlange(kit, zone.at.moved({x, y + 0.004, 1.85}), d, random);
        }
        kit.paint(zone.colours.structure);
        for (const double x : {0.3, zone.size * 0.5, zone.size * 0.9}) {
            kit.box(zone.at, {x - 0.04, y - 0.045, -0.012}, {x + 0.04, y + 0.045, z - 0.8 * r});
        }
    }
}

void addCabinets(Zone& zone, const std::string& tag) {
    SceneKit& kit = zone.kit;
    Random& random = zone.random;
    kit.beginObject("Switchgear " + tag);
    const double h = random.range(2.0, 2.3), depth = 0.6;
    const int count = static_cast<int>((zone.size - 0.3) / 0.82);
    for (int row = 0; row < 2; ++row) {
        const Frame at = zone.at.moved({0.2, row == 0 ? 0.06 : zone.size * 0.55, 0});
        kit.paint(zone.colours.dark);
        kit.box(at, {0.03, 0.03, -0.012}, {count * 0.82 - 0.03, depth - 0.04, 0.11});
        for (int i = 0; i < count; ++i) {
            const double x = i * 0.82, tall = h - 0.013 * i;
            kit.paint(zone.colours.cabinet);
            kit.box(at, {x + 0.004, 0, 0.1}, {x + 0.812, depth, tall});
            kit.box(at, {x + 0.03, depth - 0.01, 0.15}, {x + 0.785, depth + 0.025, tall - 0.06});
            kit.paint(zone.colours.dark);
            kit.box(at, {x + 0.69, depth + 0.015, 1.0}, {x + 0.72, depth + 0.055, 1.2});
            if (!kit.keeps(random)) continue;
            for (int slot = 0; slot < 8; ++slot) {  // louvres
                const double z = 0.3 + slot * 0.05;
                kit.box(at, {x + 0.15, depth + 0.015, z}, {x + 0.55, depth + 0.037, z + 0.022});
            }
            kit.paint(random.chance(0.5) ? zone.colours.media[1] : zone.colours.red);
            for (int k = 0; k < 3; ++k) {
                const double lx = x + 0.2 + 0.14 * k;
                kit.rod(at, {lx, depth + 0.015, tall - 0.3}, {lx, depth + 0.05, tall - 0.3}, 0.024);
            }
        }
    }
}

// Two shells on top of each other, channel heads, tie pipes.
void addExchanger(Zone& zone, const std::string& tag) {
    SceneKit& kit = zone.kit;
    Random& random = zone.random;
    const double r = random.range(0.42, 0.6), length = zone.size * 0.84;
    for (int k = 0; k < 2; ++k) {
        kit.beginObject("Exchanger " + tag + (k == 0 ? "A" : "B"));
        const double y = zone.size * (k == 0 ? 0.28 : 0.72) + random.range(-0.1, 0.1);
        for (int level = 0; level < 2; ++level) {
            const double z = 0.5 + r + level * (2 * r + 0.5), rl = r * (level == 0 ? 1.0 : 0.94);
            const Frame along = zone.at.aligned({0.25 + 0.03 * level, y, z}, {1, 0, 0});
            kit.paint(level == 0 ? zone.colours.insulation : zone.colours.media[2]);
            const double l = length - 0.07 * level;
            const std::array<ProfilePoint, 14> shell{{{0, 0},
                                                      {rl * 0.7, 0.02},
                                                      {rl, 0.18},
                                                      {rl, 0.5},
                                                      {rl + 0.1, 0.5},
                                                      {rl + 0.1, 0.62},
                                                      {rl, 0.62},
                                                      {rl, l - 0.6},
                                                      {rl + 0.1, l - 0.6},
                                                      {rl + 0.1, l - 0.49},
                                                      {rl, l - 0.49},
                                                      {rl, l - 0.18},
                                                      {rl * 0.7, l - 0.02},
                                                      {0, l}}};
            kit.lathe(along, shell);
            kit.paint(zone.colours.steel);
            for (int bolt = 0; bolt < 16; ++bolt) {
                if (!kit.keeps(random)) continue;
                const double a = 2 * kPi * bolt / 16, br = rl + 0.055;
                kit.rod(along, {br * std::cos(a), br * std::sin(a), 0.47},
                        {br * std::cos(a), br * std::sin(a), 0.65}, 0.018);
            }
        }
        kit.paint(zone.colours.media[k == 0 ? 1 : 0]);
        for (const double x : {0.5, length - 0.25}) {
            kit.rod(zone.at, {x, y, 0.5 + r * 1.9}, {x, y, 1.0 + 2.2 * r}, 0.09);
            addFlange(kit, zone.at.moved({x, y, 0.75 + 2 * r}), 0.09, random);
        }
        kit.paint(zone.colours.structure);
        for (const double x : {1.1, length - 0.8}) {
            kit.box(zone.at, {x - 0.08, y - r * 0.7, -0.012},
                    {x + 0.08, y + r * 0.7, 0.5 + 0.3 * r});
        }
    }
}

// A platform at half height with stairs, grating bars and railings, and tanks below.
void addPlatform(Zone& zone, const std::string& tag) {
    SceneKit& kit = zone.kit;
    Random& random = zone.random;
    const double s = zone.size, z = std::min(2.6, zone.height * 0.45);
    kit.beginObject("Platform " + tag);
    kit.paint(zone.colours.galvanised);
    const int bars = 2 * static_cast<int>((s - 1.6) / 0.12);
    for (int i = 0; i < bars; ++i) {
        const double y = 0.15 + (s - 1.9) * i / bars;
        kit.box(zone.at, {0.14, y, z - 0.03}, {s - 0.25, y + 0.012, z});
    }
    kit.paint(zone.colours.structure);
    for (const double x : {0.22, s * 0.5, s - 0.35}) {
        addBeam(kit, zone.at, {x, 0.1, z - 0.14}, {x, s - 1.68, z - 0.14}, 0.2);
        for (const double y : {0.3, s - 1.8}) {
            addBeam(kit, zone.at, {x + 0.003, y, -0.013}, {x + 0.003, y, z - 0.2}, 0.16);
        }
    }
    kit.beginObject("Stairs " + tag);
    kit.paint(zone.colours.steel);
    addStairs(kit, zone.at.moved({s - 0.3 - z * 1.1, s - 1.45, 0}), 0.9, z * 1.1, z);
    kit.beginObject("Railing " + tag);
    kit.paint(zone.colours.yellow);
    const std::array<Vec3d, 4> rail{
        Vec3d(0.2, s - 1.74, z - 0.04), Vec3d(s - 1.2, s - 1.74, z - 0.04),
        Vec3d(s - 1.19, s - 1.78, z - 0.04), Vec3d(0.2, s - 1.82, z - 0.04)};
    addRailing(kit, zone.at, std::span(rail).first(2));
    const std::array<Vec3d, 2> side{Vec3d(s - 0.33, 0.2, z - 0.04),
                                    Vec3d(s - 0.33, s - 1.76, z - 0.04)};
    addRailing(kit, zone.at, side);
    kit.beginObject("Day tank " + tag);
    kit.paint(zone.colours.media[random.integer(1, 5)]);
    const double r = std::min(0.75, s * 0.17);
    for (int i = 0; i < 2; ++i) {
        const Frame at = zone.at.moved({s * (0.27 + 0.4 * i), s * 0.36, 0});
        const std::array<ProfilePoint, 6> tank{{{0, 0.16},
                                                {r, 0.16},
                                                {r, z - 0.75},
                                                {r * 0.8, z - 0.55},
                                                {0.2, z - 0.45},
                                                {0, z - 0.45}}};
        kit.lathe(at, tank);
        for (int leg = 0; leg < 4; ++leg) {
            const double a = kPi / 4 + leg * kPi / 2;
            kit.rod(at, {0.8 * r * std::cos(a), 0.8 * r * std::sin(a), -0.012},
                    {0.8 * r * std::cos(a), 0.8 * r * std::sin(a), 0.2}, 0.05);
        }
    }
}

}  // namespace

void addEquipment(Zone& zone, const std::string& tag) {
    constexpr std::array<Equipment, 7> kAll{addVessel,   addDrum,      addPumps,   addValveStation,
                                            addCabinets, addExchanger, addPlatform};
    kAll[static_cast<size_t>(zone.random.integer(0, 6))](zone, tag);
}

PlantPalette::PlantPalette(SceneKit& kit)
    : concrete(kit.addMaterial("concrete", 0xA3A19B)),
      paintedFloor(kit.addMaterial("painted floor", 0x8A938C)),
      wall(kit.addMaterial("wall", 0xCFCBBF)),
      structure(kit.addMaterial("structural steel", 0x4F6475)),
      steel(kit.addMaterial("steel", 0x828A90)),
      yellow(kit.addMaterial("safety yellow", 0xE2B423)),
      insulation(kit.addMaterial("insulation cladding", 0xC6CACB)),
      galvanised(kit.addMaterial("galvanised", 0xA5ABAE)),
      duct(kit.addMaterial("duct", 0xB3B9BA)),
      pump(kit.addMaterial("pump blue", 0x2F6296)),
      motor(kit.addMaterial("motor green", 0x45735A)),
      cabinet(kit.addMaterial("cabinet", 0xC8CCC4)),
      cable(kit.addMaterial("cable", 0x33363A)),
      dark(kit.addMaterial("dark grey", 0x4A4D50)),
      red(kit.addMaterial("signal red", 0xB23A2E)),
      white(kit.addMaterial("white", 0xE6E4DC)),
      brick(kit.addMaterial("brick", 0x9A5F4B)),
      cladding(kit.addMaterial("wall cladding", 0x9FB2BD)),
      asphalt(kit.addMaterial("asphalt", 0x5C5E60)),
      ground(kit.addMaterial("ground", 0x8B8A6E)),
      door(kit.addMaterial("door", 0x5D7F8C)),
      glass(kit.addMaterial("glass", 0xA9CBD6, 0.35)),
      lamp(kit.addMaterial("lamp", 0xFFF6DC)),
      screen(kit.addMaterial("screen", 0x2B4A5E)),
      boiler(kit.addMaterial("boiler steel", 0x8C7D6B)),
      orange(kit.addMaterial("cable orange", 0xC8692B)),
      media{kit.addMaterial("steam pipe", 0xA84B3C), kit.addMaterial("water pipe", 0x468A62),
            kit.addMaterial("air pipe", 0x82AAC6),   kit.addMaterial("gas pipe", 0xC9A544),
            kit.addMaterial("oil pipe", 0x80603F),   kit.addMaterial("acid pipe", 0x8E6A9E)} {
}

}  // namespace pagoda::tools
