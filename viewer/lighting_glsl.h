// lighting_glsl.h: how a surface is lit, for every fragment shader that draws one: text to stand
// behind its #version line.
#pragma once

namespace pagoda::viewer {

// The light is part of the camera (a headlight, a little above and to the left, so that faces which
// meet at an edge differ) plus a sky that is brighter than the ground. Contrast is moderate on
// purpose: a coarse node shaded flat must look like the fine one that it stands for.
// float lightOn(vec3 n, vec3 towardsEye): `n` need not have unit length, and may be zero.
inline constexpr const char* kLightingGlsl = R"(
layout(location = 5) uniform vec3 towardsLight;  // added to the direction to the eye
layout(location = 6) uniform vec3 worldUp;

float lightOn(vec3 n, vec3 towardsEye) {
    float square = dot(n, n);
    n = square > 0.0 ? n * inversesqrt(square) : towardsEye;
    if (dot(n, towardsEye) < 0.0) n = -n;
    float lamp = max(dot(n, normalize(towardsEye + towardsLight)), 0.0);
    float sky = 0.5 + 0.5 * dot(n, worldUp);
    return 0.14 + 0.26 * sky + 0.54 * lamp;
}
)";

// Of its two uniforms: towardsLight is this, of the camera's unit vectors up and right.
template <typename Vec3>
[[nodiscard]] Vec3 towardsLightOf(const Vec3& up, const Vec3& right) {
    using Scalar = typename Vec3::value_type;
    return Scalar(0.35) * up - Scalar(0.25) * right;
}

}  // namespace pagoda::viewer
