// furniture.h: what stands in the rooms of the interior.
// Each piece is an object of its own, built at a frame whose origin is on the floor: in the middle
// of the piece, or, where it belongs to a wall, in the middle of its back with local y into the
// room.
#pragma once

#include "tools/generate/building.h"

#include <string>
#include <utility>

namespace pagoda::tools {

struct InteriorPalette {
    explicit InteriorPalette(SceneKit& kit);

    uint32_t plaster, facade, ceiling, stone, oak, walnut, birch, white, black, steel, chrome;
    uint32_t glass, screen, leaf, clay, lamp, brass, paper, roof;
    uint32_t fabrics[5], books[8], carpets[4], paints[4];
};

class Furnisher {
public:
    // `roomName` ends the objects' names.
    Furnisher(SceneKit& sceneKit, const InteriorPalette& palette, Random stream,
              std::string roomName)
        : kit(sceneKit), colours(palette), random(stream), room(std::move(roomName)) {}

    SceneKit& kit;
    const InteriorPalette& colours;
    Random random;
    std::string room;

    void officeChair(const Frame& at);
    void woodenChair(const Frame& at, uint32_t wood);
    void desk(const Frame& at);  // with screen, keyboard, cup, lamp; the user sits at +y
    void table(const Frame& at, double length, double width);
    void roundTable(const Frame& at, double radius);
    void shelf(const Frame& at, double width, double height);  // at a wall, full of books
    void sofa(const Frame& at, double width);
    void floorLamp(const Frame& at);
    void plant(const Frame& at);
    void radiator(const Frame& at, double width);                // at a wall
    void picture(const Frame& at, double width, double height);  // its lower edge at the origin
    void whiteboard(const Frame& at, double width);
    void kitchen(const Frame& at, double width);
    void pendantLamps(const Frame& at, int count, double pitch, double drop);  // from z = 0 down
    void ceilingPanel(const Frame& at);
    void curtain(const Frame& at, double width, double height);
    void crates(const Frame& at, double width);  // a rack with boxes, at a wall

private:
    void begin(const char* name);
    void cup(const Frame& at);
    void deskLamp(const Frame& at);
    void keyboard(const Frame& at);
    void book(const Frame& at, double thickness, double height, double depth);
    void cushion(const Frame& at, double x, double y, double z);
    int count_ = 0;
    int curtainFabric_ = -1;  // one a room
};

}  // namespace pagoda::tools
