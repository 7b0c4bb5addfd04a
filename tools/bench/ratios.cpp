#include "tools/bench/ratios.h"

#include <algorithm>
#include <numeric>

namespace pagoda::tools {
namespace {

// Frames of the slowest tenth under `yardstick`, by the mean of its repeats; places in a series.
std::vector<size_t> hardestPlaces(const BenchRun& yardstick) {
    const size_t frames = yardstick.frames;
    std::vector<double> cost(frames, 0.0);
    for (size_t i = 0; i < yardstick.cpuMsSeries.size(); ++i) {
        cost[i % frames] += yardstick.cpuMsSeries[i];
    }
    std::vector<size_t> order(frames);
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return cost[a] > cost[b]; });
    order.resize(std::min(frames, std::max<size_t>(1, frames / 10)));
    std::vector<size_t> places;
    for (size_t base = 0; base < yardstick.cpuMsSeries.size(); base += frames) {
        for (const size_t frame : order) places.push_back(base + frame);
    }
    return places;
}

std::vector<double> pick(const std::vector<double>& series, const std::vector<size_t>& places) {
    std::vector<double> values;
    for (const size_t place : places) values.push_back(series[place]);
    return values;
}

}  // namespace

bool isSameConfiguration(const BenchRun& a, const BenchRun& b) {
    return a.pathName == b.pathName && a.tauPx == b.tauPx && a.widthPx == b.widthPx &&
           a.heightPx == b.heightPx && a.queryLatencyFrames == b.queryLatencyFrames;
}

std::vector<CpuRatio> cpuRatios(const std::vector<BenchRun>& runs) {
    std::vector<CpuRatio> ratios;
    for (size_t slow = 0; slow < runs.size(); ++slow) {
        for (size_t fast = 0; fast < runs.size(); ++fast) {
            if (slow == fast || !isSameConfiguration(runs[slow], runs[fast])) continue;
            const std::vector<double>&a = runs[slow].cpuMsSeries, &b = runs[fast].cpuMsSeries;
            ratios.push_back({slow, fast, false, ratioOf(a, b)});
            if (runs[slow].strategy != "frustum") continue;
            const std::vector<size_t> places = hardestPlaces(runs[slow]);
            ratios.push_back({slow, fast, true, ratioOf(pick(a, places), pick(b, places))});
        }
    }
    return ratios;
}

}  // namespace pagoda::tools
