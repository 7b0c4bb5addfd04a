#include "hlod/build/simplify.h"
#include "hlod/build/vertex_table.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

// What makes a vertex of its own for the simplifier: at edges where these differ, meshoptimizer
// sees a seam of two wedges (collapsed on both sides at once) or locks the vertex.
struct TopologyKey {
    Vec3i position;
    uint32_t object, material, colour;

    [[nodiscard]] bool operator==(const TopologyKey&) const = default;
    [[nodiscard]] uint64_t hash() const {
        uint64_t h = mixHash(0x2545F491, static_cast<uint32_t>(position.x));
        h = mixHash(h, static_cast<uint32_t>(position.y) |
                           (uint64_t{static_cast<uint32_t>(position.z)} << 32));
        return mixHash(mixHash(h, object | (uint64_t{material} << 32)), colour);
    }
};

struct Topology {
    std::vector<uint32_t> indices;  // 3 a triangle, into keys
    VertexTable<TopologyKey> vertices;
    std::vector<Vec3f> faceNormals;     // unit, a triangle
    std::vector<uint32_t> cornerStart;  // a vertex: where its corners begin in `corners`
    std::vector<uint32_t> corners;      // corner numbers (3 * triangle + corner), by vertex
};

Vec3f faceNormal(const std::array<Vec3i, 3>& corners) {
    const Vec3d normal = glm::cross(Vec3d(corners[1] - corners[0]), Vec3d(corners[2] - corners[0]));
    const double length = glm::length(normal);
    return length > 0 ? Vec3f(normal / length) : Vec3f(0.0f);
}

Topology makeTopology(std::span<const SoupTriangle> triangles) {
    Topology topology;
    topology.vertices.reset(triangles.size() * 3);
    for (const SoupTriangle& triangle : triangles) {
        for (size_t corner = 0; corner < 3; ++corner) {
            topology.indices.push_back(
                topology.vertices.add({triangle.corners[corner], triangle.object, triangle.material,
                                       triangle.colours[corner]}));
        }
        topology.faceNormals.push_back(faceNormal(triangle.corners));
    }
    const size_t vertexCount = topology.vertices.keys().size();
    topology.cornerStart.assign(vertexCount + 1, 0);
    for (const uint32_t vertex : topology.indices) ++topology.cornerStart[vertex + 1];
    for (size_t i = 0; i < vertexCount; ++i) topology.cornerStart[i + 1] += topology.cornerStart[i];
    topology.corners.resize(topology.indices.size());
    std::vector<uint32_t> fill(topology.cornerStart.begin(), topology.cornerStart.end() - 1);
    for (uint32_t corner = 0; corner < topology.indices.size(); ++corner) {
        topology.corners[fill[topology.indices[corner]]++] = corner;
    }
    return topology;
}

// The source corner at `vertex` whose triangle faces most like `normal`.
uint32_t bestCorner(const Topology& topology, uint32_t vertex, const Vec3f& normal) {
    uint32_t best = topology.corners[topology.cornerStart[vertex]];
    float bestCosine = -2;
    for (uint32_t i = topology.cornerStart[vertex]; i < topology.cornerStart[vertex + 1]; ++i) {
        const float cosine = glm::dot(topology.faceNormals[topology.corners[i] / 3], normal);
        if (cosine > bestCosine) {
            bestCosine = cosine;
            best = topology.corners[i];
        }
    }
    return best;
}

// A triangle is shaded flat or smoothly, never half: corners without a normal take the face's.
void mendNormals(SoupTriangle& triangle, const Vec3f& normal, uint64_t& bentWedges) {
    const bool anyNormal = std::any_of(triangle.normals.begin(), triangle.normals.end(),
                                       [](ooc::OctNormal n) { return !n.isNone(); });
    if (!anyNormal) return;
    for (ooc::OctNormal& stored : triangle.normals) {
        if (stored.isNone()) {
            stored = ooc::encodeNormal(normal);
        } else if (std::abs(glm::dot(ooc::decodeNormal(stored), normal)) < 0.5f) {
            ++bentWedges;
        }
    }
}

}  // namespace

SimplifyResult collapseEdges(const SimplifyRequest& request) {
    const Topology topology = makeTopology(request.triangles);
    const std::vector<TopologyKey>& keys = topology.vertices.keys();
    std::vector<Vec3f> positions(keys.size());
    for (size_t i = 0; i < keys.size(); ++i)
        positions[i] = Vec3f(keys[i].position - request.cell.origin);

    std::vector<uint32_t> indices(topology.indices.size());
    constexpr float kAnyError = 1e6f;  // the target decides, not the error
    const size_t count = meshopt_simplify(
        indices.data(), topology.indices.data(), topology.indices.size(), &positions[0].x,
        positions.size(), sizeof(Vec3f), size_t{request.targetTriangles} * 3, kAnyError,
        meshopt_SimplifyLockBorder, nullptr);
    SimplifyResult result;
    result.triangles.reserve(count / 3);
    for (size_t i = 0; i < count; i += 3) {
        SoupTriangle triangle;
        for (size_t corner = 0; corner < 3; ++corner) {
            triangle.corners[corner] = keys[indices[i + corner]].position;
        }
        if (triangle.corners[0] == triangle.corners[1] ||
            triangle.corners[1] == triangle.corners[2] ||
            triangle.corners[2] == triangle.corners[0]) {
            continue;  // its edges cancel; a needle with three corners must stay, or its edges
                       // would open
        }
        const Vec3f normal = faceNormal(triangle.corners);
        triangle.object = keys[indices[i]].object;
        triangle.material = keys[indices[i]].material;
        for (size_t corner = 0; corner < 3; ++corner) {
            const uint32_t source = bestCorner(topology, indices[i + corner], normal);
            triangle.colours[corner] = keys[indices[i + corner]].colour;
            triangle.normals[corner] = request.triangles[source / 3].normals[source % 3];
        }
        mendNormals(triangle, normal, result.bentWedges);
        result.triangles.push_back(triangle);
    }
    result.isStuck =
        result.triangles.size() > request.targetTriangles + request.targetTriangles / 8;
    return result;
}

}  // namespace pagoda::hlod
