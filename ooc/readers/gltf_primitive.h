// gltf_primitive.h: one primitive of a mesh as a list of triangles in the mesh's own space.
#pragma once

#include "ooc/base/box.h"
#include "ooc/readers/gltf_accessor.h"
#include "ooc/readers/gltf_material.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace pagoda::ooc::gltf {

struct DecodedPrimitive {
    std::vector<Vec3d> positions;   // finite
    std::vector<Vec3f> normals;     // empty, or one a position, unit length
    std::vector<uint32_t> colours;  // empty (the material's), or one a position, RGBA8 sRGB
    std::vector<uint32_t> corners;  // three a triangle
    uint64_t indexOutOfRange = 0;   // triangles left out
    uint64_t nonFinite = 0;
    std::vector<std::string_view> ignored;  // constant phrases

    [[nodiscard]] uint64_t triangleCount() const { return corners.size() / 3; }
};

// Triangles that the JSON announces for a primitive: 0 for points and lines.
[[nodiscard]] uint64_t announcedTriangles(const tinygltf::Model& model,
                                          const tinygltf::Primitive& primitive);

class PrimitiveDecoder {
public:
    PrimitiveDecoder(const SourceFile& source, const Document& document, Buffers& buffers,
                     Materials& materials);

    // Decodes a triangle primitive. Memory in proportion to its triangles and to the vertices that
    // they use (not to accessors shared with others), taken from `lease`. Throws Error.
    [[nodiscard]] DecodedPrimitive decode(int mesh, size_t primitive, MemoryLease& lease);

private:
    const SourceFile& source_;
    const Document& document_;
    Buffers& buffers_;
    Materials& materials_;
};

}  // namespace pagoda::ooc::gltf
