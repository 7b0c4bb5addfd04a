#include "ooc/codecs/draco_geometry.h"

#include "ooc/base/hash.h"

// Draco's headers are not ours to mend.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>

namespace pagoda::ooc {
namespace {

// Draco's unique attribute ids.
enum AttributeId : uint32_t { kPosition = 0, kColour = 1, kNormal = 2, kRun = 3 };

// A stream of Draco spends a byte or more on a triangle, seldom less; a count far beyond that is a
// lie. The decoder takes some hundred bytes a triangle on the word of the stream's own head.
constexpr uint64_t kMaxTrianglesPerByte = 8;

// 0 best and slowest to decode, 10 worst and fastest. 5 is the library's own default.
constexpr int kSpeed = 5;

// Draco's encoder keeps a table with a place for every value that a difference of positions can
// have: a box 2^30 steps long takes 8 GB and 12 s, of 2^20 it takes 8 MB and 10 ms.
constexpr uint32_t kMaxExtent = 1u << 20;

bool isSmall(const GeometryView& geometry) {
    Box3i box;
    for (const Vec3i& position : geometry.positions) box.extend(position);
    for (int axis = 0; axis < 3; ++axis) {
        if (int64_t{box.max[axis]} - box.min[axis] > kMaxExtent) return false;
    }
    return true;
}

void addAttribute(draco::Mesh& mesh, AttributeId id, draco::GeometryAttribute::Type type,
                  draco::DataType dataType, uint8_t components, size_t strideBytes,
                  const void* values) {
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, components, dataType, false, static_cast<int64_t>(strideBytes),
                   0);
    const int number = mesh.AddAttribute(attribute, true, mesh.num_points());
    mesh.attribute(number)->set_unique_id(id);
    const auto* bytes = static_cast<const std::byte*>(values);
    for (uint32_t i = 0; i < mesh.num_points(); ++i) {
        mesh.attribute(number)->SetAttributeValue(draco::AttributeValueIndex(i),
                                                  bytes + i * strideBytes);
    }
}

// A vertex as one run uses it: what Draco calls a point.
struct Point {
    uint32_t vertex = 0, run = 0;
    [[nodiscard]] auto operator<=>(const Point&) const = default;
};

// The points of the mesh and, a corner, which of them it is.
std::vector<Point> splitByRun(std::span<const uint32_t> indices, std::span<const MeshRun> runs,
                              std::vector<uint32_t>& corners) {
    std::vector<Point> atCorner;
    atCorner.reserve(indices.size());
    for (uint32_t run = 0; run < runs.size(); ++run) {
        for (size_t i = 0; i < size_t{runs[run].triangleCount} * 3; ++i) {
            atCorner.push_back({indices[atCorner.size()], run});
        }
    }
    std::vector<Point> points = atCorner;
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    corners.reserve(atCorner.size());
    for (const Point& point : atCorner) {
        corners.push_back(static_cast<uint32_t>(
            std::lower_bound(points.begin(), points.end(), point) - points.begin()));
    }
    return points;
}

template <typename Value>
std::vector<Value> gather(const std::vector<Point>& points, std::span<const Value> values) {
    std::vector<Value> gathered;
    gathered.reserve(points.size());
    for (const Point& point : points) gathered.push_back(values[point.vertex]);
    return gathered;
}

void fillMesh(const GeometryView& geometry, std::span<const MeshRun> runs, const Vec3i& origin,
              draco::Mesh& mesh) {
    std::vector<uint32_t> corners;
    const std::vector<Point> points = splitByRun(geometry.indices, runs, corners);
    mesh.set_num_points(static_cast<uint32_t>(points.size()));
    mesh.SetNumFaces(corners.size() / 3);
    for (uint32_t face = 0; face < corners.size() / 3; ++face) {
        const uint32_t* corner = corners.data() + 3 * size_t{face};
        mesh.SetFace(draco::FaceIndex(face),
                     {draco::PointIndex(corner[0]), draco::PointIndex(corner[1]),
                      draco::PointIndex(corner[2])});
    }
    std::vector<Vec3i> positions = gather(points, geometry.positions);
    for (Vec3i& position : positions) position -= origin;
    addAttribute(mesh, kPosition, draco::GeometryAttribute::POSITION, draco::DT_INT32, 3,
                 sizeof(Vec3i), positions.data());
    if (!geometry.colours.empty()) {
        addAttribute(mesh, kColour, draco::GeometryAttribute::COLOR, draco::DT_UINT8, 4, 4,
                     gather(points, geometry.colours).data());
    }
    if (!geometry.normals.empty()) {
        addAttribute(mesh, kNormal, draco::GeometryAttribute::GENERIC, draco::DT_INT8, 2, 2,
                     gather(points, geometry.normals).data());
    }
    if (runs.size() > 1) {
        std::vector<uint32_t> run;
        run.reserve(points.size());
        for (const Point& point : points) run.push_back(point.run);
        addAttribute(mesh, kRun, draco::GeometryAttribute::GENERIC, draco::DT_UINT32, 1, 4,
                     run.data());
    }
    mesh.DeduplicateAttributeValues();  // equal positions make one vertex of the connectivity
}

// Triangles with their run and all that their corners carry, in no order; rotation does not count.
OrderFreeSum fingerprint(const GeometryView& geometry, std::span<const MeshRun> runs) {
    OrderFreeSum sum;
    const uint32_t* index = geometry.indices.data();
    for (uint32_t run = 0; run < runs.size(); ++run) {
        for (uint32_t t = 0; t < runs[run].triangleCount; ++t, index += 3) {
            std::array<std::array<uint32_t, 5>, 3> corners{};
            for (size_t i = 0; i < 3; ++i) {
                const uint32_t v = index[i];
                for (int axis = 0; axis < 3; ++axis) {
                    corners[i][static_cast<size_t>(axis)] =
                        static_cast<uint32_t>(geometry.positions[v][axis]);
                }
                if (!geometry.colours.empty()) corners[i][3] = geometry.colours[v];
                if (!geometry.normals.empty()) {
                    std::memcpy(&corners[i][4], &geometry.normals[v], sizeof(OctNormal));
                }
            }
            std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()),
                        corners.end());
            const std::pair<decltype(corners), uint32_t> item{corners, run};
            sum.add(std::as_bytes(std::span(&item, 1)));
        }
    }
    return sum;
}

