// rate_meter.h: how much comes a second, over the last second. Pure state; times come from outside.
#pragma once

#include <cstdint>
#include <deque>
#include <utility>

namespace pagoda::viewer {

class RateMeter {
public:
    // `total` so far, at `seconds`; both never fall.
    void add(double seconds, uint64_t total) {
        samples_.emplace_back(seconds, total);
        while (samples_.size() > 2 && samples_[1].first <= seconds - kWindowSeconds) {
            samples_.pop_front();
        }
    }
    [[nodiscard]] double perSecond() const {
        if (samples_.size() < 2) return 0.0;
        const auto& [fromS, from] = samples_.front();
        const auto& [toS, to] = samples_.back();
        return toS > fromS ? static_cast<double>(to - from) / (toS - fromS) : 0.0;
    }
    void clear() { samples_.clear(); }

private:
    static constexpr double kWindowSeconds = 1.0;
    std::deque<std::pair<double, uint64_t>> samples_;
};

}  // namespace pagoda::viewer
