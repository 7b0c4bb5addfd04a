// gltf_emitter.h: puts a decoded primitive into the scene: transforms it and hands on batches.
#pragma once

#include "ooc/readers/gltf_primitive.h"
#include "ooc/readers/reader.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace pagoda::ooc::gltf {

// Keeps its arrays between calls: thousands of small instances pass through.
class Emitter {
public:
    explicit Emitter(TriangleSink& sink) : sink_(sink) {}

    // Positions by `toScene` in double; normals by its inverse transpose; where it mirrors, two
    // corners of each triangle change places, so that the outside stays outside. Triangles that
    // leave the range of a double are dropped.
    void emit(const DecodedPrimitive& primitive, const glm::dmat4& toScene, uint32_t object,
              uint32_t material);

private:
    [[nodiscard]] bool transformPositions(const DecodedPrimitive& primitive,
                                          const glm::dmat4& toScene);
    void transformNormals(const DecodedPrimitive& primitive, const glm::dmat3& linear);
    void fillBatch(const DecodedPrimitive& primitive, size_t firstCorner, size_t lastCorner);
    uint64_t dropNonFinite();

    TriangleSink& sink_;
    std::vector<Vec3d> positions_;
    std::vector<Vec3f> normals_;
    TriangleBatch batch_;
    bool isMirrored_ = false;
};

}  // namespace pagoda::ooc::gltf
