// leaf_ray.h: the nearest triangle along a ray at full resolution, whatever is resident: walks the
// index front to back by its boxes and reads the leaves that the ray passes, until none can be
// nearer. Triangles are tested in lattice coordinates in double by the watertight test of Woop,
// Benthin and Wald ("Watertight Ray/Triangle Intersection", JCGT 2(1), 2013): a ray through a
// common edge or corner of two triangles meets one of them. Reads and decodes on the calling
// thread; keeps one page and the blocks of one ray. Pure: any thread.
#pragma once

#include "cache/page_source.h"
#include "hlod/view/clip.h"

#include <functional>
#include <string>
#include <vector>

namespace pagoda::hlod {

struct LeafRay {
    Vec3d originModel{0.0}, direction{0.0, 0.0, -1.0};  // any length
    double leastAlong = 0.0;                            // begins at origin + leastAlong * direction
    Clip clip;                                          // what is left out is not hit
};

struct LeafHit {
    Vec3d pointModel{0.0};
    double along = 0.0;  // point = origin + along * direction
    ooc::NodeId leaf{};
    uint32_t triangle = 0;  // its number in the leaf's page
    uint32_t object = 0, material = 0;
    bool isTranslucent = false;
    Vec3d cornersModel[3]{};
};

struct LeafRayResult {
    // The nearest opaque triangle; where there is none, the nearest translucent one.
    bool isHit = false;
    LeafHit hit;
    uint64_t readPages = 0, readBytes = 0;
    std::vector<std::string> faults;  // what could not be read: something nearer may be there
    bool isCancelled = false;
};

// `isCancelled` is asked before each read; empty: never. Ties fall to the least leaf, then
// triangle.
[[nodiscard]] LeafRayResult castLeafRay(const cache::PageSource& source,
                                        const ooc::Lattice& lattice, const LeafRay& ray,
                                        const std::function<bool()>& isCancelled = {});

}  // namespace pagoda::hlod
