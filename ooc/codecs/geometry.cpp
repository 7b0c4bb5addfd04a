#include "ooc/codecs/geometry.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cassert>
#include <limits>

namespace pagoda::ooc {
namespace {

enum GeometryFlags : uint32_t { kColours = 1, kNormals = 2, kWidePositions = 4, kWideIndices = 8 };
constexpr uint32_t kKnownGeometryFlags = 15;

// Of one vertex in the interleaved stream of `meshopt`: position, normal, padding to 4, colour.
struct VertexLayout {
    size_t positionBytes, normalOffset, colourOffset, strideBytes;

    explicit VertexLayout(const GeometryHead& head) {
        positionBytes = head.isWide ? 12 : 6;
        normalOffset = positionBytes;
        colourOffset = (positionBytes + (head.hasNormals ? 2u : 0u) + 3u) & ~size_t{3};
        strideBytes = colourOffset + (head.hasColours ? 4u : 0u);
    }
};

// A lattice point minus the origin; in range because the origin is the least corner.
uint32_t relative(int32_t value, int32_t origin) {
    return static_cast<uint32_t>(static_cast<int64_t>(value) - origin);
}

template <typename Stored>
void putPositions(const GeometryView& geometry, const Vec3i& origin, ByteWriter& out) {
    std::vector<Stored> stored(geometry.positions.size() * 3);
    size_t next = 0;
    for (const Vec3i& position : geometry.positions) {
        for (int axis = 0; axis < 3; ++axis) {
            stored[next++] = static_cast<Stored>(relative(position[axis], origin[axis]));
        }
    }
    out.putArray(std::span<const Stored>(stored));
}

// False when origin + stored leaves 32 bits.
template <typename Stored>
bool toPosition(const std::byte* bytes, const Vec3i& origin, Vec3i& position) {
    Stored stored[3];
    std::memcpy(stored, bytes, sizeof stored);
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t value = static_cast<int64_t>(origin[axis]) + stored[axis];
        if (value > std::numeric_limits<int32_t>::max()) return false;
        position[axis] = static_cast<int32_t>(value);
    }
    return true;
}

void encodeRaw(const GeometryView& geometry, const GeometryHead& head, ByteWriter& out) {
    if (head.isWide) {
        putPositions<uint32_t>(geometry, head.origin, out);
    } else {
        putPositions<uint16_t>(geometry, head.origin, out);
    }
    out.putArray(geometry.colours);
    out.putArray(geometry.normals);
    if (head.hasWideIndices) {
        out.putArray(geometry.indices);
    } else {
        const std::vector<uint16_t> narrow = [&] {
            std::vector<uint16_t> values(geometry.indices.size());
            std::transform(geometry.indices.begin(), geometry.indices.end(), values.begin(),
                           [](uint32_t index) { return static_cast<uint16_t>(index); });
            return values;
        }();
        out.putArray(std::span<const uint16_t>(narrow));
    }
}

std::string decodeRaw(ByteReader& in, const GeometryHead& head, Geometry& out) {
    const uint64_t vertexBytes =
        (head.isWide ? 12u : 6u) + (head.hasColours ? 4u : 0u) + (head.hasNormals ? 2u : 0u);
    const uint64_t indexBytes = head.hasWideIndices ? 4 : 2;
    const uint64_t needed =
        head.vertexCount * vertexBytes + uint64_t{head.triangleCount} * 3 * indexBytes;
    if (needed > in.remaining()) {
        return std::to_string(needed) + " bytes of geometry announced, " +
               std::to_string(in.remaining()) + " there";
    }
    const size_t pointBytes = head.isWide ? 12 : 6;
    const std::span<const std::byte> points = in.getBytes(head.vertexCount * pointBytes);
    out.positions.resize(head.vertexCount);
    for (size_t i = 0; i < out.positions.size(); ++i) {
        const std::byte* bytes = points.data() + i * pointBytes;
        const bool isGood = head.isWide
                                ? toPosition<uint32_t>(bytes, head.origin, out.positions[i])
                                : toPosition<uint16_t>(bytes, head.origin, out.positions[i]);
        if (!isGood) return "position of vertex " + std::to_string(i) + " leaves 32 bits";
    }
    out.colours.resize(head.hasColours ? head.vertexCount : 0);
    in.getArray(std::span(out.colours));
    out.normals.resize(head.hasNormals ? head.vertexCount : 0);
    in.getArray(std::span(out.normals));
    out.indices.resize(size_t{head.triangleCount} * 3);
    if (head.hasWideIndices) {
        in.getArray(std::span(out.indices));
    } else {
        for (uint32_t& index : out.indices) index = in.get<uint16_t>();
    }
    return {};
}

std::vector<std::byte> interleave(const GeometryView& geometry, const GeometryHead& head) {
    const VertexLayout layout(head);
    std::vector<std::byte> vertices(geometry.positions.size() * layout.strideBytes);
    for (size_t i = 0; i < geometry.positions.size(); ++i) {
        std::byte* vertex = vertices.data() + i * layout.strideBytes;
        for (int axis = 0; axis < 3; ++axis) {
            const uint32_t value = relative(geometry.positions[i][axis], head.origin[axis]);
            const size_t width = layout.positionBytes / 3;
            std::memcpy(vertex + static_cast<size_t>(axis) * width, &value, width);
        }
        if (head.hasNormals) std::memcpy(vertex + layout.normalOffset, &geometry.normals[i], 2);
        if (head.hasColours) std::memcpy(vertex + layout.colourOffset, &geometry.colours[i], 4);
    }
    return vertices;
}

// Version 1 packs better; the library writes version 0 unless told, and is told through a global.
void useIndexVersion1() {
    static const bool isSet = (meshopt_encodeIndexVersion(1), true);
    (void)isSet;
}

void encodeMeshopt(const GeometryView& geometry, const GeometryHead& head, ByteWriter& out) {
    const size_t strideBytes = VertexLayout(head).strideBytes;
    const std::vector<std::byte> vertices = interleave(geometry, head);
    std::vector<unsigned char> vertexStream, indexStream;
    if (head.vertexCount > 0) {
        vertexStream.resize(meshopt_encodeVertexBufferBound(head.vertexCount, strideBytes));
        vertexStream.resize(meshopt_encodeVertexBuffer(vertexStream.data(), vertexStream.size(),
                                                       vertices.data(), head.vertexCount,
                                                       strideBytes));
    }
    if (head.triangleCount > 0) {
        useIndexVersion1();
        indexStream.resize(
            meshopt_encodeIndexBufferBound(geometry.indices.size(), head.vertexCount));
        indexStream.resize(meshopt_encodeIndexBuffer(indexStream.data(), indexStream.size(),
                                                     geometry.indices.data(),
                                                     geometry.indices.size()));
    }
    out.put(static_cast<uint32_t>(vertexStream.size()));
    out.put(static_cast<uint32_t>(indexStream.size()));
    out.putBytes(std::as_bytes(std::span(vertexStream)));
    out.putBytes(std::as_bytes(std::span(indexStream)));
}

std::string deinterleave(std::span<const std::byte> vertices, const GeometryHead& head,
                         Geometry& out) {
    const VertexLayout layout(head);
    out.positions.resize(head.vertexCount);
    out.colours.resize(head.hasColours ? head.vertexCount : 0);
    out.normals.resize(head.hasNormals ? head.vertexCount : 0);
    for (size_t i = 0; i < head.vertexCount; ++i) {
        const std::byte* vertex = vertices.data() + i * layout.strideBytes;
        const bool isGood = head.isWide
                                ? toPosition<uint32_t>(vertex, head.origin, out.positions[i])
                                : toPosition<uint16_t>(vertex, head.origin, out.positions[i]);
        if (!isGood) return "position of vertex " + std::to_string(i) + " leaves 32 bits";
        if (head.hasNormals) std::memcpy(&out.normals[i], vertex + layout.normalOffset, 2);
        if (head.hasColours) std::memcpy(&out.colours[i], vertex + layout.colourOffset, 4);
    }
    return {};
}

std::string decodeMeshopt(ByteReader& in, const GeometryHead& head, Geometry& out) {
    const auto vertexStreamBytes = in.get<uint32_t>();
    const auto indexStreamBytes = in.get<uint32_t>();
    const std::span<const std::byte> vertexStream = in.getBytes(vertexStreamBytes);
    const std::span<const std::byte> indexStream = in.getBytes(indexStreamBytes);
    if (!in.isOk()) return "geometry streams cut short";

    // A vertex stream spends at least one byte on 64 (two bits for 16 bytes of each plane), an
    // index stream at least one on a triangle: a count beyond that is a lie, found before it costs
    // memory.
    const size_t strideBytes = VertexLayout(head).strideBytes;
    const uint64_t decodedBytes = uint64_t{head.vertexCount} * strideBytes;
    if (decodedBytes / 64 > vertexStreamBytes || head.triangleCount > indexStreamBytes) {
        return "more vertices or triangles announced than the streams can hold";
    }
    std::vector<std::byte> vertices(decodedBytes);
    const auto* vertexData = reinterpret_cast<const unsigned char*>(vertexStream.data());
    if (head.vertexCount > 0 &&
        meshopt_decodeVertexBuffer(vertices.data(), head.vertexCount, strideBytes, vertexData,
                                   vertexStreamBytes) != 0) {
        return "vertex stream does not decode";
    }
    if (std::string fault = deinterleave(vertices, head, out); !fault.empty()) return fault;

    out.indices.resize(size_t{head.triangleCount} * 3);
    const auto* indexData = reinterpret_cast<const unsigned char*>(indexStream.data());
    if (head.triangleCount > 0 &&
        meshopt_decodeIndexBuffer(out.indices.data(), out.indices.size(), sizeof(uint32_t),
                                  indexData, indexStreamBytes) != 0) {
        return "index stream does not decode";
    }
    return {};
}

}  // namespace

