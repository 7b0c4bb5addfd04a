#include "tools/generate/city_house.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace pagoda::tools {
namespace {

struct FacadeStyle {
    int storeys, bays;
    double ground, storey, bayWidth, windowWidth, windowHeight;
    uint32_t wall;
    bool hasSills, hasCornices;
};

// One facade of thickness 0.4 with its windows; `isStreet`: a shop front below.
void addFacade(House& house, const Frame& at, double length, const FacadeStyle& style,
               bool isStreet) {
    SceneKit& kit = house.kit;
    const int bays = std::max(1, static_cast<int>(length / style.bayWidth));
    const double pitch = length / bays, height = style.ground + style.storeys * style.storey;
    std::vector<Rectangle> windows, shops;
    for (int bay = 0; bay < bays; ++bay) {
        const double middle = pitch * (bay + 0.5), half = style.windowWidth / 2;
        for (int storey = 0; storey < style.storeys; ++storey) {
            const double z = style.ground + storey * style.storey + 0.85;
            windows.push_back({middle - half, z, middle + half, z + style.windowHeight});
        }
        const double wide = isStreet ? pitch * 0.38 : half;
        shops.push_back({middle - wide, isStreet ? 0.45 : 1.0, middle + wide, style.ground - 0.7});
    }
    if (!kit.keeps(house.random)) {  // a blind wall, for the sake of few triangles
        windows.clear();
        shops.clear();
    }
    std::vector<Rectangle> holes = windows;
    holes.insert(holes.end(), shops.begin(), shops.end());
    kit.paint(style.wall);
    addWall(kit, at, length, height, 0.4, holes);
    for (const Rectangle& hole : windows) {
        addWindow(kit, at.moved({hole.u0, 0, hole.v0}),
                  {.width = hole.u1 - hole.u0,
                   .height = hole.v1 - hole.v0,
                   .wallThickness = 0.4,
                   .columns = 2,
                   .rows = 2,
                   .frameMaterial = house.colours.frame,
                   .glassMaterial = house.colours.glass,
                   .hasSill = style.hasSills});
    }
    for (const Rectangle& hole : shops) {
        addWindow(kit, at.moved({hole.u0, 0, hole.v0}),
                  {.width = hole.u1 - hole.u0,
                   .height = hole.v1 - hole.v0,
                   .wallThickness = 0.4,
                   .columns = 3,
                   .rows = 1,
                   .frameMaterial = house.colours.dark,
                   .glassMaterial = isStreet ? house.colours.shopGlass : house.colours.glass,
                   .hasSill = !isStreet});
    }
    if (!style.hasCornices) return;
    kit.paint(house.colours.stone);
    for (int storey = 0; storey <= style.storeys; ++storey) {
        const double z = style.ground + storey * style.storey - 0.02,
                     out = storey == style.storeys ? 0.5 : 0.31;
        kit.box(at, {0.002, -out, z - 0.12}, {length - 0.002, -0.12, z + 0.1});
    }
}

void addChimneys(House& house, double z) {
    const int count = house.random.integer(1, 3);
    for (int i = 0; i < count; ++i) {
        const double x = house.width * (i + 0.5) / count - 0.35;
        const double y = house.depth * house.random.range(0.25, 0.75);
        house.kit.paint(house.colours.facades[1]);
        house.kit.box(house.at, {x, y, z - 2.0}, {x + 0.7, y + 1.1, z + 1.3});
        house.kit.paint(house.colours.tile);
        for (int pot = 0; pot < 3; ++pot) {
            const double py = y + 0.22 + 0.33 * pot;
            house.kit.rod(house.at, {x + 0.35, py, z + 1.25}, {x + 0.35, py, z + 1.75}, 0.11);
        }
    }
}

void addGableRoof(House& house, double z) {
    SceneKit& kit = house.kit;
    const double rise = house.depth * house.random.range(0.28, 0.42), over = 0.45;
    kit.beginObject("Roof " + house.name);
    kit.paint(house.random.chance(0.6) ? house.colours.tile : house.colours.slate);
    const std::array<glm::dvec2, 3> section{glm::dvec2(-over, -0.05),
                                            glm::dvec2(house.depth + over, -0.05),
                                            glm::dvec2(house.depth / 2, rise)};
    // Its section stands in the y-z plane and runs along x.
    kit.prism({house.at.point({0, 0, z}), house.at.y, house.at.z, house.at.x}, section, 0.013,
              house.width - 0.013);
    const double slope = rise / (house.depth / 2 + over);
    const int dormers = std::max(1, static_cast<int>(house.width / 5));
    for (int i = 0; i < dormers; ++i) {
        const double x = house.width * (i + 0.5) / dormers, y = house.depth * 0.14,
                     foot = z + slope * (y + over);
        kit.paint(house.colours.stone);
        kit.box(house.at, {x - 0.8, y, foot - 0.4}, {x + 0.8, y + 2.6, foot + 1.35});
        kit.paint(house.colours.slate);
        const std::array<glm::dvec2, 3> hat{glm::dvec2(-1.0, 0), glm::dvec2(1.0, 0),
                                            glm::dvec2(0, 0.7)};
        const Frame face{house.at.point({x, y + 2.9, foot + 1.34}), house.at.x, house.at.z,
                         -house.at.y};
        kit.prism(face, hat, 0, 3.1);
        kit.paint(house.colours.glass);
        kit.box(house.at, {x - 0.5, y - 0.03, foot + 0.1}, {x + 0.5, y + 0.1, foot + 1.15});
        kit.paint(house.colours.frame);
        kit.box(house.at, {x - 0.04, y - 0.05, foot + 0.08}, {x + 0.04, y + 0.09, foot + 1.17});
    }
    addChimneys(house, z + rise);
}

void addFlatRoof(House& house, double z) {
    SceneKit& kit = house.kit;
    kit.beginObject("Roof " + house.name);
    kit.paint(house.colours.slate);
    const Frame top = house.at.moved({0, 0, z});
    addSlab(kit, top, {0.214, 0.214, house.width - 0.214, house.depth - 0.214}, 0.35);
    const int units = house.random.integer(2, 5);
    for (int i = 0; i < units; ++i) {
        const Frame at = top.moved(
            {house.width * (i + 0.5) / units, house.depth * house.random.range(0.3, 0.7), 0});
        const double h = house.random.range(0.9, 2.2);
        kit.paint(house.colours.metal);
        kit.box(at, {-0.9, -0.8, -0.02}, {0.9, 0.8, h});
        kit.paint(house.colours.dark);
        kit.ring(at.moved({0, 0, h + 0.02}), 0.55, 0.05);
        for (int blade = 0; blade < 4; ++blade) {
            kit.box(at.turned(0.785 * 2 * blade), {0.08, -0.1, h + 0.02 + 0.004 * blade},
                    {0.5, 0.1, h + 0.035 + 0.004 * blade});
        }
        for (int slot = 0; slot < 6; ++slot) {
            if (!kit.keeps(house.random)) continue;
            kit.box(at, {-0.7, -0.83, 0.2 + 0.11 * slot}, {0.7, -0.78, 0.26 + 0.11 * slot});
        }
    }
    kit.paint(house.colours.metal);
    kit.rod(top, {house.width * 0.5, 1, -0.02}, {house.width * 0.5, 1, 4.2}, 0.04);
    for (int i = 0; i < 4; ++i) {
        kit.rod(top, {house.width * 0.5 - 0.6, 1.0, 3.0 + 0.28 * i},
                {house.width * 0.5 + 0.6, 1.0, 3.0 + 0.28 * i}, 0.012);
    }
}

}  // namespace

