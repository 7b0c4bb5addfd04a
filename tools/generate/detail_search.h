// detail_search.h: at which detail a scene has the number of triangles asked for.
#pragma once

#include "ooc/base/error.h"
#include "tools/generate/scene_kit.h"

#include <cmath>
#include <cstdint>
#include <string>

namespace pagoda::tools {

// `build` makes the whole scene with the kit it is given; run about 25 times without a sink. Throws
// Error when even the least detail has far too many triangles.
template <typename Build>
[[nodiscard]] double findDetail(uint64_t wanted, const char* scene, Build&& build) {
    const auto countAt = [&](double detail) {
        SceneKit counting(nullptr, detail);
        build(counting);
        return counting.triangleCount();
    };
    double low = 0.004, high = 64.0;
    const uint64_t least = countAt(low);
    if (least > wanted + wanted / 20) {
        throw Error("", "",
                    std::string(scene) + " needs at least " + std::to_string(least) + " triangles",
                    "raise --triangles");
    }
    double best = low, bestMiss = HUGE_VAL;
    for (int step = 0; step < 26; ++step) {
        const double middle = std::sqrt(low * high);
        const double count = static_cast<double>(countAt(middle));
        const double miss = std::abs(count - static_cast<double>(wanted));
        if (miss < bestMiss) bestMiss = miss, best = middle;
        if (miss < 0.002 * static_cast<double>(wanted)) break;
        (count < static_cast<double>(wanted) ? low : high) = middle;
    }
    return best;
}

}  // namespace pagoda::tools
