// statistics.h: what a series of numbers comes to. Pure functions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::tools {

struct Spread {
    double median = 0, p95 = 0, p99 = 0, max = 0, mean = 0;
};
// Zeros for no values. Quantiles by linear interpolation.
[[nodiscard]] Spread spreadOf(std::vector<double> values);
[[nodiscard]] double quantile(const std::vector<double>& sorted, double share);

// sum(a) / sum(b) over pairs that were measured one after the other, with a bootstrap interval of
// 95% over the pairs. The same numbers give the same interval.
struct Ratio {
    double value = 0, low = 0, high = 0;
    uint64_t pairs = 0;
};
[[nodiscard]] Ratio ratioOf(std::span<const double> a, std::span<const double> b);

}  // namespace pagoda::tools
