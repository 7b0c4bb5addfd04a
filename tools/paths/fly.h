// fly.h: the closed curve of a flight; what fly and teleport share.
#pragma once

#include "tools/paths/makers.h"
#include "tools/paths/open_space.h"
#include "tools/paths/poses.h"

#include <vector>

namespace pagoda::tools {

// Finely sampled, closed, always in the open; looks ahead and towards the model.
[[nodiscard]] std::vector<Pose> flightAround(const PathScene& scene, const OpenSpace& space,
                                             uint64_t seed);

}  // namespace pagoda::tools
