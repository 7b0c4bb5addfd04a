#include "ooc/readers/gltf_reader.h"

#include "ooc/readers/gltf_buffers.h"
#include "ooc/readers/gltf_document.h"
#include "ooc/readers/gltf_emitter.h"
#include "ooc/readers/gltf_files.h"
#include "ooc/readers/gltf_material.h"
#include "ooc/readers/gltf_primitive.h"
#include "ooc/readers/gltf_scene.h"
#include "ooc/readers/reader_extras.h"
#include "ooc/readers/source_file.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pagoda::ooc {
namespace {

using namespace gltf;

// Objects of single instances end here: beyond, instances belong to their node's object. A kilobyte
// of file can ask for billions.
constexpr uint64_t kMaxInstanceObjects = uint64_t{1} << 22;

class GltfReader final : public Reader, public CompanionReader {
public:
    GltfReader(const std::filesystem::path& path, const ReaderOptions& options);

    void read(TriangleSink& sink) override;
    [[nodiscard]] UpAxis upAxis() const override { return UpAxis::Y; }
    [[nodiscard]] std::string attribution() const override {
        return document_.model.asset.copyright;
    }
    [[nodiscard]] uint64_t announcedTriangles() const override { return scene_.triangles; }
    [[nodiscard]] std::vector<std::filesystem::path> companions() const override {
        return filesBeside(source_, document_);
    }

private:
    SourceFile source_;
    ReaderOptions options_;
    Document document_;
    Scene scene_;
    FileStamps stamps_;
};

// One read(): ids that the sink gave, and what is in memory meanwhile.
class Reading {
public:
    Reading(const SourceFile& source, const ReaderOptions& options, const Document& document,
            const Scene& scene, FileStamps& stamps, TriangleSink& sink);
    void run();

private:
    void addObjects();
    void addMaterials();
    void drawMesh(int mesh, std::span<const uint32_t> nodes);
    void drawPrimitive(const DecodedPrimitive& primitive, uint32_t material,
                       std::span<const uint32_t> nodes);
    void countDrops(const DecodedPrimitive& primitive, std::span<const uint32_t> nodes);
    void advance(uint64_t triangles);
    void ignore(std::string_view what, uint64_t count = 1) { ignored_[std::string(what)] += count; }

    const SourceFile& source_;
    const Document& document_;
    const Scene& scene_;
    TriangleSink& sink_;
    MemoryBudget budget_;
    Buffers buffers_;
    Materials materials_;
    PrimitiveDecoder decoder_;
    Emitter emitter_;
    std::vector<uint32_t> objectOfNode_;         // by index in Scene::nodes
    std::vector<uint32_t> firstInstanceObject_;  // the same; kNoParent: instances have none
    std::vector<uint32_t> materialIds_;          // by material; last, if used, glTF's default
    std::map<std::string, uint64_t> ignored_;
    uint64_t trianglesDone_ = 0, bytesDone_ = 0;
};

Reading::Reading(const SourceFile& source, const ReaderOptions& options, const Document& document,
                 const Scene& scene, FileStamps& stamps, TriangleSink& sink)
    : source_(source),
      document_(document),
      scene_(scene),
      sink_(sink),
      budget_(source, options.memoryBytes),
      buffers_(source, document, budget_, stamps),
      materials_(document, buffers_, budget_),
      decoder_(source, document, buffers_, materials_),
      emitter_(sink),
      ignored_(document.extras.ignored) {
}

void Reading::run() {
    addObjects();
    addMaterials();
    std::vector<std::pair<int, uint32_t>> draws;  // mesh, index in Scene::nodes
    for (size_t i = 0; i < scene_.nodes.size(); ++i) {
        const int mesh = document_.model.nodes[static_cast<size_t>(scene_.nodes[i].node)].mesh;
        if (mesh >= 0) draws.emplace_back(mesh, static_cast<uint32_t>(i));
    }
    std::ranges::sort(draws);
    size_t hiddenMeshes = document_.model.meshes.size();
    std::vector<uint32_t> nodes;
    for (size_t i = 0; i < draws.size(); ++i) {
        nodes.push_back(draws[i].second);
        if (i + 1 < draws.size() && draws[i + 1].first == draws[i].first) continue;
        drawMesh(draws[i].first, nodes);
        --hiddenMeshes;
        nodes.clear();
    }
    if (hiddenMeshes > 0) ignore("mesh that the scene does not show", hiddenMeshes);
    source_.checkUnchanged();
    for (const auto& [what, count] : ignored_) sink_.ignored(what, count);
    sink_.advance(source_.sizeBytes() - bytesDone_);
}

void Reading::addObjects() {
    objectOfNode_.assign(scene_.nodes.size(), ObjectInfo::kNoParent);
    firstInstanceObject_.assign(scene_.nodes.size(), ObjectInfo::kNoParent);
    uint64_t instanceObjects = 0;
    for (size_t i = 0; i < scene_.nodes.size(); ++i) {
        const SceneNode& node = scene_.nodes[i];
        if (!node.isObject) continue;
        const std::string& name = document_.model.nodes[static_cast<size_t>(node.node)].name;
        const uint32_t parent = node.parent == ObjectInfo::kNoParent ? ObjectInfo::kNoParent
                                                                     : objectOfNode_[node.parent];
        objectOfNode_[i] = sink_.addObject({name, parent});
        if (!node.isInstanced) continue;
        if (node.instances > kMaxInstanceObjects - instanceObjects) {
            ignore("instances without objects of their own", node.instances);
            continue;
        }
        instanceObjects += node.instances;
        for (uint64_t instance = 0; instance < node.instances; ++instance) {
            const uint32_t id = sink_.addObject(
                {name.empty() ? name : name + "#" + std::to_string(instance), objectOfNode_[i]});
            if (instance == 0) firstInstanceObject_[i] = id;
        }
    }
}

void Reading::addMaterials() {
    const int count = static_cast<int>(document_.model.materials.size());
    for (int i = 0; i < count; ++i) {
        materialIds_.push_back(sink_.addMaterial(materialInfo(materials_.surface(i))));
    }
    for (const tinygltf::Mesh& mesh : document_.model.meshes) {
        for (const tinygltf::Primitive& primitive : mesh.primitives) {
            if (primitive.material >= 0) continue;
            materialIds_.push_back(sink_.addMaterial(materialInfo(materials_.surface(-1))));
            return;
        }
    }
}

void Reading::drawMesh(int mesh, std::span<const uint32_t> nodes) {
    const tinygltf::Mesh& from = document_.model.meshes[static_cast<size_t>(mesh)];
    for (size_t i = 0; i < from.primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = from.primitives[i];
        if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
            ignore(primitive.mode == TINYGLTF_MODE_POINTS ? "point primitive" : "line primitive");
            continue;
        }
        MemoryLease lease(budget_);
        const DecodedPrimitive decoded = decoder_.decode(mesh, i, lease);
        for (const std::string_view what : decoded.ignored) ignore(what);
        if (materials_.surface(primitive.material).isMask) ignore("alpha mask (drawn opaque)");
        const uint32_t material = primitive.material < 0
                                      ? materialIds_.back()
                                      : materialIds_[static_cast<size_t>(primitive.material)];
        drawPrimitive(decoded, material, nodes);
        countDrops(decoded, nodes);
    }
}

