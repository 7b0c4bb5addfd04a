#include "hlod/build/assemble.h"

#include "hlod/build/vertex_table.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <numeric>

namespace pagoda::hlod {
namespace {

struct Wedge {
    Vec3i position;
    uint32_t colour;
    ooc::OctNormal normal;

    [[nodiscard]] bool operator==(const Wedge&) const = default;
    [[nodiscard]] uint64_t hash() const {
        uint64_t h = mixHash(0x51ED270B, static_cast<uint32_t>(position.x));
        h = mixHash(h, static_cast<uint32_t>(position.y) |
                           (uint64_t{static_cast<uint32_t>(position.z)} << 32));
        return mixHash(h, colour | (uint64_t{static_cast<uint8_t>(normal.u)} << 32) |
                              (uint64_t{static_cast<uint8_t>(normal.v)} << 40));
    }
};

constexpr unsigned kCacheSize = 16;  // FIFO entries: ACMR within 0.5% of the slow one

uint32_t partOf(const SoupTriangle& triangle, const CellFrame& cell, bool isTranslucent) {
    const Vec3i point = centroidPoint(triangle.corners, cell.extentBits);
    return octantOf(point - cell.origin, cell.bits) + (isTranslucent ? 8 : 0);
}

// Triangles ordered for the vertex cache, then stably by part, material and object: neighbours
// mostly stay neighbours within a run.
std::vector<uint32_t> orderTriangles(std::span<const SoupTriangle> triangles,
                                     const std::vector<uint32_t>& indices, size_t vertexCount,
                                     const CellFrame& cell, const std::vector<bool>& isTranslucent,
                                     std::vector<uint32_t>& parts) {
    const size_t count = triangles.size();
    parts.resize(count);
    for (size_t i = 0; i < count; ++i) {
        parts[i] = partOf(triangles[i], cell, isTranslucent[triangles[i].material]);
    }
    // meshopt does not say where a triangle went, but its order of vertices does: a triangle
    // belongs where the last of its vertices first appears.
    std::vector<uint32_t> optimised(indices.size());
    meshopt_optimizeVertexCacheFifo(optimised.data(), indices.data(), indices.size(), vertexCount,
                                    kCacheSize);
    std::vector<uint32_t> rank(vertexCount, UINT32_MAX);
    uint32_t next = 0;
    for (const uint32_t vertex : optimised) {
        if (rank[vertex] == UINT32_MAX) rank[vertex] = next++;
    }
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::vector<uint32_t> key(count);
    for (size_t i = 0; i < count; ++i) {
        key[i] =
            std::max({rank[indices[3 * i]], rank[indices[3 * i + 1]], rank[indices[3 * i + 2]]});
    }
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        if (parts[a] != parts[b]) return parts[a] < parts[b];
        if (triangles[a].material != triangles[b].material) {
            return triangles[a].material < triangles[b].material;
        }
        if (triangles[a].object != triangles[b].object)
            return triangles[a].object < triangles[b].object;
        return key[a] != key[b] ? key[a] < key[b] : a < b;
    });
    return order;
}

void fillRuns(std::span<const SoupTriangle> triangles, const std::vector<uint32_t>& order,
              const std::vector<uint32_t>& parts, ooc::PageMesh& mesh) {
    uint32_t lastPart = UINT32_MAX;
    std::array<uint32_t, ooc::kPageParts> perPart{};
    for (const uint32_t i : order) {
        const SoupTriangle& triangle = triangles[i];
        ++perPart[parts[i]];
        if (parts[i] != lastPart || mesh.runs.back().object != triangle.object ||
            mesh.runs.back().material != triangle.material) {
            mesh.runs.push_back({0, triangle.object, triangle.material});
            lastPart = parts[i];
        }
        ++mesh.runs.back().triangleCount;
    }
    std::partial_sum(perPart.begin(), perPart.end(), mesh.partStart.begin() + 1);
}

