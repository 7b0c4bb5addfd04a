// float_exact.h: whether a double is a float. By its bits, not by converting there and back:
// g++ 12.2 at -O2 drops double -> float -> double where it handles two coordinates at once (its SLP
// vectorizer; seen with glm::dvec3(glm::vec3(p))), and would call every coordinate a float.
#pragma once

#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>

namespace pagoda::ooc {

[[nodiscard]] inline bool isFloatExact(double value) {
    constexpr uint64_t kBeyondFloat = (uint64_t{1} << 29) - 1;  // mantissa bits a float lacks
    if ((std::bit_cast<uint64_t>(value) & kBeyondFloat) != 0) return false;
    const double size = std::abs(value);
    return size == 0 || (size >= FLT_MIN && size <= FLT_MAX);
}

}  // namespace pagoda::ooc
