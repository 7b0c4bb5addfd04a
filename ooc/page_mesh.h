// page_mesh.h: one node's mesh, decoded: what the builder makes, a page holds and the GPU draws.
#pragma once

#include "ooc/base/box.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pagoda::ooc {

// Normals as octahedral coordinates, snorm8 each. (0, -128) in y says "none": shade the triangle
// flat.
struct OctNormal {
    int8_t u = 0, v = -128;
    [[nodiscard]] bool operator==(const OctNormal&) const = default;
    [[nodiscard]] bool isNone() const { return v == -128; }
};
[[nodiscard]] OctNormal encodeNormal(const Vec3f& unit);  // none for a zero or non-finite vector
[[nodiscard]] Vec3f decodeNormal(OctNormal normal);       // zero for none

// Consecutive triangles of one object and one material, within one child part.
struct MeshRun {
    uint32_t triangleCount = 0;
    uint32_t object = 0;
    uint32_t material = 0;
    [[nodiscard]] bool operator==(const MeshRun&) const = default;
};

// Parts a page's triangles are sorted by: the 8 octants of the node's cell, opaque ones first, then
// the 8 octants' translucent ones; partStart[p] is the first triangle of part p, partStart[16]
// their number. Any part may be drawn alone.
inline constexpr int kPageParts = 16;

struct PageMesh {
    std::vector<Vec3i> positions;  // lattice points of the database, not relative
    std::vector<uint32_t>
        colours;  // a vertex, RGBA8 sRGB, red in the low byte; empty: constantColour
    uint32_t constantColour = 0xFFFFFFFFu;
    std::vector<OctNormal> normals;  // a vertex; empty: every triangle is shaded flat
    std::vector<uint32_t> indices;   // 3 a triangle, < positions.size()
    std::vector<MeshRun> runs;       // their triangle counts sum to triangleCount()
    std::array<uint32_t, kPageParts + 1> partStart{};

    [[nodiscard]] uint32_t triangleCount() const {
        return static_cast<uint32_t>(indices.size() / 3);
    }
    [[nodiscard]] uint32_t vertexCount() const { return static_cast<uint32_t>(positions.size()); }
    [[nodiscard]] uint32_t opaqueTriangleCount() const { return partStart[8]; }
    [[nodiscard]] Box3i box() const;
    [[nodiscard]] bool operator==(const PageMesh&) const = default;
};

// Triangles joining two nodes of which exactly one is refined. Empty while borders are
// locked.
struct Zipper {
    uint64_t neighbour = 0;  // NodeId::value
    std::vector<Vec3i> positions;
    std::vector<uint32_t> indices;
    [[nodiscard]] bool operator==(const Zipper&) const = default;
};

}  // namespace pagoda::ooc
