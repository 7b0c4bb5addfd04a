#include "ooc/readers/drc_decode.h"

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <type_traits>

namespace pagoda::ooc {
namespace {

constexpr uint16_t version(uint8_t major, uint8_t minor) {
    return static_cast<uint16_t>(major << 8 | minor);
}

draco::DecoderBuffer bufferOf(std::span<const std::byte> bytes) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return buffer;
}

// Counts were 32-bit words before varints came in.
bool readCount(draco::DecoderBuffer& buffer, bool isVarint, uint64_t& count) {
    uint32_t value = 0;
    const bool isRead = isVarint ? draco::DecodeVarint(&value, &buffer) : buffer.Decode(&value);
    count = value;
    return isRead;
}

// The counts that follow header and metadata: the beginnings of the Decode...() of draco's
// MeshSequentialDecoder, MeshEdgebreakerDecoder and the point cloud decoders.
bool readCounts(draco::DecoderBuffer& buffer, uint8_t method, DracoAnnouncement& announced) {
    const uint16_t stream = buffer.bitstream_version();
    if (!announced.isMesh) return readCount(buffer, false, announced.points);
    if (method == draco::MESH_SEQUENTIAL_ENCODING) {
        const bool isVarint = stream >= version(2, 2);
        return readCount(buffer, isVarint, announced.faces) &&
               readCount(buffer, isVarint, announced.points);
    }
    uint8_t traversal = 0;
    uint64_t newVertices = 0;
    const bool isVarint = stream >= version(2, 0);
    if (!buffer.Decode(&traversal)) return false;
    if (stream < version(2, 2) && !readCount(buffer, isVarint, newVertices)) return false;
    return readCount(buffer, isVarint, announced.points) &&
           readCount(buffer, isVarint, announced.faces);
}

// Draco's own conversions read through pointers of the type, whatever the bytes: bools of 235.
template <typename T>
void readComponents(const uint8_t* from, int count, bool isNormalised, double* out) {
    for (int c = 0; c < count; ++c) {
        T value;
        std::memcpy(&value, from + static_cast<size_t>(c) * sizeof(T), sizeof(T));
        out[c] = static_cast<double>(value);
        if (std::is_integral_v<T> && isNormalised) {
            out[c] = std::max(out[c] / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
        }
    }
}

bool readAnyComponents(draco::DataType type, const uint8_t* from, int count, bool isNormalised,
                       double* out) {
    const auto run = [&](auto example) {
        readComponents<decltype(example)>(from, count, isNormalised, out);
        return true;
    };
    switch (type) {
        case draco::DT_INT8:
            return run(int8_t{});
        case draco::DT_UINT8:
            return run(uint8_t{});
        case draco::DT_INT16:
            return run(int16_t{});
        case draco::DT_UINT16:
            return run(uint16_t{});
        case draco::DT_INT32:
            return run(int32_t{});
        case draco::DT_UINT32:
            return run(uint32_t{});
        case draco::DT_INT64:
            return run(int64_t{});
        case draco::DT_UINT64:
            return run(uint64_t{});
        case draco::DT_FLOAT32:
            return run(float{});
        case draco::DT_FLOAT64:
            return run(double{});
        default:
            return false;
    }
}

}  // namespace

std::optional<DracoAnnouncement> dracoAnnouncement(std::span<const std::byte> bytes,
                                                   std::string& problem) {
    draco::DecoderBuffer buffer = bufferOf(bytes);
    draco::DracoHeader header;
    const draco::Status status = draco::PointCloudDecoder::DecodeHeader(&buffer, &header);
    if (!status.ok()) {
        problem = "not a Draco stream (" + status.error_msg_string() + ")";
        return std::nullopt;
    }
    buffer.set_bitstream_version(version(header.version_major, header.version_minor));
    if (buffer.bitstream_version() >= version(1, 3) && (header.flags & METADATA_FLAG_MASK) != 0) {
        draco::GeometryMetadata metadata;
        if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) {
            problem = "Draco metadata cut short";
            return std::nullopt;
        }
    }
    DracoAnnouncement announced;
    announced.isMesh = header.encoder_type == draco::TRIANGULAR_MESH;
    if (!readCounts(buffer, header.encoder_method, announced)) {
        problem = "Draco stream cut short";
        return std::nullopt;
    }
    return announced;
}

std::unique_ptr<draco::Mesh> decodeDracoMesh(std::span<const std::byte> bytes,
                                             std::string& problem) {
    draco::DecoderBuffer buffer = bufferOf(bytes);
    draco::Decoder decoder;
    try {
        auto result = decoder.DecodeMeshFromBuffer(&buffer);
        if (!result.ok()) {
            problem = "Draco stream broken (" + result.status().error_msg_string() + ")";
            return nullptr;
        }
        std::unique_ptr<draco::Mesh> mesh = std::move(result).value();
        for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
            for (const draco::PointIndex& point : mesh->face(face)) {
                if (point.value() < mesh->num_points()) continue;
                problem = "Draco face names a point that does not exist";
                return nullptr;
            }
        }
        return mesh;
    } catch (const std::exception& failure) {  // allocations that a broken stream asks for
        problem = std::string("Draco stream broken (") + failure.what() + ")";
        return nullptr;
    }
}

bool readDracoValue(const draco::PointAttribute& attribute, uint32_t point, int components,
                    bool isNormalised, double* out) {
    const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(point));
    const int count = std::min(components, int{attribute.num_components()});
    const auto stride = static_cast<uint64_t>(attribute.byte_stride());
    const auto offset = static_cast<uint64_t>(attribute.byte_offset());
    const auto width = static_cast<uint64_t>(count) *
                       static_cast<uint64_t>(draco::DataTypeLength(attribute.data_type()));
    if (value.value() >= attribute.size() || attribute.data_type() == draco::DT_INVALID ||
        offset + stride * value.value() + width > attribute.buffer()->data_size()) {
        return false;
    }
    std::fill_n(out, components, 0.0);
    return readAnyComponents(attribute.data_type(), attribute.GetAddress(value), count,
                             isNormalised, out);
}

}  // namespace pagoda::ooc
