// glb_writer.cpp: binary glTF 2.0. https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
// Positions, normals, colours and indices are four streams in scratch, one buffer view each; a
// primitive is four ranges of them. The JSON, which must come first, is written at the end, item by
// item; only the table of primitives (64 bytes each) and the names are kept.
#include "ooc/base/error.h"
#include "ooc/writers/batch_gatherer.h"
#include "ooc/writers/corner_welder.h"
#include "ooc/writers/glb_json.h"
#include "ooc/writers/target_file.h"
#include "ooc/writers/writer_kinds.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pagoda::ooc {
namespace {

// At most 65,535 vertices a primitive (65,535 itself is the restart value), so indices are 16 bits.
constexpr size_t kPrimitiveTriangles = 21845;
constexpr size_t kPendingTriangles = 400'000;  // about 48 MB
constexpr uint64_t kMaxFileBytes = UINT32_MAX;

// glTF's vertex colours are linear.
std::array<uint16_t, 256> linearTable() {
    std::array<uint16_t, 256> table{};
    for (size_t i = 0; i < 256; ++i) {
        table[i] =
            static_cast<uint16_t>(std::lround(srgbToLinear(static_cast<uint8_t>(i)) * 65535));
    }
    return table;
}

// The object's translation: near its first triangles, a multiple of a power of two about as large
// as they are, so that what is left is small and mostly exact in a float.
Vec3d chooseTranslation(const TriangleBatch& batch) {
    Box3d box;
    for (const Vec3d& position : batch.positions) box.extend(position);
    const Vec3d size = box.max - box.min;
    const double largest = std::max({size.x, size.y, size.z});
    if (!(largest > 0) || !std::isfinite(largest)) return Vec3d(0.0);
    const double unit = std::ldexp(1.0, std::ilogb(largest) + 1);
    return glm::round((box.min + box.max) * 0.5 / unit) * unit;
}

class GlbWriter final : public MeshWriter {
public:
    GlbWriter(const std::filesystem::path& target, bool force, UpAxis up)
        : file_(target, force),
          positions_(folderOf(target)),
          normals_(folderOf(target)),
          colours_(folderOf(target)),
          indices_(folderOf(target)),
          gatherer_(kPrimitiveTriangles, kPendingTriangles,
                    [this](const TriangleBatch& batch) { writePrimitive(batch); }) {
        scene_.turnsZUp = up == UpAxis::Z;
    }

    uint32_t addObject(const ObjectInfo& object) override {
        scene_.objects.push_back({.info = object});
        return static_cast<uint32_t>(scene_.objects.size() - 1);
    }

    uint32_t addMaterial(const MaterialInfo& material) override {
        scene_.materials.push_back(material);
        return static_cast<uint32_t>(scene_.materials.size() - 1);
    }

    void addTriangles(const TriangleBatch& batch) override { gatherer_.add(batch); }

    uint64_t finish() override {
        gatherer_.drain();
        scene_.streamBytes = {positions_.sizeBytes(), normals_.sizeBytes(), colours_.sizeBytes(),
                              indices_.sizeBytes()};
        const uint64_t binBytes = scene_.binBytes();
        const std::array<uint32_t, 5> header{0x46546C67u, 2, 0, 0, 0x4E4F534Au};  // glTF, JSON
        file_.append(std::as_bytes(std::span(header)));
        writeGlbJson(scene_, [this](std::string_view text) { file_.append(text); });
        while (file_.sizeBytes() % 4 != 0) file_.append(" ");
        const uint64_t jsonBytes = file_.sizeBytes() - 20;
        const uint64_t fileBytes = file_.sizeBytes() + (binBytes > 0 ? 8 + binBytes : 0);
        if (fileBytes > kMaxFileBytes) refuseSize();
        if (binBytes > 0) {
            const std::array<uint32_t, 2> chunk{static_cast<uint32_t>(binBytes), 0x004E4942u};
            file_.append(std::as_bytes(std::span(chunk)));
            for (ScratchStream* stream : {&positions_, &normals_, &colours_, &indices_}) {
                file_.append(stream->flushed());
            }
        }
        const std::array<uint32_t, 2> sizes{static_cast<uint32_t>(fileBytes),
                                            static_cast<uint32_t>(jsonBytes)};
        file_.patch(8, std::as_bytes(std::span(sizes)));
        return file_.publish();
    }

private:
    [[noreturn]] void refuseSize() const {
        throw Error(file_.target().string(), "",
                    "the mesh needs more than 4 GiB, which GLB cannot hold",
                    "name it .ply or .obj, or write fewer triangles");
    }