// Draco's head: what it will allocate for, before it does. Bytes 0..10 are magic, version, kind,
// method and flags; then come, for edgebreaker, the traversal's kind, vertices and faces.
std::string checkStreamHead(std::span<const std::byte> stream, const GeometryHead& head) {
    constexpr std::string_view kMagicAndVersion("DRACO\x02\x02", 7);
    ByteReader in(stream);
    const std::span<const std::byte> magic = in.getBytes(kMagicAndVersion.size());
    const auto kind = in.get<uint8_t>();
    const auto method = in.get<uint8_t>();
    const auto flags = in.get<uint16_t>();
    (void)in.get<uint8_t>();
    const uint32_t vertexCount = in.getVarint();
    const uint32_t faceCount = in.getVarint();
    if (!in.isOk()) return "Draco stream cut short";
    if (std::memcmp(magic.data(), kMagicAndVersion.data(), magic.size()) != 0) {
        return "not a Draco 2.2 stream";
    }
    if (kind != draco::TRIANGULAR_MESH || method != draco::MESH_EDGEBREAKER_ENCODING ||
        flags != 0) {
        return "not an edgebreaker mesh";
    }
    if (faceCount != head.triangleCount || vertexCount > uint64_t{faceCount} * 3) {
        return "Draco stream of another size than announced";
    }
    if (faceCount > stream.size() * kMaxTrianglesPerByte) {
        return "more triangles announced than the stream can hold";
    }
    return {};
}

bool isOfKind(const draco::PointAttribute* attribute, draco::DataType type, int components) {
    return attribute != nullptr && attribute->data_type() == type &&
           attribute->num_components() == components;
}

