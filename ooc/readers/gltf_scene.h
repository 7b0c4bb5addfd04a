// gltf_scene.h: what a glTF document draws, before any buffer is read: nodes in depth-first order
// with their transforms to the scene, instances, and the count of triangles.
#pragma once

#include "ooc/readers/gltf_accessor.h"
#include "ooc/readers/reader.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace pagoda::ooc::gltf {

struct SceneNode {
    int node = -1;                            // in the document
    uint32_t parent = ObjectInfo::kNoParent;  // index in Scene::nodes
    bool isObject = false;                    // has a mesh or children
    uint64_t instances = 1;                   // EXT_mesh_gpu_instancing
    bool isInstanced = false;
    glm::dmat4 toScene{1.0};
};

struct Scene {
    std::vector<SceneNode> nodes;  // parents before children
    uint64_t triangles = 0;        // drawn, instances multiplied
};

// Walks the default scene, else scene 0, else all nodes without a parent. Throws Error where a
// node is reached twice (a cycle, or two parents: the tree could unfold without end), and where
// the triangles exceed `maxTriangles`.
[[nodiscard]] Scene planScene(const SourceFile& source, const Document& document,
                              uint64_t maxTriangles);

// The transforms of a node's instances, read one by one: their number is not bounded by memory.
class Instances {
public:
    Instances(const SourceFile& source, const Document& document, Buffers& buffers,
              const SceneNode& node);
    [[nodiscard]] uint64_t count() const noexcept { return count_; }
    // To the scene.
    [[nodiscard]] glm::dmat4 transform(uint64_t instance) const;

private:
    uint64_t count_ = 1;
    glm::dmat4 toScene_;
    std::optional<AccessorView> translation_, rotation_, scale_;
};

}  // namespace pagoda::ooc::gltf
