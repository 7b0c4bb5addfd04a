// geometry.h: vertices and triangles as bytes, for the codecs `raw` and `meshopt`; the part that
// mesh and zipper sections share. Bytes: ooc/FORMAT.md, "Geometry". Used by page_codec.cpp only.
#pragma once

#include "ooc/base/bytes.h"
#include "ooc/codecs/page_codec.h"

#include <span>
#include <string>
#include <vector>

namespace pagoda::ooc {

// No page may say that it holds more: what a count may make us allocate is bounded by this and by
// the bytes that back it.
inline constexpr uint32_t kMaxPageTriangles = 1u << 26;
inline constexpr uint32_t kMaxPageVertices = 1u << 26;

struct GeometryView {
    std::span<const Vec3i> positions;
    std::span<const uint32_t> colours;   // empty, or one a vertex
    std::span<const OctNormal> normals;  // empty, or one a vertex
    std::span<const uint32_t> indices;
};

struct Geometry {
    std::vector<Vec3i> positions;
    std::vector<uint32_t> colours;
    std::vector<OctNormal> normals;
    std::vector<uint32_t> indices;
};

// `codec` is Raw or Meshopt. Keeps the order of vertices and triangles.
void encodeGeometry(const GeometryView& geometry, Codec codec, ByteWriter& out);

// Returns what is wrong, empty when `out` is whole. Reads no further than its own bytes.
[[nodiscard]] std::string decodeGeometry(ByteReader& in, Codec codec, Geometry& out);

// The head that every geometry begins with, whatever the codec.
struct GeometryHead {
    uint32_t vertexCount = 0, triangleCount = 0;
    bool hasColours = false, hasNormals = false, isWide = false, hasWideIndices = false;
    Vec3i origin{0};  // added to every position

    void put(ByteWriter& out) const;
    // Returns what is wrong; counts are within the limits above afterwards.
    [[nodiscard]] std::string get(ByteReader& in);
};
[[nodiscard]] GeometryHead headOf(const GeometryView& geometry);

// "index 70000 of 12 vertices" for the first index out of range, or empty.
[[nodiscard]] std::string checkIndices(std::span<const uint32_t> indices, size_t vertexCount);

}  // namespace pagoda::ooc