std::string checkAttributes(const draco::Mesh& mesh, const GeometryHead& head, size_t runCount) {
    const auto at = [&](AttributeId id) { return mesh.GetAttributeByUniqueId(id); };
    const int expected =
        1 + (head.hasColours ? 1 : 0) + (head.hasNormals ? 1 : 0) + (runCount > 1 ? 1 : 0);
    const bool isGood = mesh.num_attributes() == expected &&
                        isOfKind(at(kPosition), draco::DT_INT32, 3) &&
                        (!head.hasColours || isOfKind(at(kColour), draco::DT_UINT8, 4)) &&
                        (!head.hasNormals || isOfKind(at(kNormal), draco::DT_INT8, 2)) &&
                        (runCount <= 1 || isOfKind(at(kRun), draco::DT_UINT32, 1));
    return isGood ? std::string{} : "Draco stream with other attributes";
}

// Everything of one point, so that points alike can be joined.
using PointValue = std::tuple<int32_t, int32_t, int32_t, uint32_t, uint16_t>;

// False where the stream maps a point to a value that is not there.
template <typename Value>
bool valueOf(const draco::PointAttribute& attribute, uint32_t point, Value& value) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(point));
    if (index.value() >= attribute.size()) return false;
    attribute.GetValue(index, &value);
    return true;
}

struct DecodedPoints {
    std::vector<PointValue> values;
    std::vector<uint32_t> run;
};

std::string readPoints(const draco::Mesh& mesh, const GeometryHead& head, size_t runCount,
                       DecodedPoints& points) {
    points.values.resize(mesh.num_points());
    points.run.resize(mesh.num_points());
    for (uint32_t i = 0; i < mesh.num_points(); ++i) {
        std::array<int32_t, 3> position{};
        uint32_t colour = 0;
        uint16_t normal = 0;
        bool isGood = valueOf(*mesh.GetAttributeByUniqueId(kPosition), i, position);
        if (head.hasColours) {
            isGood = isGood && valueOf(*mesh.GetAttributeByUniqueId(kColour), i, colour);
        }
        if (head.hasNormals) {
            isGood = isGood && valueOf(*mesh.GetAttributeByUniqueId(kNormal), i, normal);
        }
        if (runCount > 1) {
            isGood = isGood && valueOf(*mesh.GetAttributeByUniqueId(kRun), i, points.run[i]);
        }
        if (!isGood || points.run[i] >= std::max<size_t>(runCount, 1)) {
            return "Draco stream with a point of no value";
        }
        for (size_t axis = 0; axis < 3; ++axis) {
            const int64_t value = int64_t{head.origin[static_cast<int>(axis)]} + position[axis];
            if (value < INT32_MIN || value > INT32_MAX) return "a position leaves 32 bits";
            position[axis] = static_cast<int32_t>(value);
        }
        points.values[i] = {position[0], position[1], position[2], colour, normal};
    }
    return {};
}

// Points alike become one vertex. Vertices are numbered as the corners first name them.
void joinVertices(const DecodedPoints& points, const std::vector<uint32_t>& corners,
                  const GeometryHead& head, Geometry& out) {
    std::vector<uint32_t> order(points.values.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return std::tie(points.values[a], a) < std::tie(points.values[b], b);
    });
    std::vector<uint32_t> same(order.size());  // the first point alike
    for (size_t i = 0; i < order.size(); ++i) {
        const bool isFirst = i == 0 || points.values[order[i]] != points.values[order[i - 1]];
        same[order[i]] = isFirst ? order[i] : same[order[i - 1]];
    }
    std::vector<uint32_t> vertexOf(order.size(), UINT32_MAX);
    out.indices.reserve(corners.size());
    for (const uint32_t corner : corners) {
        uint32_t& vertex = vertexOf[same[corner]];
        if (vertex == UINT32_MAX) {
            vertex = static_cast<uint32_t>(out.positions.size());
            const auto& [x, y, z, colour, normal] = points.values[corner];
            out.positions.emplace_back(x, y, z);
            if (head.hasColours) out.colours.push_back(colour);
            if (head.hasNormals) {
                out.normals.push_back(std::bit_cast<OctNormal>(normal));
            }
        }
        out.indices.push_back(vertex);
    }
}

