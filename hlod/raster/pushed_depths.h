// pushed_depths.h: depths moved away from the eye by the errors of the nodes that drew them. What a
// simplified surface hides, the full model may show: it lies up to the node's error farther away.
// A box that is hidden behind pushed depths is hidden by the full model as well, along each pixel's
// own ray; sideways, at the outlines of occluders, the error stays (up to its pixels on the
// screen). Pure functions.
#pragma once

#include <cstdint>
#include <span>

namespace pagoda::hlod {

// What a node's error does to its reversed depths (near / depth along the view): error over near,
// rounded up.
[[nodiscard]] float depthPush(double errorModelUnits, double nearModelUnits);

// Lowers each reversed depth as if it lay so much farther, rounded outwards. `pushes` by node
// ordinal, that of 0 (no node) first; `nodeOrdinals` as many as `depths`, each below its size.
void pushDepths(std::span<float> depths, std::span<const uint32_t> nodeOrdinals,
                std::span<const float> pushes);

}  // namespace pagoda::hlod