void fillVertices(const std::vector<Wedge>& wedges, const std::vector<uint32_t>& newToOld,
                  ooc::PageMesh& mesh) {
    const size_t count = newToOld.size();
    mesh.positions.resize(count);
    bool sameColour = true, hasNormals = false;
    for (size_t i = 0; i < count; ++i) {
        const Wedge& wedge = wedges[newToOld[i]];
        mesh.positions[i] = wedge.position;
        sameColour &= wedge.colour == wedges[newToOld[0]].colour;
        hasNormals |= !wedge.normal.isNone();
    }
    mesh.constantColour = wedges[newToOld[0]].colour;
    if (!sameColour) {
        mesh.constantColour = 0xFFFFFFFFu;
        mesh.colours.resize(count);
        for (size_t i = 0; i < count; ++i) mesh.colours[i] = wedges[newToOld[i]].colour;
    }
    if (hasNormals) {
        mesh.normals.resize(count);
        for (size_t i = 0; i < count; ++i) mesh.normals[i] = wedges[newToOld[i]].normal;
    }
}

}  // namespace

ooc::PageMesh assemblePage(std::span<const SoupTriangle> triangles, const CellFrame& cell,
                           const std::vector<bool>& isTranslucent) {
    VertexTable<Wedge> table;
    table.reset(triangles.size() * 3);
    std::vector<uint32_t> indices;
    indices.reserve(triangles.size() * 3);
    for (const SoupTriangle& triangle : triangles) {
        for (size_t corner = 0; corner < 3; ++corner) {
            indices.push_back(table.add(
                {triangle.corners[corner], triangle.colours[corner], triangle.normals[corner]}));
        }
    }
    const std::vector<Wedge>& wedges = table.keys();
    std::vector<uint32_t> parts;
    const std::vector<uint32_t> order =
        orderTriangles(triangles, indices, wedges.size(), cell, isTranslucent, parts);

    ooc::PageMesh mesh;
    fillRuns(triangles, order, parts, mesh);
    // Vertices in order of first use: what the index codec predicts and the GPU fetches best.
    std::vector<uint32_t> oldToNew(wedges.size(), UINT32_MAX), newToOld;
    newToOld.reserve(wedges.size());
    mesh.indices.reserve(indices.size());
    for (const uint32_t i : order) {
        for (size_t corner = 0; corner < 3; ++corner) {
            const uint32_t old = indices[3 * size_t{i} + corner];
            if (oldToNew[old] == UINT32_MAX) {
                oldToNew[old] = static_cast<uint32_t>(newToOld.size());
                newToOld.push_back(old);
            }
            mesh.indices.push_back(oldToNew[old]);
        }
    }
    fillVertices(wedges, newToOld, mesh);
    return mesh;
}

CellFrame cellFrame(ooc::NodeId cell, int extentBits) {
    CellFrame frame{
        .origin = Vec3i(0), .bits = extentBits - cell.depth(), .extentBits = extentBits};
    for (int level = 0; level < cell.depth(); ++level) {
        const auto octant = static_cast<uint32_t>(cell.path() >> (3 * level)) & 7u;
        for (int axis = 0; axis < 3; ++axis) {
            if (octant & (1u << axis)) frame.origin[axis] += 1 << (frame.bits + level);
        }
    }
    return frame;
}

std::vector<SoupTriangle> unpackPage(const ooc::PageMesh& mesh) {
    std::vector<SoupTriangle> triangles(mesh.triangleCount());
    size_t run = 0;
    uint32_t left = mesh.runs.empty() ? 0 : mesh.runs[0].triangleCount;
    for (size_t i = 0; i < triangles.size(); ++i) {
        while (left == 0) left = mesh.runs[++run].triangleCount;
        --left;
        triangles[i].object = mesh.runs[run].object;
        triangles[i].material = mesh.runs[run].material;
        for (size_t corner = 0; corner < 3; ++corner) {
            const uint32_t vertex = mesh.indices[3 * i + corner];
            triangles[i].corners[corner] = mesh.positions[vertex];
            triangles[i].colours[corner] =
                mesh.colours.empty() ? mesh.constantColour : mesh.colours[vertex];
            if (!mesh.normals.empty()) triangles[i].normals[corner] = mesh.normals[vertex];
        }
    }
    return triangles;
}

}  // namespace pagoda::hlod
