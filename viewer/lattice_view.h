// lattice_view.h: a view in the lattice's own integers, so that equal lattice points give equal
// bits on the GPU. The camera's lattice cell is the reference. A page's
// offset from it is formed here in 64 bits; the shader adds the vertex's integers (exact: point -
// reference fits 32 bits), converts once to float, subtracts the eye's place relative to the
// reference and applies one matrix. Nothing in that depends on the page, so two nodes that share a
// lattice point draw it at the same bits, and no bit is lost to distance from the origin.
#pragma once

#include "hlod/view/camera.h"
#include "ooc/lattice.h"

namespace pagoda::viewer {

struct LatticeView {
    glm::i64vec3 reference{0};  // lattice point: the camera's cell, clamped so that differences fit
    Vec3f eye{0.0f};            // relative to the reference, in lattice steps
    // Rows that make clip x, y and w of a point relative to the eye; clip z is nearSteps for all.
    Vec3f rowX{0.0f}, rowY{0.0f}, rowW{0.0f};
    float nearSteps = 0.0f;
    Vec3f up{0.0f}, right{0.0f};  // of the camera, unit, for the light
    // Points relative to the eye with dot(normal, point) > reach are cut away (hlod::Clip).
    bool hasSection = false;
    Vec3f sectionNormal{0.0f};
    float sectionReachSteps = 0.0f;

    // What the shader adds to a vertex of a page whose positions are relative to `pageOrigin`.
    [[nodiscard]] Vec3i offsetOf(const Vec3i& pageOrigin) const {
        return {static_cast<int32_t>(pageOrigin.x - reference.x),
                static_cast<int32_t>(pageOrigin.y - reference.y),
                static_cast<int32_t>(pageOrigin.z - reference.z)};
    }
};

[[nodiscard]] LatticeView makeLatticeView(const hlod::View& view, const ooc::Lattice& lattice);

}  // namespace pagoda::viewer
