#include "hlod/build/simplify.h"
#include "hlod/build/surface_distance.h"
#include "ooc/base/hash.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pagoda::hlod {
namespace {

// Samples a direction: a measurement, not a bound. 4096 a node cost
// about as much as the simplification itself.
constexpr size_t kMaxSamples = 4096;
constexpr size_t kScoutStride = 61;

using Corners = std::array<Vec3i, 3>;

// Corners in rising order: what is measured must not depend on which of them a codec put first.
Corners sortedCorners(Corners corners) {
    const auto less = [](const Vec3i& a, const Vec3i& b) {
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    };
    if (less(corners[1], corners[0])) std::swap(corners[0], corners[1]);
    if (less(corners[2], corners[1])) std::swap(corners[1], corners[2]);
    if (less(corners[1], corners[0])) std::swap(corners[0], corners[1]);
    return corners;
}

struct LocalMesh {
    std::vector<Vec3f> positions;  // 3 a triangle
    std::vector<uint32_t> indices;
    std::vector<uint32_t> chosen;  // triangles to sample
};

// Which triangles are sampled follows from their corners, not from their place in a list: the
// pages of a finished database hold them in another order than the builder had them in, and
// `verify --deep` must find the same distance.
LocalMesh localMesh(std::span<const SoupTriangle> triangles, const Vec3i& origin) {
    LocalMesh mesh;
    mesh.positions.reserve(triangles.size() * 3);
    const size_t wanted = kMaxSamples / 2;  // two samples each
    const uint64_t last =
        triangles.size() <= wanted ? UINT64_MAX : UINT64_MAX / triangles.size() * wanted;
    for (uint32_t i = 0; i < triangles.size(); ++i) {
        const Corners corners = sortedCorners(triangles[i].corners);
        if (hash64(std::as_bytes(std::span(corners))) <= last) mesh.chosen.push_back(i);
        for (const Vec3i& corner : corners) {
            mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(Vec3f(corner - origin));
        }
    }
    return mesh;
}

// Centroids and least corners of the chosen triangles of `from`: points inside faces and at
// vertices.
double oneWay(const LocalMesh& from, const SurfaceDistance& to) {
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
    for (size_t i = 0; i < from.chosen.size(); i += kScoutStride) sample(from.chosen[i]);
    for (const uint32_t i : from.chosen) sample(i);
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
