// powerplant.cpp: a thermal power station. A boiler house of many storeys around the furnace, each
// with rooms full of vessels, pumps and pipes; a turbine hall; chimney, cooling towers, tanks.
// Walls and slabs close the rooms off, so that from inside nearly everything is hidden.
// More triangles than one unit can hold well make more units, one behind the other.
#include "tools/generate/detail_search.h"
#include "tools/generate/generator.h"
#include "tools/generate/plant_site.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pagoda::tools {
namespace {

constexpr uint64_t kUnitTriangles = 8'000'000;
constexpr double kUnitPitch = 210;  // metres from unit to unit, along y
constexpr double kLift = 0.005;
constexpr double kSlab = 0.26, kInner = 0.22, kOuter = 0.36;
constexpr double kDoor = 1.3, kDoorHeight = 2.25;

// What grows with the triangles asked for, besides detail.
struct Layout {
    uint64_t units;
    int storeys;  // of the boiler house
};

// A grid of rooms on one storey.
struct Storey {
    std::string name;
    Frame at;  // floor level, outer corner of the grid
    int columns, rows;
    double cellX, cellY, height;   // floor to floor
    bool hasShaft = false;         // the inner cells are open to the boiler
    Rectangle window{0, 0, 0, 0};  // in the middle of each outer cell wall; about its middle

