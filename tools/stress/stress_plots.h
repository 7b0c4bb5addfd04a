// stress_plots.h: the figures of a stress report: every frame of every cell as strips of colour
// (where it hitches, where detail is missing), time to sharp against its bound, what the bytes were
// read for, budgets against their peaks.
#pragma once

#include "tools/bench/plots.h"
#include "tools/stress/stress.h"

#include <vector>

namespace pagoda::tools {

[[nodiscard]] Figures drawStressFigures(const std::vector<StressCell>& cells);

}  // namespace pagoda::tools
