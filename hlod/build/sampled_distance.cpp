#include "hlod/build/simplify.h"
#include "hlod/build/surface_distance.h"

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

// Samples a direction. The bound of the builder's own issue replaces sampling; 4096 a node cost
// about as much as the simplification itself.
constexpr size_t kMaxSamples = 4096;
constexpr size_t kScoutStride = 61;

struct LocalMesh {
    std::vector<Vec3f> positions;  // 3 a triangle
    std::vector<uint32_t> indices;
};

LocalMesh localMesh(std::span<const SoupTriangle> triangles, const Vec3i& origin) {
    LocalMesh mesh;
    mesh.positions.reserve(triangles.size() * 3);
    for (const SoupTriangle& triangle : triangles) {
        for (const Vec3i& corner : triangle.corners) {
            mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(Vec3f(corner - origin));
        }
    }
    return mesh;
}

// Centroids and first corners of evenly chosen triangles of `from`: points inside faces and at
// vertices.
double oneWay(const LocalMesh& from, const SurfaceDistance& to) {
    const size_t count = from.positions.size() / 3;
    const size_t stride = std::max<size_t>(1, 2 * count / kMaxSamples);
    float largest = 0;
    uint32_t near = 0;
    const auto sample = [&](size_t i) {
        const Vec3f& a = from.positions[3 * i];
        const Vec3f centroid = (a + from.positions[3 * i + 1] + from.positions[3 * i + 2]) / 3.0f;
        largest = std::max(largest, to.squaredDistance(centroid, near, largest));
        largest = std::max(largest, to.squaredDistance(a, near, largest));
    };
    // A few spread over all find a great distance early: after them most samples end at their first
    // guess.
    for (size_t i = 0; i < count; i += stride * kScoutStride) sample(i);
    for (size_t i = 0; i < count; i += stride) sample(i);
    return std::sqrt(static_cast<double>(largest));
}

}  // namespace

double sampledDistance(std::span<const SoupTriangle> fine, std::span<const SoupTriangle> coarse,
                       const Vec3i& origin) {
    const LocalMesh fineMesh = localMesh(fine, origin), coarseMesh = localMesh(coarse, origin);
    const SurfaceDistance toFine(fineMesh.positions, fineMesh.indices);
    const SurfaceDistance toCoarse(coarseMesh.positions, coarseMesh.indices);
    return std::max(oneWay(fineMesh, toCoarse), oneWay(coarseMesh, toFine));
}

}  // namespace pagoda::hlod
