#include "viewer/lattice_view.h"

#include <algorithm>
#include <cmath>

namespace pagoda::viewer {
namespace {

// Points lie in [0, 2^30]. With the reference in this range point - reference fits an int32; an eye
// farther away is so far that float resolves the whole lattice alike from either.
constexpr double kMinReference = -1073741823.0;
constexpr double kMaxReference = 2147483647.0;

}  // namespace

LatticeView makeLatticeView(const hlod::View& view, const ooc::Lattice& lattice) {
    LatticeView result;
    const double step = lattice.step();
    const Vec3d eyeSteps = (view.eye() - lattice.origin) / step;
    for (int axis = 0; axis < 3; ++axis) {
        const double cell = std::clamp(std::floor(eyeSteps[axis]), kMinReference, kMaxReference);
        result.reference[axis] = static_cast<int64_t>(cell);
        result.eye[axis] = static_cast<float>(eyeSteps[axis] - cell);
    }
    result.rowX = Vec3f(view.right() / view.tanX());
    result.rowY = Vec3f(view.up() / view.tanY());
    result.rowW = Vec3f(view.forward());
    result.nearSteps = static_cast<float>(view.nearModelUnits() / step);
    result.up = Vec3f(view.up());
    result.right = Vec3f(view.right());
    if (const auto& section = view.clip().section) {
        result.hasSection = true;
        result.sectionNormal = Vec3f(section->normal);
        result.sectionReachSteps = static_cast<float>(-section->above(view.eye()) / step);
    }
    return result;
}

}  // namespace pagoda::viewer
