// city_house.h: the houses of the city: facades with windows and shops, gabled and flat roofs.
#pragma once

#include "tools/generate/building.h"

#include <array>
#include <cstdint>
#include <string>

namespace pagoda::tools {

struct CityPalette {
    explicit CityPalette(SceneKit& kit);

    uint32_t asphalt, pavement, line, grass, leaf, bark, frame, stone, glass, shopGlass, tile,
        slate, metal, dark, lamp, tyre;
    std::array<uint32_t, 8> facades{};
    std::array<uint32_t, 5> paints{};
};

struct House {
    SceneKit& kit;
    const CityPalette& colours;
    Frame at;  // at the street: x along the facade, y into the block
    double width, depth;
    Random random;
    std::string name;
};

// Objects "House NAME" and "Roof NAME"; storeys, style and colours fall by its random stream.
void addHouse(House house);

}  // namespace pagoda::tools
