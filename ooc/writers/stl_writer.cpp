// stl_writer.cpp: binary STL: an 80-byte header, a count, 50 bytes a triangle.
#include "ooc/base/error.h"
#include "ooc/writers/target_file.h"
#include "ooc/writers/writer_kinds.h"

#include <array>
#include <cstring>

namespace pagoda::ooc {
namespace {

constexpr uint64_t kCountOffset = 80;

class StlWriter final : public MeshWriter {
public:
    StlWriter(const std::filesystem::path& target, bool force) : file_(target, force) {
        std::array<std::byte, kCountOffset + 4> header{};
        // Not "solid": that is how the text kind begins.
        std::memcpy(header.data(), "binary STL by Pagoda", 20);
        file_.append(header);
    }

    uint32_t addObject(const ObjectInfo&) override { return objects_++; }
    uint32_t addMaterial(const MaterialInfo&) override { return materials_++; }

    void addTriangles(const TriangleBatch& batch) override {
        triangles_ += batch.triangleCount();
        if (triangles_ > UINT32_MAX) {
            throw Error(file_.target().string(), "", "STL holds at most 4,294,967,295 triangles",
                        "name it .ply or .obj");
        }
        for (size_t t = 0; t < batch.triangleCount(); ++t) writeTriangle(&batch.positions[3 * t]);
    }

    uint64_t finish() override {
        const uint32_t count = static_cast<uint32_t>(triangles_);
        file_.patch(kCountOffset, std::as_bytes(std::span(&count, 1)));
        return file_.publish();
    }

private:
    void writeTriangle(const Vec3d* corners) {
        const Vec3d cross = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double length = glm::length(cross);
        std::array<Vec3f, 4> floats{};
        if (length > 0) floats[0] = Vec3f(cross / length);
        for (size_t i = 0; i < 3; ++i) floats[i + 1] = Vec3f(corners[i]);
        std::array<std::byte, 50> record{};
        std::memcpy(record.data(), floats.data(), 48);
        file_.append(record);
    }

    TargetFile file_;
    uint64_t triangles_ = 0;
    uint32_t objects_ = 0, materials_ = 0;
};

}  // namespace

std::unique_ptr<MeshWriter> createStlWriter(const std::filesystem::path& target, bool force) {
    return std::make_unique<StlWriter>(target, force);
}

}  // namespace pagoda::ooc
