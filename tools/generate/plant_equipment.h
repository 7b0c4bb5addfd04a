// plant_equipment.h: what stands in the rooms of the power plant.
// Each function fills one corner of a room: local x and y run along the two walls from the corner,
// z up from the floor; it stays within `size` in x and y and `height` in z.
#pragma once

#include "tools/generate/building.h"

#include <string>
#include <string_view>

namespace pagoda::tools {

struct PlantPalette {
    explicit PlantPalette(SceneKit& kit);

    uint32_t concrete, paintedFloor, wall, structure, steel, yellow, insulation, galvanised, duct;
    uint32_t pump, motor, cabinet, cable, dark, red, white, brick, cladding, asphalt, ground;
    uint32_t door, glass, lamp, screen, boiler, orange;
    uint32_t media[6];  // steam, water, air, gas, oil, acid
};

inline constexpr std::string_view kMediumNames[6] = {"steam", "water", "air", "gas", "oil", "acid"};

struct Zone {
    SceneKit& kit;
    const PlantPalette& colours;
    Frame at;
    double size, height;
    Random random;
};

// Equipment stays below this height, pipes above, so that nothing runs through a vessel.
inline constexpr double kPlantClear = 4.45;

using Equipment = void (*)(Zone& zone, const std::string& tag);
// Picks one; `tag` goes into the object's name ("Room 3.07").
void addEquipment(Zone& zone, const std::string& tag);

// A valve in a pipe along local z at the origin; its hand wheel towards local y.
void addValve(SceneKit& kit, const PlantPalette& colours, const Frame& at, double pipeRadius);
// A pair of flanges with bolts around a pipe along local z.
void addFlange(SceneKit& kit, const Frame& at, double pipeRadius, Random& random);

// Overhead, through a whole room of the size x by y: pipes in a rack with drops into the corners,
// cables, ducts, lamps. Local origin at the room's corner on the floor.
struct RoomSpace {
    SceneKit& kit;
    const PlantPalette& colours;
    Frame at;
    double sizeX, sizeY, height;
    Random random;
    unsigned wallMask = 15;  // bits 0..3: there is a wall at south, east, north, west
};
void addPipeRack(RoomSpace& room, const std::string& tag);
void addCableTrays(RoomSpace& room, const std::string& tag);
void addDucts(RoomSpace& room, const std::string& tag);
void addFittings(RoomSpace& room, const std::string& tag);  // beside the doors, on the floor
void addLamps(RoomSpace& room, const std::string& tag);

}  // namespace pagoda::tools
