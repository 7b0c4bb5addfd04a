// interior.cpp: an office building. On each storey a corridor with rooms on both sides: offices,
// meeting rooms, libraries, lounges, stores, all furnished. More triangles make more rooms, storeys
// and wings, so that the density inside stays that of a real building.
#include "tools/generate/detail_search.h"
#include "tools/generate/furniture.h"
#include "tools/generate/generator.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace pagoda::tools {
namespace {

constexpr double kRoomX = 6.2, kRoomY = 6.4, kCorridor = 2.6, kStorey = 3.4, kSlab = 0.3;
constexpr double kClear = kStorey - kSlab, kInner = 0.15, kOuter = 0.34;
constexpr double kDepth = 2 * kRoomY + kCorridor;
constexpr double kLift = 0.004;  // walls that end inside others share no plane with them
constexpr double kDoor = 0.95, kDoorHeight = 2.08;
constexpr double kTrianglesPerRoom = 32000;
constexpr uint64_t kMaxColumns = 16, kMaxStoreys = 8;

struct Layout {
    uint64_t wings = 1, storeys = 1, columns = 3;
};

Layout layoutFor(uint64_t triangles) {
    const double rooms = std::max(4.0, static_cast<double>(triangles) / kTrianglesPerRoom);
    Layout layout;
    layout.storeys = std::clamp<uint64_t>(
        static_cast<uint64_t>(std::lround(std::cbrt(rooms * 0.6))), 1, kMaxStoreys);
    const double columns = rooms / (2 * static_cast<double>(layout.storeys));
    layout.wings = static_cast<uint64_t>(std::ceil(columns / static_cast<double>(kMaxColumns)));
    layout.columns = std::max<uint64_t>(
        2, static_cast<uint64_t>(std::lround(columns / static_cast<double>(layout.wings))));
    return layout;
}

// Seen from its window, a room's door is always on the left.
double doorAt(int side, double roomStart) {
    return roomStart + (side == 0 ? 0.75 : kRoomX - 0.75 - kDoor);
}

struct Builder {
    SceneKit& kit;
    const InteriorPalette& colours;
    Random random;
    int columns;
};

WindowStyle windowStyle(const InteriorPalette& colours, double width) {
    return {.width = width,
            .height = 1.65,
            .wallThickness = kOuter,
            .columns = 3,
            .rows = 1,
            .frameMaterial = colours.white,
            .glassMaterial = colours.glass,
            .hasSill = true};
}

// Long walls with a window a room, short ones with one at the corridor's end.
void addShell(Builder& b, const Frame& at, const std::string& name) {
    SceneKit& kit = b.kit;
    const double length = b.columns * kRoomX;
    const double lengths[2] = {length, kDepth};
    const Frame corners[4] = {at, at.moved({length, 0, 0}), at.moved({length, kDepth, 0}),
                              at.moved({0, kDepth, 0})};
    for (int side = 0; side < 4; ++side) {
        kit.beginObject(fmt::format("Facade {}{}", name, "SENW"[side]));
        const bool isLong = side % 2 == 0;
        const double reach = isLong ? kOuter / 2 + 0.012 : -kOuter / 2 + kPoke;
        const Frame wall = corners[side].quarterTurned(side).moved({-reach, 0, isLong ? 0 : kLift});
        std::vector<Rectangle> holes;
        for (int i = 0; isLong && i < b.columns; ++i) {
            const double middle = reach + kRoomX * (i + 0.5);
            holes.push_back({middle - 1.6, 0.92, middle + 1.6, 2.57});
        }
        if (!isLong) {
            const double middle = kDepth / 2 + reach;
            holes.push_back({middle - 0.8, 0.92, middle + 0.8, 2.57});
        }
        kit.paint(b.colours.facade);
        addWall(kit, wall, lengths[side % 2] + 2 * reach, kClear - (isLong ? 0 : 2 * kLift), kOuter,
                holes);
        for (const Rectangle& hole : holes) {
            addWindow(kit, wall.moved({hole.u0, 0, hole.v0}),
                      windowStyle(b.colours, hole.u1 - hole.u0));
        }
    }
}

void addRoomDoor(Builder& b, const Frame& at, const std::string& room) {
    b.kit.beginObject("Door " + room);
    addDoor(b.kit, at,
            {.width = kDoor,
             .height = kDoorHeight,
             .wallThickness = kInner,
             .openRadians = b.random.chance(0.7) ? b.random.range(1.1, 1.7) : 0.02,
             .frameMaterial = b.colours.white,
             .leafMaterial = b.random.chance(0.5) ? b.colours.oak : b.colours.walnut,
             .handleMaterial = b.colours.chrome});
}

// Corridor walls with a door and, at meeting rooms, a pane of glass; partitions between rooms.
void addPartitions(Builder& b, const Frame& at, const std::string& name) {
    SceneKit& kit = b.kit;
    for (int side = 0; side < 2; ++side) {
        const double y = side == 0 ? kRoomY : kRoomY + kCorridor;
        const double start = kOuter / 2 - kPoke, length = b.columns * kRoomX - 2 * start;
        const Frame wall = at.moved({start, y, 0});
        std::vector<Rectangle> holes, panes;
        for (int i = 0; i < b.columns; ++i) {
            const double u = i * kRoomX - start;
            const double door = doorAt(side, u), pane = side == 0 ? u + 2.6 : u + 1.0;
            holes.push_back({door, 0, door + kDoor, kDoorHeight});
            if (b.random.chance(0.35)) panes.push_back({pane, 0.95, pane + 2.6, 2.35});
        }
        std::vector<Rectangle> all = holes;
        all.insert(all.end(), panes.begin(), panes.end());
        kit.beginObject(fmt::format("Corridor wall {}{}", name, "SN"[side]));
        kit.paint(b.colours.plaster);
        addWall(kit, wall, length, kClear, kInner, all);
        for (const Rectangle& pane : panes) {
            kit.beginObject(fmt::format("Glass partition {}{}", name, side));
            addWindow(kit, wall.moved({pane.u0, 0, pane.v0}),
                      {.width = pane.u1 - pane.u0,
                       .height = pane.v1 - pane.v0,
                       .wallThickness = 0.23,
                       .columns = 2,
                       .rows = 1,
                       .frameMaterial = b.colours.steel,
                       .glassMaterial = b.colours.glass,
                       .hasSill = false});
        }
        for (int i = 0; i < b.columns; ++i) {
            // Leaves open into the rooms: south of the south wall, north of the north wall.
            const Frame hinge =
                wall.moved({holes[static_cast<size_t>(i)].u0 + (side == 0 ? kDoor : 0), 0, 0});
            addRoomDoor(b, hinge.quarterTurned(side == 0 ? 2 : 0),
                        fmt::format("{}{}{}", name, "SN"[side], i + 1));
        }
    }
    for (int i = 1; i < b.columns; ++i) {
        kit.beginObject(fmt::format("Partition {}{}", name, i));
        kit.paint(b.colours.plaster);
        for (int side = 0; side < 2; ++side) {
            const double y0 =
                side == 0 ? kOuter / 2 - kPoke : kRoomY + kCorridor + kInner / 2 - kPoke;
            const double y1 = side == 0 ? kRoomY - kInner / 2 + kPoke : kDepth - kOuter / 2 + kPoke;
            addWall(kit, at.moved({i * kRoomX, y0, 2 * kLift}).quarterTurned(1), y1 - y0,
                    kClear - 4 * kLift, kInner);
        }
    }
}

// A room's own frame: origin in the middle of its window wall, x to the right seen from the window,
// y towards the corridor; usable x -2.95..2.95, y 0.2..6.3, the door near (-x, 6.3).
struct Room {
    Furnisher& f;
    Frame at;
    double left, right;  // from its middle to the side walls; the building's own are thicker
};

constexpr double kBack = kRoomY - kInner / 2;

void addSidePictures(Room& room) {
    const Frame left = room.at.moved({-room.left, 2.6, 1.35}).quarterTurned(3);
    room.f.picture(left, room.f.random.range(0.5, 1.0), room.f.random.range(0.5, 0.8));
}

void furnishOffice(Room& room) {
    Furnisher& f = room.f;
    for (const double sign : {-1.0, 1.0}) {
        const Frame desk = room.at.moved({sign * 1.25, 2.0, 0}).quarterTurned(sign > 0 ? 1 : 3);
        f.desk(desk);
        f.officeChair(desk.moved({f.random.range(-0.15, 0.15), 0.85, 0})
                          .turned(3.14 + f.random.range(-0.5, 0.5)));
    }
    f.shelf(room.at.moved({room.right, 4.6, 0}).quarterTurned(1), f.random.range(1.6, 2.2),
            f.random.range(1.9, 2.4));
    f.plant(room.at.moved({-2.5, 0.75, 0}));
    addSidePictures(room);
}

void furnishMeeting(Room& room) {
    Furnisher& f = room.f;
    const double length = f.random.range(2.6, 3.4), width = f.random.range(1.05, 1.3);
    const Frame middle = room.at.moved({0.25, 2.9, 0}).quarterTurned(1);
    f.table(middle, length, width);
    const int seats = static_cast<int>(length / 0.75);
    for (int i = 0; i < seats; ++i) {
        const double x = (length - 0.5) * ((i + 0.5) / seats - 0.5);
        f.officeChair(
            middle.moved({x, width / 2 + 0.35, 0}).turned(3.14 + f.random.range(-0.4, 0.4)));
        f.officeChair(middle.moved({x, -width / 2 - 0.35, 0}).turned(f.random.range(-0.4, 0.4)));
    }
    f.whiteboard(room.at.moved({room.right, 2.9, 0}).quarterTurned(1), f.random.range(1.8, 2.6));
    f.pendantLamps(room.at.moved({0.25, 2.9, kClear}).quarterTurned(1), 3, 1.0, 1.15);
    f.plant(room.at.moved({2.5, 5.7, 0}));
    addSidePictures(room);
}

void furnishLibrary(Room& room) {
    Furnisher& f = room.f;
    for (int row = 0; row < 3; ++row) {
        const double y = 1.3 + 1.35 * row;
        f.shelf(room.at.moved({0.55, y, 0}), 3.6, f.random.range(1.9, 2.3));
        f.shelf(room.at.moved({0.55, y - 0.006, 0}).quarterTurned(2), 3.6,
                f.random.range(1.9, 2.3));
    }
    f.shelf(room.at.moved({-room.left, 2.8, 0}).quarterTurned(3), 2.8, f.random.range(2.0, 2.5));
    f.floorLamp(room.at.moved({2.65, 0.65, 0}));
    f.woodenChair(room.at.moved({-2.4, 0.7, 0}).turned(-0.8), f.colours.oak);
}

void furnishLounge(Room& room) {
    Furnisher& f = room.f;
    f.sofa(room.at.moved({room.right - 0.55, 2.3, 0}).quarterTurned(1), f.random.range(1.9, 2.4));
    f.sofa(room.at.moved({0.5, 1.0, 0}), f.random.range(0.95, 1.1));
    f.roundTable(room.at.moved({1.15, 2.4, 0}), 0.5);
    f.roundTable(room.at.moved({-1.4, 3.4, 0}), 0.55);
    for (int i = 0; i < 4; ++i) {
        const Frame seat =
            room.at.moved({-1.4, 3.4, 0}).turned(0.5 + 1.5708 * i).moved({0, -0.75, 0});
        f.woodenChair(seat, i % 2 == 0 ? f.colours.oak : f.colours.birch);
    }
    f.floorLamp(room.at.moved({2.6, 0.7, 0}));
    f.kitchen(room.at.moved({1.05, kBack, 0}).quarterTurned(2), 3.0);
    f.plant(room.at.moved({-2.5, 0.8, 0}));
    addSidePictures(room);
}

void furnishStore(Room& room) {
    Furnisher& f = room.f;
    for (int i = 0; i < 3; ++i) f.crates(room.at.moved({0.4, 1.0 + 1.5 * i, 0}), 3.6);
    f.crates(room.at.moved({room.right, 3.0, 0}).quarterTurned(1), 3.4);
    f.crates(room.at.moved({-room.left, 2.6, 0}).quarterTurned(3), 3.0);
}

void addRoom(Builder& b, const Frame& at, double left, double right, const std::string& name) {
    SceneKit& kit = b.kit;
    Furnisher f(kit, b.colours, b.random.fork(b.random.next()), name);
    Room room{f, at, left, right};
    kit.beginGroup("Room " + name);
    kit.beginObject("Carpet " + name);
    kit.paint(b.colours.carpets[f.random.integer(0, 3)]);
    kit.box(at, {-left + 0.05, kOuter / 2 + 0.05, -0.01}, {right - 0.05, kBack - 0.05, 0.006});
    kit.beginObject("Skirting " + name);
    kit.paint(b.colours.white);
    for (const double x : {-left, right}) {
        kit.box(at, {x - 0.013, kOuter / 2 + 0.02, -0.011}, {x + 0.013, kBack - 0.02, 0.08});
    }
    kit.box(at, {-left + 0.014, kOuter / 2 - 0.013, -0.011},
            {right - 0.014, kOuter / 2 + 0.013, 0.081});
    f.radiator(at.moved({0, kOuter / 2, 0}), f.random.range(1.2, 2.0));
    for (const double sign : {-1.0, 1.0}) {
        f.curtain(at.moved({sign * 1.95 - 0.4, kOuter / 2 + 0.12, 0.12}), f.random.range(0.7, 0.9),
                  2.6);
    }
    for (const double y : {1.8, 4.4}) {
        for (const double x : {-1.4, 1.4}) f.ceilingPanel(at.moved({x, y, kClear}));
    }
    constexpr std::array<void (*)(Room&), 7> kKinds{furnishOffice, furnishLibrary, furnishMeeting,
                                                    furnishOffice, furnishLounge,  furnishStore,
                                                    furnishMeeting};
    const size_t kind = static_cast<size_t>(f.random.integer(0, 6));
    kKinds[kind](room);
    kit.endGroup();
}

void addCorridor(Builder& b, const Frame& at, const std::string& name) {
    Furnisher f(b.kit, b.colours, b.random.fork(77), name);
    b.kit.beginGroup("Corridor " + name);
    b.kit.beginObject("Runner " + name);
    b.kit.paint(b.colours.carpets[0]);
    const double length = b.columns * kRoomX, y0 = kRoomY + kInner / 2;
    b.kit.box(at, {0.4, y0 + 0.45, -0.01}, {length - 0.4, y0 + kCorridor - kInner - 0.45, 0.005});
    for (int i = 0; i < b.columns; ++i) {
        const double x = kRoomX * (i + 0.5);
        f.ceilingPanel(at.moved({x, kRoomY + kCorridor / 2, kClear}));
        if (f.random.chance(0.5)) f.plant(at.moved({x - kRoomX * 0.5 + 0.35, y0 + 0.35, 0}));
        if (f.random.chance(0.4)) {
            f.picture(at.moved({i * kRoomX + 2.15, y0, 1.3}), 0.55, f.random.range(0.4, 0.7));
        }
        if (f.random.chance(0.35)) {
            f.woodenChair(
                at.moved({i * kRoomX + 2.2, y0 + kCorridor - kInner - 0.4, 0}).turned(3.14159),
                b.colours.walnut);
        }
    }
    b.kit.endGroup();
}

void addStorey(Builder& b, const Frame& at, const std::string& name) {
    b.kit.beginGroup("Storey " + name);
    b.kit.beginObject("Slab " + name);
    b.kit.paint(b.colours.stone);
    const double length = b.columns * kRoomX;
    addSlab(b.kit, at, {-0.26, -0.26, length + 0.26, kDepth + 0.26}, kSlab);
    addShell(b, at, name);
    addPartitions(b, at, name);
    addCorridor(b, at, name);
    for (int i = 0; i < b.columns; ++i) {
        const double x = kRoomX * (i + 0.5);
        const double inner = kRoomX / 2 - kInner / 2, outer = kRoomX / 2 - kOuter / 2;
        const double west = i == 0 ? outer : inner, east = i + 1 == b.columns ? outer : inner;
        addRoom(b, at.moved({x, 0, 0}), west, east, fmt::format("{}S{}", name, i + 1));
        addRoom(b, at.moved({x, kDepth, 0}).quarterTurned(2), east, west,
                fmt::format("{}N{}", name, i + 1));
    }
    b.kit.endGroup();
}

void buildInterior(SceneKit& kit, const Layout& layout, uint64_t seed) {
    const InteriorPalette colours(kit);
    for (uint64_t wing = 0; wing < layout.wings; ++wing) {
        const std::string name = layout.wings > 1 ? fmt::format("{}-", wing + 1) : "";
        kit.beginGroup(fmt::format("Wing {}", wing + 1));
        const Frame at = Frame{}.moved({0, static_cast<double>(wing) * (kDepth + 9), 0});
        for (uint64_t storey = 0; storey < layout.storeys; ++storey) {
            Builder b{kit, colours, Random(seed).fork(wing * 64 + storey),
                      static_cast<int>(layout.columns)};
            addStorey(b, at.moved({0, 0, static_cast<double>(storey) * kStorey}),
                      fmt::format("{}{}", name, storey));
        }
        kit.beginObject("Roof " + name);
        kit.paint(colours.roof);
        const double length = static_cast<double>(layout.columns) * kRoomX;
        addSlab(kit, at.moved({0, 0, static_cast<double>(layout.storeys) * kStorey}),
                {-0.4, -0.4, length + 0.4, kDepth + 0.4}, kSlab);
        kit.endGroup();
    }
    kit.flush();
}

// Along the corridors, and into rooms from their doors.
SceneViews interiorViews(const Layout& layout) {
    SceneViews views;
    const double length = static_cast<double>(layout.columns) * kRoomX,
                 middle = kRoomY + kCorridor / 2;
    for (uint64_t i = 0; i < 16; ++i) {
        const double z = static_cast<double>(i % layout.storeys) * kStorey + 1.65;
        const uint64_t room = i * layout.columns / 16;
        const double door =
            doorAt(i % 4 == 3 ? 1 : 0, kRoomX * static_cast<double>(room)) + kDoor / 2;
        switch (i % 4) {
            case 0:
                views.walk.push_back({{1.0, middle, z}, {length, middle, z - 0.3}});
                break;
            case 1:  // in the southern room, from its door
                views.walk.push_back({{door + 0.25, kRoomY - 0.9, z}, {door + 2.6, 0.8, z - 0.6}});
                break;
            case 2:
                views.walk.push_back(
                    {{length * 0.6, middle + 0.2, z}, {0.0, middle - 0.3, z - 0.3}});
                break;
            default:  // in the northern one
                views.walk.push_back({{door - 0.25, kRoomY + kCorridor + 0.9, z},
                                      {door - 2.6, kDepth - 0.8, z - 0.6}});
        }
    }
    const double top = static_cast<double>(layout.storeys) * kStorey;
    views.outside = {
        {{length * 0.9 + 18, -26, top * 0.7 + 6}, {length / 2, kDepth / 2, top * 0.4}}};
    return views;
}

}  // namespace

SceneViews generateInterior(ooc::TriangleSink& sink, const GenerateOptions& options) {
    const Layout layout = layoutFor(options.triangles);
    const double detail = findDetail(options.triangles, "interior", [&](SceneKit& kit) {
        buildInterior(kit, layout, options.seed);
    });
    SceneKit kit(&sink, detail);
    buildInterior(kit, layout, options.seed);
    return interiorViews(layout);
}

}  // namespace pagoda::tools
