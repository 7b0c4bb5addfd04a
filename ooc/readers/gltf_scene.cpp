#include "ooc/readers/gltf_scene.h"

#include "ooc/readers/gltf_primitive.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace pagoda::ooc::gltf {
namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

glm::dmat4 compose(const Vec3d& translation, const glm::dquat& rotation, const Vec3d& scale) {
    // Files hold quaternions rounded to bytes: made unit, or the shape would shear.
    const double length = glm::length(rotation);
    glm::dmat4 matrix = glm::mat4_cast(length > 0 ? rotation / length : glm::dquat(1, 0, 0, 0));
    for (int axis = 0; axis < 3; ++axis) matrix[axis] *= scale[axis];
    matrix[3] = glm::dvec4(translation, 1);
    return matrix;
}

glm::dmat4 localTransform(const tinygltf::Node& node) {
    if (node.matrix.size() == 16) {
        glm::dmat4 matrix;
        for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = node.matrix[static_cast<size_t>(i)];
        return matrix;
    }
    Vec3d translation(0), scale(1);
    glm::dquat rotation(1, 0, 0, 0);
    const auto take = [](const std::vector<double>& from, Vec3d& to) {
        if (from.size() == 3) to = {from[0], from[1], from[2]};
    };
    take(node.translation, translation);
    take(node.scale, scale);
    if (node.rotation.size() == 4) {
        rotation = {node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]};
    }
    return compose(translation, rotation, scale);
}

std::vector<int> rootNodes(const tinygltf::Model& model) {
    if (!model.scenes.empty()) {
        return model.scenes[static_cast<size_t>(std::max(model.defaultScene, 0))].nodes;
    }
    std::vector<bool> isChild(model.nodes.size());
    for (const tinygltf::Node& node : model.nodes) {
        for (const int child : node.children) isChild[static_cast<size_t>(child)] = true;
    }
    std::vector<int> roots;
    for (size_t i = 0; i < isChild.size(); ++i) {
        if (!isChild[i]) roots.push_back(static_cast<int>(i));
    }
    return roots;
}

// The accessors of a node's instances: all must be equally long.
uint64_t instanceCount(const SourceFile& source, const tinygltf::Model& model, size_t index) {
    const tinygltf::Node& node = model.nodes[index];
    const tinygltf::Value& attributes = node.extensions.at(kInstancing).Get("attributes");
    std::optional<uint64_t> count;
    for (const std::string& key : attributes.Keys()) {
        const auto accessor = static_cast<size_t>(attributes.Get(key).GetNumberAsInt());
        const uint64_t length = model.accessors[accessor].count;
        if (count && *count != length) {
            source.fail(place("nodes", index) + ".extensions." + kInstancing,
                        "has attributes of different lengths", kValidate);
        }
        count = length;
    }
    return count.value_or(0);
}

uint64_t meshTriangles(const tinygltf::Model& model, int mesh) {
    uint64_t triangles = 0;  // accessor counts end at 2^53: 2^11 of them fit, more saturate
    for (const tinygltf::Primitive& primitive :
         model.meshes[static_cast<size_t>(mesh)].primitives) {
        const uint64_t more = announcedTriangles(model, primitive);
        triangles = more > std::numeric_limits<uint64_t>::max() - triangles
                        ? std::numeric_limits<uint64_t>::max()
                        : triangles + more;
    }
    return triangles;
}

}  // namespace

Scene planScene(const SourceFile& source, const Document& document, uint64_t maxTriangles) {
    const tinygltf::Model& model = document.model;
    std::vector<bool> isReached(model.nodes.size());
    std::vector<uint64_t> trianglesOfMesh(model.meshes.size());
    for (size_t i = 0; i < model.meshes.size(); ++i) {
        trianglesOfMesh[i] = meshTriangles(model, static_cast<int>(i));
    }
    struct Visit {
        int node;
        uint32_t parent;
    };
    std::vector<Visit> stack;  // not the call stack: files nest a million nodes
    const auto push = [&](const std::vector<int>& nodes, uint32_t parent) {
        for (size_t i = nodes.size(); i-- > 0;) stack.push_back({nodes[i], parent});
    };
    Scene scene;
    long double triangles = 0;  // exact up to 2^64, and never wraps
    push(rootNodes(model), ObjectInfo::kNoParent);
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const auto index = static_cast<size_t>(visit.node);
        if (isReached[index]) {
            source.fail(place("nodes", index), "is reached twice: the nodes are not a tree",
                        kValidate);
        }
        isReached[index] = true;
        const tinygltf::Node& node = model.nodes[index];
        SceneNode& added = scene.nodes.emplace_back();
        added.node = visit.node;
        added.parent = visit.parent;
        added.isObject = node.mesh >= 0 || !node.children.empty();
        added.toScene = localTransform(node);
        if (visit.parent != ObjectInfo::kNoParent) {
            added.toScene = scene.nodes[visit.parent].toScene * added.toScene;
        }
        added.isInstanced = node.mesh >= 0 && node.extensions.contains(kInstancing);
        if (added.isInstanced) added.instances = instanceCount(source, model, index);
        if (node.mesh >= 0) {
            triangles += static_cast<long double>(trianglesOfMesh[static_cast<size_t>(node.mesh)]) *
                         static_cast<long double>(added.instances);
        }
        push(node.children, static_cast<uint32_t>(scene.nodes.size() - 1));
    }
    if (triangles > static_cast<long double>(maxTriangles)) {
        constexpr long double kMost = 1e18L;
        source.fail("scene",
                    "draws " + std::to_string(static_cast<uint64_t>(std::min(triangles, kMost))) +
                        " triangles with all instances, over the limit of " +
                        std::to_string(maxTriangles),
                    "raise --max-triangles if it is meant");
    }
    scene.triangles = static_cast<uint64_t>(triangles);
    return scene;
}

Instances::Instances(const SourceFile& source, const Document& document, Buffers& buffers,
                     const SceneNode& node)
    : count_(node.instances), toScene_(node.toScene) {
    if (!node.isInstanced) return;
    const auto index = static_cast<size_t>(node.node);
    const tinygltf::Value& attributes =
        document.model.nodes[index].extensions.at(kInstancing).Get("attributes");
    const auto open = [&](const char* name, int components, std::optional<AccessorView>& view) {
        if (!attributes.Has(name)) return;
        view.emplace(source, document, buffers, attributes.Get(name).GetNumberAsInt());
        if (view->components() == components) return;
        source.fail(place("nodes", index) + ".extensions." + kInstancing,
                    std::string(name) + " is not of type VEC" + std::to_string(components),
                    kValidate);
    };
    open("TRANSLATION", 3, translation_);
    open("ROTATION", 4, rotation_);
    open("SCALE", 3, scale_);
}

glm::dmat4 Instances::transform(uint64_t instance) const {
    if (!translation_ && !rotation_ && !scale_) return toScene_;
    std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> rotation{0, 0, 0, 1};
    const Selection one{instance, 1, {}};
    if (translation_) translation_->read(one, 3, translation.data());
    if (rotation_) rotation_->read(one, 4, rotation.data());
    if (scale_) scale_->read(one, 3, scale.data());
    return toScene_ * compose({translation[0], translation[1], translation[2]},
                              {rotation[3], rotation[0], rotation[1], rotation[2]},
                              {scale[0], scale[1], scale[2]});
}

}  // namespace pagoda::ooc::gltf
