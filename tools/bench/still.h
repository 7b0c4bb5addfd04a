// still.h: a camera that stops along its path, again and again: does anything get coarser while
// answers of occlusion queries come in? All that the path needs is in memory.
#pragma once

#include "ooc/store/database.h"
#include "tools/bench/bench.h"

namespace pagoda::tools {

// Live frames of the still camera after one of the path: those that are late, and as many as
// learning takes.
[[nodiscard]] constexpr size_t stillFramesAtStop(uint32_t queryLatencyFrames) {
    return 12 + 2 * size_t{queryLatencyFrames};
}
// Frames that the pass draws: the path's twice (once to read what it needs), and those at stops.
[[nodiscard]] size_t stillPassFrames(const BenchPlan& plan,
                                     const BenchConfiguration& configuration);

// Stops at every plan.stillEvery-th frame (not 0). Render thread, context current.
[[nodiscard]] StillPass runStill(const BenchPlan& plan, const BenchConfiguration& configuration,
                                 const std::string& strategy, const ooc::Database& database,
                                 Progress& progress);

}  // namespace pagoda::tools
