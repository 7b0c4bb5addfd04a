#include "ooc/readers/drc_decode.h"

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <limits>

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

double typeMaximum(draco::DataType type) {
    switch (type) {
        case draco::DT_INT8:
            return std::numeric_limits<int8_t>::max();
        case draco::DT_UINT8:
            return std::numeric_limits<uint8_t>::max();
        case draco::DT_INT16:
            return std::numeric_limits<int16_t>::max();
        case draco::DT_UINT16:
            return std::numeric_limits<uint16_t>::max();
        case draco::DT_INT32:
            return std::numeric_limits<int32_t>::max();
        case draco::DT_UINT32:
            return std::numeric_limits<uint32_t>::max();
        default:
            return 1;
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
    const auto stride = static_cast<uint64_t>(attribute.byte_stride());
    if (value.value() >= attribute.size() ||
        stride * (uint64_t{value.value()} + 1) + static_cast<uint64_t>(attribute.byte_offset()) >
            attribute.buffer()->data_size()) {
        return false;
    }
    std::fill_n(out, components, 0.0);
    const auto count = static_cast<int8_t>(std::min(components, int{attribute.num_components()}));
    const draco::DataType type = attribute.data_type();
    if (type == draco::DT_FLOAT32 || type == draco::DT_FLOAT64) {
        return attribute.ConvertValue<double>(value, count, out);
    }
    std::array<int64_t, 4> whole{};
    if (count > 4 || !attribute.ConvertValue<int64_t>(value, count, whole.data())) return false;
    for (int8_t c = 0; c < count; ++c) {
        out[c] = static_cast<double>(whole[static_cast<size_t>(c)]);
        if (isNormalised) out[c] = std::max(out[c] / typeMaximum(type), -1.0);
    }
    return true;
}

}  // namespace pagoda::ooc