CityPalette::CityPalette(SceneKit& kit)
    : asphalt(kit.addMaterial("asphalt", 0x5E6064)),
      pavement(kit.addMaterial("pavement", 0xA9A59C)),
      line(kit.addMaterial("road marking", 0xE8E6DE)),
      grass(kit.addMaterial("grass", 0x7E9460)),
      leaf(kit.addMaterial("leaf", 0x5B8048)),
      bark(kit.addMaterial("bark", 0x6E5843)),
      frame(kit.addMaterial("window frame", 0xE7E4DC)),
      stone(kit.addMaterial("stone", 0xC9C1B2)),
      glass(kit.addMaterial("glass", 0x5C7486)),
      shopGlass(kit.addMaterial("shop glass", 0x9DBAC4, 0.4)),
      tile(kit.addMaterial("roof tile", 0x9A5A43)),
      slate(kit.addMaterial("slate", 0x5F666E)),
      metal(kit.addMaterial("metal", 0x8C9296)),
      dark(kit.addMaterial("dark metal", 0x3F4347)),
      lamp(kit.addMaterial("lamp", 0xFFF2D2)),
      tyre(kit.addMaterial("tyre", 0x2B2C2E)) {
    const uint32_t walls[8] = {0xD9C7A3, 0xC98F6B, 0xE2DBCB, 0xB96950,
                               0xA9B2A0, 0xD8B48C, 0x9FA8B3, 0xC7B7A8};
    for (size_t i = 0; i < 8; ++i)
        facades[i] = kit.addMaterial(fmt::format("facade {}", i + 1), walls[i]);
    const uint32_t cars[5] = {0xA63C34, 0x3E5C84, 0xD8D8D4, 0x4A4C50, 0xB9A23C};
    for (size_t i = 0; i < 5; ++i)
        paints[i] = kit.addMaterial(fmt::format("car {}", i + 1), cars[i]);
}

void addHouse(House house) {
    Random& random = house.random;
    FacadeStyle style{};
    style.storeys = random.integer(3, 7);
    style.ground = random.range(3.8, 4.6);
    style.storey = random.range(3.0, 3.5);
    style.bayWidth = random.range(2.4, 3.3);
    style.windowWidth = style.bayWidth * random.range(0.4, 0.55);
    style.windowHeight = style.storey * random.range(0.5, 0.6);
    style.wall = house.colours.facades[static_cast<size_t>(random.integer(0, 7))];
    style.hasSills = random.chance(0.8);
    style.hasCornices = random.chance(0.6);
    const double height = style.ground + style.storeys * style.storey;
    house.kit.beginObject("House " + house.name);
    // Houses leave 1 cm between them; side walls end inside the facades.
    addFacade(house, house.at.moved({0.005, 0.2, 0}), house.width - 0.01, style, true);
    style.hasCornices = false;
    addFacade(house, house.at.moved({house.width - 0.005, house.depth - 0.2, 0}).quarterTurned(2),
              house.width - 0.01, style, false);
    house.kit.paint(style.wall);
    for (const double x : {0.21, house.width - 0.21}) {
        addWall(house.kit, house.at.moved({x, 0.38, 0.004}).quarterTurned(1), house.depth - 0.76,
                height - 0.008, 0.39);
    }
    for (int storey = 0; storey <= style.storeys; ++storey) {  // floors close the view through
        const double z =
            style.ground - 0.3 + storey * style.storey - (storey == style.storeys ? 0.7 : 0);
        house.kit.box(house.at, {0.39, 0.37, z}, {house.width - 0.39, house.depth - 0.37, z + 0.2});
    }
    if (random.chance(0.55)) {
        addGableRoof(house, height + 0.03);
    } else {
        addFlatRoof(house, height - 0.3);
    }
}

}  // namespace pagoda::tools