    void writePrimitive(const TriangleBatch& batch) {
        welder_.weld(batch);
        // A sink is told of its objects first; one that is not gets a nameless node.
        if (batch.object >= scene_.objects.size()) scene_.objects.resize(batch.object + 1u);
        GlbObject& object = scene_.objects[batch.object];
        if (object.primitiveCount++ == 0) object.translation = chooseTranslation(batch);

        GlbPrimitive primitive{.object = batch.object, .material = batch.material};
        primitive.vertexCount = static_cast<uint32_t>(welder_.vertices().size());
        primitive.indexCount = static_cast<uint32_t>(welder_.indices().size());
        primitive.positionOffset = positions_.sizeBytes();
        primitive.normalOffset =
            batch.normals.empty() ? GlbPrimitive::kAbsent : normals_.sizeBytes();
        primitive.colourOffset =
            batch.colours.empty() ? GlbPrimitive::kAbsent : colours_.sizeBytes();
        primitive.indexOffset = indices_.sizeBytes();
        writePositions(batch, object.translation, primitive);
        if (!batch.normals.empty()) writeNormals(batch);
        if (!batch.colours.empty()) writeColours(batch);
        writeIndices();
        scene_.primitives.push_back(primitive);
        if (positions_.sizeBytes() + normals_.sizeBytes() + colours_.sizeBytes() +
                indices_.sizeBytes() >
            kMaxFileBytes) {
            refuseSize();
        }
    }

    void writePositions(const TriangleBatch& batch, const Vec3d& translation,
                        GlbPrimitive& primitive) {
        floats_.clear();
        for (const uint32_t corner : welder_.vertices()) {
            const Vec3f local(batch.positions[corner] - translation);
            primitive.min = glm::min(primitive.min, local);
            primitive.max = glm::max(primitive.max, local);
            floats_.push_back(local + 0.0f);
        }
        positions_.append(std::as_bytes(std::span(floats_)));
    }

    void writeNormals(const TriangleBatch& batch) {
        floats_.clear();
        for (const uint32_t corner : welder_.vertices()) floats_.push_back(batch.normals[corner]);
        normals_.append(std::as_bytes(std::span(floats_)));
    }

    void writeColours(const TriangleBatch& batch) {
        static const std::array<uint16_t, 256> kLinear = linearTable();
        shorts_.clear();
        for (const uint32_t corner : welder_.vertices()) {
            const uint32_t colour = batch.colours[corner];
            for (unsigned shift : {0u, 8u, 16u}) {
                shorts_.push_back(kLinear[(colour >> shift) & 255u]);
            }
            shorts_.push_back(static_cast<uint16_t>((colour >> 24) * 257u));
        }
        colours_.append(std::as_bytes(std::span(shorts_)));
    }

    void writeIndices() {
        shorts_.clear();
        for (const uint32_t index : welder_.indices()) {
            shorts_.push_back(static_cast<uint16_t>(index));
        }
        if (shorts_.size() % 2 != 0) shorts_.push_back(0);  // accessors start at multiples of 4
        indices_.append(std::as_bytes(std::span(shorts_)));
    }

    TargetFile file_;
    ScratchStream positions_, normals_, colours_, indices_;
    BatchGatherer gatherer_;
    CornerWelder welder_;
    GlbScene scene_;
    std::vector<Vec3f> floats_;
    std::vector<uint16_t> shorts_;
};

}  // namespace

std::unique_ptr<MeshWriter> createGlbWriter(const std::filesystem::path& target, bool force,
                                            UpAxis up) {
    return std::make_unique<GlbWriter>(target, force, up);
}

}  // namespace pagoda::ooc