void Reading::drawPrimitive(const DecodedPrimitive& primitive, uint32_t material,
                            std::span<const uint32_t> nodes) {
    if (primitive.triangleCount() == 0) return;
    for (const uint32_t index : nodes) {
        const Instances instances(source_, document_, buffers_, scene_.nodes[index]);
        for (uint64_t i = 0; i < instances.count(); ++i) {
            const uint32_t first = firstInstanceObject_[index];
            const uint32_t object = first == ObjectInfo::kNoParent
                                        ? objectOfNode_[index]
                                        : first + static_cast<uint32_t>(i);
            emitter_.emit(primitive, instances.transform(i), object, material);
            advance(primitive.triangleCount());
        }
    }
}

void Reading::countDrops(const DecodedPrimitive& primitive, std::span<const uint32_t> nodes) {
    uint64_t draws = 0;
    for (const uint32_t index : nodes) draws += scene_.nodes[index].instances;
    if (draws == 0) return;
    if (primitive.indexOutOfRange > 0) {
        sink_.dropped(DropReason::IndexOutOfRange, primitive.indexOutOfRange * draws);
    }
    if (primitive.nonFinite > 0) {
        sink_.dropped(DropReason::NonFinite, primitive.nonFinite * draws);
    }
}

// The file's bytes in proportion to the triangles delivered: reading them is the smaller part.
void Reading::advance(uint64_t triangles) {
    trianglesDone_ = std::min(trianglesDone_ + triangles, scene_.triangles);
    const double part = static_cast<double>(trianglesDone_) / static_cast<double>(scene_.triangles);
    const auto bytes =
        std::min(source_.sizeBytes(),
                 static_cast<uint64_t>(part * static_cast<double>(source_.sizeBytes())));
    sink_.advance(bytes - bytesDone_);
    bytesDone_ = bytes;
}

GltfReader::GltfReader(const std::filesystem::path& path, const ReaderOptions& options)
    : source_(path),
      options_(options),
      document_(loadDocument(source_, options.memoryBytes)),
      scene_(planScene(source_, document_, options.maxTriangles)) {
}

void GltfReader::read(TriangleSink& sink) {
    source_.checkUnchanged();
    Reading(source_, options_, document_, scene_, stamps_, sink).run();
}

}  // namespace

std::unique_ptr<Reader> openGltfReader(const std::filesystem::path& path,
                                       const ReaderOptions& options) {
    return std::make_unique<GltfReader>(path, options);
}

}  // namespace pagoda::ooc
