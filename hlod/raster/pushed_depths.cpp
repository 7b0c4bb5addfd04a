#include "hlod/raster/pushed_depths.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace pagoda::hlod {

float depthPush(double errorModelUnits, double nearModelUnits) {
    const double push = errorModelUnits / nearModelUnits;
    const auto rounded = static_cast<float>(push);
    return static_cast<double>(rounded) < push
               ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
               : rounded;
}

void pushDepths(std::span<float> depths, std::span<const uint32_t> nodeOrdinals,
                std::span<const float> pushes) {
    assert(depths.size() == nodeOrdinals.size());
    for (size_t i = 0; i < depths.size(); ++i) {
        assert(nodeOrdinals[i] < pushes.size());
        const double push = static_cast<double>(pushes[nodeOrdinals[i]]);
        if (!(push > 0.0)) continue;
        // near / (near / depth + error)
        const double depth = static_cast<double>(depths[i]);
        const double pushed = depth / (1.0 + depth * push);
        depths[i] = static_cast<float>(pushed);
        if (static_cast<double>(depths[i]) > pushed) depths[i] = std::nextafter(depths[i], 0.0f);
    }
}

}  // namespace pagoda::hlod