void GeometryHead::put(ByteWriter& out) const {
    out.put(vertexCount);
    out.put(triangleCount);
    out.put(static_cast<uint32_t>((hasColours ? kColours : 0u) | (hasNormals ? kNormals : 0u) |
                                  (isWide ? kWidePositions : 0u) |
                                  (hasWideIndices ? kWideIndices : 0u)));
    for (int axis = 0; axis < 3; ++axis) out.put(origin[axis]);
}

std::string GeometryHead::get(ByteReader& in) {
    vertexCount = in.get<uint32_t>();
    triangleCount = in.get<uint32_t>();
    const auto flags = in.get<uint32_t>();
    for (int axis = 0; axis < 3; ++axis) origin[axis] = in.get<int32_t>();
    if (!in.isOk()) return "geometry head cut short";
    if ((flags & ~kKnownGeometryFlags) != 0) return "unknown geometry flags";
    hasColours = (flags & kColours) != 0;
    hasNormals = (flags & kNormals) != 0;
    isWide = (flags & kWidePositions) != 0;
    hasWideIndices = (flags & kWideIndices) != 0;
    if (vertexCount > kMaxPageVertices) return std::to_string(vertexCount) + " vertices in a page";
    if (triangleCount > kMaxPageTriangles) {
        return std::to_string(triangleCount) + " triangles in a page";
    }
    return {};
}

