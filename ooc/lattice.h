// lattice.h: the one integer grid on which all geometry of a database lies.
// Positions are integers from here on: equal positions are equal integers, and float never decides
// topology. The step is a power of two and the origin a multiple of it, so that
// origin + point * step is exact in double. docs/build.md, step 2.
#pragma once

#include "ooc/base/box.h"

#include <cmath>
#include <cstdint>

namespace pagoda::ooc {

// Lattice points lie in [0, 2^extentBits] on every axis.
inline constexpr int kMaxExtentBits = 30;

struct Lattice {
    Vec3d origin{0.0};     // model units of lattice point (0,0,0)
    int stepExponent = 0;  // step = 2^stepExponent model units
    int extentBits = 0;    // the root cell is [0, 2^extentBits)^3; 1..kMaxExtentBits

    [[nodiscard]] double step() const { return std::ldexp(1.0, stepExponent); }
    [[nodiscard]] Vec3d toModel(const Vec3i& point) const { return origin + Vec3d(point) * step(); }
    // Nearest lattice point; `position` lies in the surveyed bounds.
    [[nodiscard]] Vec3i snap(const Vec3d& position) const {
        const Vec3d scaled = (position - origin) * std::ldexp(1.0, -stepExponent);
        return {static_cast<int32_t>(std::floor(scaled.x + 0.5)),
                static_cast<int32_t>(std::floor(scaled.y + 0.5)),
                static_cast<int32_t>(std::floor(scaled.z + 0.5))};
    }
    [[nodiscard]] Box3d toModel(const Box3i& box) const {
        return {toModel(box.min), toModel(box.max)};
    }
    [[nodiscard]] bool operator==(const Lattice&) const = default;
};

}  // namespace pagoda::ooc
