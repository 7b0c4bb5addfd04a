// soak_rig.h: what the soak runs its frames on: the whole run time on some device, and beside it
// the leaves alone, which say what must not be missing from a picture.
#pragma once

#include "hlod/strategies/strategies.h"
#include "tests/hlod/software_rig.h"

#include <memory>

namespace pagoda::hlod::test {

class SoakRig {
public:
    virtual ~SoakRig() = default;
    // One live frame; then the clock goes on by a sixtieth of a second.
    virtual FrameRecord run(const Camera& camera, Strategy& strategy, double tauPx) = 0;
    virtual FrameRunner& runner() = 0;
    // As the device itself counts them.
    virtual uint64_t gpuBytes() = 0;
    virtual bool contains(cache::PageId page) = 0;
    // Of the last frame: holes() against the leaves seen from `camera`, its own.
    virtual uint64_t holes(const Camera& camera) = 0;
    virtual uint64_t pagesRead() const = 0;
};

struct SoakOptions {
    RigOptions rig;
    bool isPollFree = false;  // where the device leaves the choice
    bool doesPrefetch = false;
};

// Makes rigs; they share the truth. The scene outlives it, and it outlives the rigs.
class SoakDevice {
public:
    virtual ~SoakDevice() = default;
    virtual std::unique_ptr<SoakRig> makeRig(const SoakOptions& options) = 0;
    // No budgets of a rig are below these.
    virtual uint64_t leastHostBytes() const = 0;
    virtual uint64_t leastGpuBytes() const = 0;
};

std::unique_ptr<SoakDevice> makeSoftwareDevice(const RoomScene& scene);
std::unique_ptr<SoakDevice> makeGlDevice(const RoomScene& scene);  // where there is GL

}  // namespace pagoda::hlod::test