// The corners of all faces, run by run. The runs hold as many triangles as the mesh has faces.
std::string sortFaces(const draco::Mesh& mesh, const DecodedPoints& points,
                      std::span<const MeshRun> runs, std::vector<uint32_t>& corners) {
    std::vector<uint64_t> next(runs.size());  // where the run's next corner goes
    for (size_t run = 1; run < runs.size(); ++run) {
        next[run] = next[run - 1] + uint64_t{runs[run - 1].triangleCount} * 3;
    }
    corners.resize(size_t{mesh.num_faces()} * 3);
    std::vector<uint32_t> left(runs.size());
    for (size_t run = 0; run < runs.size(); ++run) left[run] = runs[run].triangleCount;
    for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
        const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
        for (size_t i = 0; i < 3; ++i) {
            if (face[i].value() >= points.values.size()) return "face of no such point";
        }
        const uint32_t run = points.run[face[0].value()];
        if (run >= runs.size() || left[run]-- == 0) return "faces that do not fit the runs";
        for (size_t i = 0; i < 3; ++i) corners[next[run]++] = face[i].value();
    }
    return {};
}

std::string decodeStream(std::span<const std::byte> stream, const GeometryHead& head,
                         std::span<const MeshRun> runs, Geometry& out) {
    if (std::string fault = checkStreamHead(stream, head); !fault.empty()) return fault;
    uint64_t inRuns = 0;
    for (const MeshRun& run : runs) inRuns += run.triangleCount;
    if (inRuns != head.triangleCount) return "runs do not sum to the mesh";
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) {
        return std::string("Draco: ") + decoded.status().error_msg_string();
    }
    const draco::Mesh& mesh = *decoded.value();
    if (buffer.remaining_size() != 0) return "bytes behind the Draco stream";
    if (mesh.num_faces() != head.triangleCount) return "Draco stream of another size";
    if (std::string fault = checkAttributes(mesh, head, runs.size()); !fault.empty()) return fault;

    DecodedPoints points;
    std::vector<uint32_t> corners;
    if (auto fault = readPoints(mesh, head, runs.size(), points); !fault.empty()) return fault;
    if (auto fault = sortFaces(mesh, points, runs, corners); !fault.empty()) return fault;
    joinVertices(points, corners, head, out);
    return out.positions.size() == head.vertexCount ? std::string{}
                                                    : "Draco stream of other vertices";
}

}  // namespace

bool encodeDraco(const GeometryView& geometry, std::span<const MeshRun> runs, ByteWriter& out) {
    if (geometry.indices.empty() || !isSmall(geometry)) return false;
    const GeometryHead head = headOf(geometry);
    draco::Mesh mesh;
    fillMesh(geometry, runs, head.origin, mesh);
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    encoder.SetSpeedOptions(kSpeed, kSpeed);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) return false;

    const auto stream = std::as_bytes(std::span(buffer.data(), buffer.size()));
    Geometry back;
    if (!decodeStream(stream, head, runs, back).empty()) return false;
    const GeometryView backView{back.positions, back.colours, back.normals, back.indices};
    if (fingerprint(backView, runs) != fingerprint(geometry, runs)) return false;
    head.put(out);
    out.putBytes(stream);
    return true;
}

std::string decodeDraco(ByteReader& in, std::span<const MeshRun> runs, Geometry& out) {
    GeometryHead head;
    if (std::string fault = head.get(in); !fault.empty()) return fault;
    try {
        return decodeStream(in.getBytes(in.remaining()), head, runs, out);
    } catch (const std::exception& exception) {  // the library's: a size that memory does not hold
        return std::string("Draco: ") + exception.what();
    }
}

}  // namespace pagoda::ooc