    [[nodiscard]] double clear() const { return height - kSlab; }
    [[nodiscard]] bool isShaft(int i, int j) const {
        return hasShaft && i > 0 && i < columns - 1 && j > 0 && j < rows - 1;
    }
};

void addWindows(Site& site, const Frame& wall, const std::vector<Rectangle>& holes) {
    for (const Rectangle& hole : holes) {
        addWindow(site.kit, wall.moved({hole.u0, 0, hole.v0}),
                  {.width = hole.u1 - hole.u0,
                   .height = hole.v1 - hole.v0,
                   .wallThickness = kOuter,
                   .columns = 3,
                   .rows = std::max(2, static_cast<int>(std::lround((hole.v1 - hole.v0) / 1.5))),
                   .frameMaterial = site.colours.dark,
                   .glassMaterial = site.colours.glass,
                   .hasSill = true});
    }
}

// The four outer walls; `wall` runs along its local x with the outside at -y.
void addOuterWalls(Site& site, const Storey& storey) {
    const double lengths[2] = {storey.columns * storey.cellX, storey.rows * storey.cellY};
    const Frame corners[4] = {storey.at, storey.at.moved({lengths[0], 0, 0}),
                              storey.at.moved({lengths[0], lengths[1], 0}),
                              storey.at.moved({0, lengths[1], 0})};
    for (int side = 0; side < 4; ++side) {
        const double length = lengths[side % 2];
        // Two long walls take the corners, the others end inside them.
        const double reach = side % 2 == 0 ? kOuter / 2 + 0.012 : -kOuter / 2 + kPoke;
        const bool isInset = side % 2 == 1;  // ends inside the others, so shares no plane with them
        const Frame wall =
            corners[side].quarterTurned(side).moved({-reach, 0, isInset ? kLift : 0});
        const int cells = side % 2 == 0 ? storey.columns : storey.rows;
        std::vector<Rectangle> holes;
        for (int i = 0; storey.window.u1 > 0 && i < cells; ++i) {
            const double middle = reach + length * (i + 0.5) / cells;
            holes.push_back({middle + storey.window.u0, storey.window.v0, middle + storey.window.u1,
                             storey.window.v1});
        }
        site.kit.beginObject(fmt::format("Outer wall {} {}", storey.name, "SENW"[side]));
        site.kit.paint(site.colours.cladding);
        addWall(site.kit, wall, length + 2 * reach, storey.clear() - (isInset ? 2 * kLift : 0),
                kOuter, holes);
        addWindows(site, wall, holes);
    }
}

DoorStyle doorStyle(const Site& site, Random& random) {
    return {.width = kDoor,
            .height = kDoorHeight,
            .wallThickness = kInner,
            .openRadians = random.range(1.2, 1.75),
            .frameMaterial = site.colours.structure,
            .leafMaterial = site.colours.door,
            .handleMaterial = site.colours.steel};
}

// A wall between two cells, over the length of one, with a door in its middle.
void addInnerWall(Site& site, const Frame& at, double length, double clear) {
    site.kit.paint(site.colours.wall);
    const double u = length / 2 - kDoor / 2;
    const std::vector<Rectangle> door{{u, 0, u + kDoor, kDoorHeight}};
    addWall(site.kit, at, length, clear, kInner, door);
    if (site.kit.keeps(site.random)) {
        addDoor(site.kit, at.moved({u, 0, 0}), doorStyle(site, site.random));
    }
}

void addInnerWalls(Site& site, const Storey& storey) {
    const auto isOpen = [&](int i, int j) { return storey.isShaft(i, j); };
    // Along x, each cell on its own; the ends meet in the crossings with a gap inside the others.
    for (int j = 1; j < storey.rows; ++j) {
        site.kit.beginObject(fmt::format("Walls {} x{}", storey.name, j));
        for (int i = 0; i < storey.columns; ++i) {
            if (isOpen(i, j) || isOpen(i, j - 1)) continue;
            const double start = i == 0 ? kOuter / 2 - kPoke : 0.003;
            const double end = i + 1 == storey.columns ? kOuter / 2 - kPoke : 0.003;
            addInnerWall(site, storey.at.moved({i * storey.cellX + start, j * storey.cellY, 0}),
                         storey.cellX - start - end, storey.clear());
        }
    }
    for (int i = 1; i < storey.columns; ++i) {
        site.kit.beginObject(fmt::format("Walls {} y{}", storey.name, i));
        for (int j = 0; j < storey.rows; ++j) {
            if (isOpen(i, j) || isOpen(i - 1, j)) continue;
            const double start = (j == 0 ? kOuter : kInner) / 2 - kPoke;
            const double end = (j + 1 == storey.rows ? kOuter : kInner) / 2 - kPoke;
            const Frame wall = storey.at.moved({i * storey.cellX, j * storey.cellY + start, kLift})
                                   .quarterTurned(1);
            addInnerWall(site, wall, storey.cellY - start - end, storey.clear() - 2 * kLift);
        }
    }
}

void addSlabOf(Site& site, const Storey& storey, bool isGround) {
    const double x = storey.columns * storey.cellX, y = storey.rows * storey.cellY, rim = 0.23;
    std::vector<Rectangle> holes;
    if (storey.hasShaft && !isGround) {
        holes.push_back({storey.cellX, storey.cellY, x - storey.cellX, y - storey.cellY});
    }
    site.kit.beginObject("Floor " + storey.name);
    site.kit.paint(isGround ? site.colours.concrete : site.colours.paintedFloor);
    addSlab(site.kit, storey.at, {-rim, -rim, x + rim, y + rim}, kSlab, holes);
    if (holes.empty()) return;
    site.kit.beginObject("Shaft railing " + storey.name);
    site.kit.paint(site.colours.yellow);
    const Rectangle& h = holes[0];
    const double off = 0.12;
    const std::vector<Vec3d> path{{h.u0 - off, h.v0 - off, 0},
                                  {h.u1 + off, h.v0 - off, 0},
                                  {h.u1 + off, h.v1 + off, 0},
                                  {h.u0 - off, h.v1 + off, 0},
                                  {h.u0 - off, h.v0 - off + 0.3, 0}};
    addRailing(site.kit, storey.at, path);
}

void fillRoom(Site& site, const Storey& storey, int i, int j) {
    const std::string tag = fmt::format("{}-{}{}", storey.name, static_cast<char>('A' + j), i + 1);
    const Frame corner = storey.at.moved({i * storey.cellX, j * storey.cellY, 0});
    Random random = site.random.fork(static_cast<uint64_t>(i * 16 + j));
    constexpr double kMargin = 0.24, kAisle = 1.75;
    const double size = std::min(storey.cellX, storey.cellY) / 2 - kMargin - kAisle;
    for (int quarter = 0; quarter < 4; ++quarter) {
        const bool isEast = quarter == 1 || quarter == 2, isNorth = quarter >= 2;
        const Frame at = corner
                             .moved({isEast ? storey.cellX - kMargin : kMargin,
                                     isNorth ? storey.cellY - kMargin : kMargin, 0})
                             .quarterTurned(quarter);
        Zone zone{site.kit, site.colours,   at,
                  size,     storey.clear(), random.fork(static_cast<uint64_t>(quarter) + 1)};
        if (site.kit.keeps(random)) addEquipment(zone, fmt::format("{}.{}", tag, quarter + 1));
    }
    RoomSpace room{site.kit,     site.colours,   corner,        storey.cellX,
                   storey.cellY, storey.clear(), random.fork(9)};
    const int sides[4][2] = {{i, j - 1}, {i + 1, j}, {i, j + 1}, {i - 1, j}};
    for (unsigned side = 0; side < 4; ++side) {
        if (storey.isShaft(sides[side][0], sides[side][1])) room.wallMask &= ~(1u << side);
    }
    if (site.kit.keeps(random)) addPipeRack(room, tag);
    if (site.kit.keeps(random)) addCableTrays(room, tag);
    if (site.kit.keeps(random)) addDucts(room, tag);
    if (site.kit.keeps(random)) addFittings(room, tag);
    if (site.kit.keeps(random)) addLamps(room, tag);
}

void addStorey(Site site, const Storey& storey, bool isGround) {
    site.kit.beginGroup("Storey " + storey.name);
    addSlabOf(site, storey, isGround);
    addOuterWalls(site, storey);
    addInnerWalls(site, storey);
    for (int j = 0; j < storey.rows; ++j) {
        for (int i = 0; i < storey.columns; ++i) {
            if (!storey.isShaft(i, j)) fillRoom(site, storey, i, j);
        }
    }
    site.kit.endGroup();
}

constexpr double kBoilerX = 80, kCell = 12.6, kBoilerStorey = 7.0;
constexpr int kBoilerCells = 4, kMaxBoilerStoreys = 6;
constexpr double kHallX = 69.6, kHallY = 34.8, kDeck = 7.0, kHallTop = 26;

void addBoilerHouse(const Site& site, int storeys) {
    site.kit.beginGroup("Boiler house");
    const Frame at = site.at.moved({kBoilerX, 0, 0});
    for (int level = 0; level < storeys; ++level) {
        const Storey storey{.name = fmt::format("B{}", level),
                            .at = at.moved({0, 0, level * kBoilerStorey}),
                            .columns = kBoilerCells,
                            .rows = kBoilerCells,
                            .cellX = kCell,
                            .cellY = kCell,
                            .height = kBoilerStorey,
                            .hasShaft = true,
                            .window = {-3.4, 1.2, 3.4, 3.6}};
        addStorey({site.kit, site.colours, site.at,
                   site.random.fork(100u + static_cast<uint64_t>(level))},
                  storey, level == 0);
    }
    const double side = kBoilerCells * kCell, top = storeys * kBoilerStorey;
    site.kit.beginObject("Boiler house roof");
    site.kit.paint(site.colours.dark);
    addSlab(site.kit, at.moved({0, 0, top}), {-0.3, -0.3, side + 0.3, side + 0.3}, kSlab);
    addRoofPlant({site.kit, site.colours, at.moved({0, 0, top}), site.random.fork(4)}, side, side);
    addBoiler({site.kit, site.colours, at, site.random.fork(3)}, {side / 2, side / 2, 0},
              2 * kCell - 4.4, 0.6, top - 1.5);
    site.kit.endGroup();
}

void addTurbineHall(const Site& site) {
    site.kit.beginGroup("Turbine hall");
    Storey lower{.name = "T0",
                 .at = site.at,
                 .columns = 6,
                 .rows = 3,
                 .cellX = kHallX / 6,
                 .cellY = kHallY / 3,
                 .height = kDeck,
                 .hasShaft = false,
                 .window = {-2.6, 1.2, 2.6, 3.2}};
    addStorey({site.kit, site.colours, site.at, site.random.fork(11)}, lower, true);
    const Frame deck = site.at.moved({0, 0, kDeck});
    Storey upper = lower;
    upper.name = "T1";
    upper.at = deck;
    upper.height = kHallTop - kDeck;
    upper.window = {-2.1, 3.0, 2.1, 12.0};
    Site own{site.kit, site.colours, deck, site.random.fork(12)};
    addSlabOf(own, upper, false);
    addOuterWalls(own, upper);
    site.kit.beginObject("Turbine hall roof");
    site.kit.paint(site.colours.dark);
    addSlab(site.kit, deck.moved({0, 0, upper.height}), {-0.3, -0.3, kHallX + 0.3, kHallY + 0.3},
            kSlab);
    addRoofPlant({site.kit, site.colours, deck.moved({0, 0, upper.height}), site.random.fork(13)},
                 kHallX, kHallY);
    addHallFrame(own, kHallX, kHallY, 0, upper.clear());
    addTurbines(own, kHallX, kHallY, 0);
    site.kit.endGroup();
}

void buildPlant(SceneKit& kit, const Layout& layout, uint64_t seed) {
    const PlantPalette colours(kit);
    for (uint64_t unit = 0; unit < layout.units; ++unit) {
        kit.beginGroup(fmt::format("Unit {}", unit + 1));
        const Site site{kit, colours, Frame{}.moved({0, static_cast<double>(unit) * kUnitPitch, 0}),
                        Random(seed).fork(unit)};
        addBoilerHouse(site, layout.storeys);
        addTurbineHall(site);
        kit.beginGroup("Surroundings");
        addSurroundings({kit, colours, site.at, site.random.fork(21)});
        kit.endGroup();
        kit.endGroup();
    }
    kit.flush();
}

// Round the boiler on every second storey, and through the rooms under the turbines.
SceneViews plantViews(const Layout& layout) {
    SceneViews views;
    const double eye = 1.7, side = kBoilerCells * kCell, half = kCell / 2;
    const double near = half, far = side - half;
    for (int k = 0; k < 3; ++k) {
        const int level = std::min(2 * k, layout.storeys - 1);
        const double z = level * kBoilerStorey + eye;
        const Vec3d ring[4] = {{near, near, z}, {far, near, z}, {far, far, z}, {near, far, z}};
        for (int corner = 0; corner < 4; ++corner) {
            const Vec3d from = ring[corner] + Vec3d(kBoilerX, 0, 0);
            const Vec3d to = ring[(corner + 1) % 4] + Vec3d(kBoilerX, 0, 0);
            views.walk.push_back({from + 0.06 * (to - from), to - Vec3d(0, 0, 0.4)});
        }
    }
    for (int k = 0; k < 4; ++k) {
        const double x = kHallX / 6 * (k + 0.5) - 1, y = kHallY / 6;
        views.walk.push_back({{x, y, eye}, {x + 10, y + (k % 2 == 0 ? 0.5 : 6.0), eye - 0.3}});
    }
    views.walk.push_back({{3, 3, kDeck + 3.2}, {50, 20, kDeck + 2}});
    views.outside = {{{-75, -105, 55}, {65, 35, 15}},
                     {{190, -70, 30}, {85, 30, 18}},
                     {{60, -60, 6}, {80, 20, 18}},
                     {{-60, 120, 120}, {80, 30, 0}}};
    return views;
}

}  // namespace

SceneViews generatePowerplant(ooc::TriangleSink& sink, const GenerateOptions& options) {
    const Layout layout{
        .units = std::max<uint64_t>(1, (options.triangles + kUnitTriangles / 2) / kUnitTriangles),
        .storeys = static_cast<int>(
            std::clamp<uint64_t>(options.triangles / 80'000, 1, kMaxBoilerStoreys))};
    const double detail = findDetail(options.triangles, "powerplant",
                                     [&](SceneKit& kit) { buildPlant(kit, layout, options.seed); });
    SceneKit kit(&sink, detail);
    buildPlant(kit, layout, options.seed);
    return plantViews(layout);
}

}  // namespace pagoda::tools
