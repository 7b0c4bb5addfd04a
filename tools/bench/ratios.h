// ratios.h: how many times as fast one strategy is as another: their CPU times frame by frame,
// pairs that were measured one after the other. Pure functions.
#pragma once

#include "tools/bench/bench.h"

#include <vector>

namespace pagoda::tools {

// Same path, tau, size and latency: only such runs may be compared.
[[nodiscard]] bool isSameConfiguration(const BenchRun& a, const BenchRun& b);

struct CpuRatio {
    size_t numerator = 0, denominator = 0;  // places in `runs`
    bool isHardest = false;  // of the frames that cost `frustum` most, a tenth of them
    Ratio ratio;
};
// Every run over every other one of its configuration, in order; over `frustum` also the hardest.
[[nodiscard]] std::vector<CpuRatio> cpuRatios(const std::vector<BenchRun>& runs);

}  // namespace pagoda::tools
