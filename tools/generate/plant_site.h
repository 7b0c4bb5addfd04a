// plant_site.h: the large things of the power plant: boiler, turbine hall and what stands outside.
#pragma once

#include "tools/generate/plant_equipment.h"

namespace pagoda::tools {

struct Site {
    SceneKit& kit;
    const PlantPalette& colours;
    Frame at;  // the unit's own origin: south-west corner of the turbine hall
    Random random;
};

// The furnace in its shaft: centre at the local x, y; `width` square, from z0 to z1.
void addBoiler(Site site, const Vec3d& centre, double width, double z0, double z1);
// Inside the hall: machines on a deck at z, over length x width from the origin.
void addTurbines(Site site, double length, double width, double z);
// Columns, roof trusses and the crane of the hall.
void addHallFrame(Site site, double length, double width, double z0, double z1);
// Parapet rail, fans, vents and stacks on a roof of that size; its top at local z = 0.
void addRoofPlant(Site site, double length, double width);
// Everything around the buildings, ground included.
void addSurroundings(Site site);

}  // namespace pagoda::tools
