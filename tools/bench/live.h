// live.h: a camera path as it would be seen: one frame after the other, whether its pages have come
// or not, from a simulated disk on a clock that goes on by one frame at a time. The same path, disk
// and settings give the same numbers on every machine.
#pragma once

#include "ooc/store/database.h"
#include "tools/bench/bench.h"

namespace pagoda::tools {

// The first picture is waited for; the path begins there. Render thread, context current.
[[nodiscard]] LivePass runLive(const BenchPlan& plan, const BenchConfiguration& configuration,
                               const std::string& strategy, const ooc::Database& database,
                               Progress& progress);

}  // namespace pagoda::tools
