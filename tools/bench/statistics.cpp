#include "tools/bench/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <random>

namespace pagoda::tools {

double quantile(const std::vector<double>& sorted, double share) {
    if (sorted.empty()) return 0;
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<size_t>(place);
    const size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

Spread spreadOf(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    return {quantile(values, 0.5), quantile(values, 0.95), quantile(values, 0.99), values.back(),
            sum / static_cast<double>(values.size())};
}

Ratio ratioOf(std::span<const double> a, std::span<const double> b) {
    assert(a.size() == b.size());
    Ratio ratio;
    ratio.pairs = a.size();
    const auto sum = [](std::span<const double> values) {
        return std::accumulate(values.begin(), values.end(), 0.0);
    };
    if (a.empty() || !(sum(b) > 0)) return ratio;
    ratio.value = sum(a) / sum(b);
    constexpr int kResamples = 1000;
    std::mt19937_64 random(1);
    std::vector<double> ratios;
    for (int i = 0; i < kResamples; ++i) {
        double sumA = 0, sumB = 0;
        for (size_t k = 0; k < a.size(); ++k) {
            const size_t pick = random() % a.size();
            sumA += a[pick];
            sumB += b[pick];
        }
        if (sumB > 0) ratios.push_back(sumA / sumB);
    }
    std::sort(ratios.begin(), ratios.end());
    ratio.low = quantile(ratios, 0.025);
    ratio.high = quantile(ratios, 0.975);
    return ratio;
}

}  // namespace pagoda::tools
