#include "hlod/build/surface_distance.h"

#include <gtest/gtest.h>

#include <random>

namespace pagoda::hlod {
namespace {

// Brute force by another route: the minimum over a fine barycentric grid bounds the distance from
// above, the plane and the three edges' distances from below.
double segmentDistance(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
    const Vec3d ab = b - a;
    const double t = std::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0, 1.0);
    return glm::distance(p, a + t * ab);
}

double triangleDistance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d n = glm::cross(b - a, c - a);
    const auto inside = [&](const Vec3d& u, const Vec3d& v) {
        return glm::dot(glm::cross(v - u, p - u), n) >= 0;
    };
    if (inside(a, b) && inside(b, c) && inside(c, a)) {
        return std::abs(glm::dot(p - a, n)) / glm::length(n);
    }
    return std::min({segmentDistance(p, a, b), segmentDistance(p, b, c), segmentDistance(p, c, a)});
}

TEST(SurfaceDistance, equalsTheLeastDistanceOverAllTriangles) {
    std::mt19937 random(3);
    const auto number = [&] { return static_cast<float>(random() % 10000) / 100.0f; };
    for (const uint32_t count : {1u, 3u, 5u, 400u}) {
        std::vector<Vec3f> positions;
        std::vector<uint32_t> indices;
        for (uint32_t i = 0; i < count; ++i) {
            const Vec3f base(number(), number(), number());
            for (int corner = 0; corner < 3; ++corner) {
                indices.push_back(static_cast<uint32_t>(positions.size()));
                positions.push_back(base + 0.1f * Vec3f(number(), number(), number()));
            }
        }
        const SurfaceDistance surface(positions, indices);
        uint32_t near = 0;
        for (int round = 0; round < 300; ++round) {
            const Vec3f point(number(), number(), number());
            double expected = 1e30;
            for (uint32_t i = 0; i < count; ++i) {
                expected =
                    std::min(expected, triangleDistance(Vec3d(point), Vec3d(positions[3 * i]),
                                                        Vec3d(positions[3 * i + 1]),
                                                        Vec3d(positions[3 * i + 2])));
            }
            const double got = std::sqrt(static_cast<double>(surface.squaredDistance(point, near)));
            ASSERT_NEAR(got, expected, 1e-3 + 1e-4 * expected);  // float coordinates up to 110
            ASSERT_LT(near, count);
        }
    }
}

}  // namespace
}  // namespace pagoda::hlod
