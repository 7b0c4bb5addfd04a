#include "ooc/readers/drc_reader.h"

#include "ooc/readers/drc_decode.h"
#include "ooc/readers/source_file.h"
#include "ooc/readers/triangle_batcher.h"

#include <draco/mesh/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace pagoda::ooc {
namespace {

class DrcReader final : public Reader {
public:
    DrcReader(const std::filesystem::path& path, const ReaderOptions& options);

    void read(TriangleSink& sink) override;
    [[nodiscard]] uint64_t announcedTriangles() const override { return announced_.faces; }

private:
    [[nodiscard]] std::vector<std::byte> readFile() const;

    SourceFile source_;
    ReaderOptions options_;
    DracoAnnouncement announced_;
};

uint32_t packBytes(const std::array<double, 4>& colour, int components, bool isFloat) {
    uint32_t packed = components < 4 ? 0xFF000000u : 0;
    for (int c = 0; c < components; ++c) {
        const double scaled = colour[static_cast<size_t>(c)] * (isFloat ? 255.0 : 1.0);
        const double byte = std::isfinite(scaled) ? std::clamp(scaled, 0.0, 255.0) : 255.0;
        packed |= static_cast<uint32_t>(std::lround(byte)) << (8 * c);
    }
    return packed;
}

// The attributes of a mesh that we read, corner by corner.
class CornerSource {
public:
    CornerSource(const SourceFile& source, const draco::Mesh& mesh) : source_(source) {
        using draco::GeometryAttribute;
        positions_ = mesh.GetNamedAttribute(GeometryAttribute::POSITION);
        normals_ = mesh.GetNamedAttribute(GeometryAttribute::NORMAL);
        colours_ = mesh.GetNamedAttribute(GeometryAttribute::COLOR);
        if (positions_ == nullptr || positions_->num_components() != 3) {
            source.fail("byte 0", "has no positions of three coordinates", "export it again");
        }
        if (normals_ != nullptr && normals_->num_components() != 3) normals_ = nullptr;
        if (colours_ == nullptr) return;
        const auto type = colours_->data_type();
        const bool isKnown = type == draco::DT_UINT8 || type == draco::DT_FLOAT32;
        const int components = int{colours_->num_components()};
        if (!isKnown || components < 3 || components > 4) colours_ = nullptr;
    }

    [[nodiscard]] bool hasColours() const { return colours_ != nullptr; }
    [[nodiscard]] bool hasNormals() const { return normals_ != nullptr; }
    [[nodiscard]] Corner corner(uint32_t point) const {
        Corner corner;
        std::array<double, 4> value{};
        read(*positions_, point, 3, value);
        corner.position = {value[0], value[1], value[2]};
        if (normals_ != nullptr) {
            read(*normals_, point, 3, value);
            corner.normal = unitNormal(value[0], value[1], value[2]);
        }
        if (colours_ != nullptr) {
            const int components = int{colours_->num_components()};
            read(*colours_, point, components, value);
            corner.colour =
                packBytes(value, components, colours_->data_type() == draco::DT_FLOAT32);
        }
        return corner;
    }

private:
    void read(const draco::PointAttribute& attribute, uint32_t point, int components,
              std::array<double, 4>& value) const {
        if (readDracoValue(attribute, point, components, false, value.data())) return;
        source_.fail("point " + std::to_string(point), "has no value of an attribute",
                     "check that the file was copied whole");
    }

    const SourceFile& source_;
    const draco::PointAttribute* positions_ = nullptr;
    const draco::PointAttribute* normals_ = nullptr;
    const draco::PointAttribute* colours_ = nullptr;
};

DrcReader::DrcReader(const std::filesystem::path& path, const ReaderOptions& options)
    : source_(path), options_(options) {
    std::string problem;
    const auto announced = dracoAnnouncement(readFile(), problem);
    if (!announced) source_.fail("byte 0", problem, "check that the file was copied whole");
    announced_ = *announced;
    if (!announced_.isMesh) announced_.faces = 0;
    if (announced_.faces > options.maxTriangles) {
        source_.fail("byte 0",
                     "holds " + std::to_string(announced_.faces) +
                         " triangles, over the limit of " + std::to_string(options.maxTriangles),
                     "raise --max-triangles if it is meant");
    }
}

std::vector<std::byte> DrcReader::readFile() const {
    constexpr uint64_t kMiB = uint64_t{1} << 20;
    const uint64_t neededBytes = source_.sizeBytes() + announced_.decodedBytes();
    if (neededBytes > options_.memoryBytes) {
        source_.fail("byte 0",
                     "needs " + std::to_string(neededBytes / kMiB + 1) +
                         " MiB of memory to decode, over the limit of " +
                         std::to_string(options_.memoryBytes / kMiB) + " MiB",
                     "raise --memory, or convert it to PLY with draco_decoder");
    }
    std::vector<std::byte> bytes(source_.sizeBytes());
    source_.file().readAt(0, bytes);
    return bytes;
}

void DrcReader::read(TriangleSink& sink) {
    source_.checkUnchanged();
    if (!announced_.isMesh) {
        sink.ignored("point cloud (no triangles)", 1);
        sink.advance(source_.sizeBytes());
        return;
    }
    std::string problem;
    const std::vector<std::byte> bytes = readFile();
    const std::unique_ptr<draco::Mesh> mesh = decodeDracoMesh(bytes, problem);
    if (mesh == nullptr) source_.fail("byte 0", problem, "check that the file was copied whole");
    source_.checkUnchanged();
    const uint32_t object = sink.addObject(
        {std::filesystem::path(source_.path()).stem().string(), ObjectInfo::kNoParent});
    const uint32_t material = sink.addMaterial({});
    if (mesh->num_faces() > 0) {
        const CornerSource corners(source_, *mesh);
        TriangleBatcher batcher(sink, corners.hasColours(), corners.hasNormals());
        batcher.setTarget(object, material);
        for (draco::FaceIndex i(0); i < mesh->num_faces(); ++i) {
            const draco::Mesh::Face& face = mesh->face(i);
            batcher.add(corners.corner(face[0].value()), corners.corner(face[1].value()),
                        corners.corner(face[2].value()));
        }
        batcher.finish();
    }
    sink.advance(source_.sizeBytes());
}

}  // namespace

std::unique_ptr<Reader> openDrcReader(const std::filesystem::path& path,
                                      const ReaderOptions& options) {
    return std::make_unique<DrcReader>(path, options);
}

}  // namespace pagoda::ooc