GeometryHead headOf(const GeometryView& geometry) {
    assert(geometry.positions.size() <= kMaxPageVertices);
    assert(geometry.indices.size() <= size_t{kMaxPageTriangles} * 3);
    GeometryHead head;
    head.vertexCount = static_cast<uint32_t>(geometry.positions.size());
    head.triangleCount = static_cast<uint32_t>(geometry.indices.size() / 3);
    head.hasColours = !geometry.colours.empty();
    head.hasNormals = !geometry.normals.empty();
    head.hasWideIndices = head.vertexCount > 65536;
    Box3i box;
    for (const Vec3i& position : geometry.positions) box.extend(position);
    if (box.isEmpty()) return head;
    head.origin = box.min;
    for (int axis = 0; axis < 3; ++axis) {
        if (relative(box.max[axis], box.min[axis]) > 0xFFFFu) head.isWide = true;
    }
    return head;
}

std::string checkIndices(std::span<const uint32_t> indices, size_t vertexCount) {
    const auto bad = std::find_if(indices.begin(), indices.end(),
                                  [&](uint32_t index) { return index >= vertexCount; });
    if (bad == indices.end()) return {};
    return "index " + std::to_string(*bad) + " of " + std::to_string(vertexCount) + " vertices";
}

void encodeGeometry(const GeometryView& geometry, Codec codec, ByteWriter& out) {
    const GeometryHead head = headOf(geometry);
    head.put(out);
    if (codec == Codec::Meshopt) {
        encodeMeshopt(geometry, head, out);
    } else {
        encodeRaw(geometry, head, out);
    }
}

std::string decodeGeometry(ByteReader& in, Codec codec, Geometry& out) {
    GeometryHead head;
    if (std::string fault = head.get(in); !fault.empty()) return fault;
    std::string fault =
        codec == Codec::Meshopt ? decodeMeshopt(in, head, out) : decodeRaw(in, head, out);
    if (fault.empty()) fault = checkIndices(out.indices, out.positions.size());
    return fault;
}

}  // namespace pagoda::ooc
