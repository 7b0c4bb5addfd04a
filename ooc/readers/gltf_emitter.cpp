#include "ooc/readers/gltf_emitter.h"

#include <algorithm>
#include <cmath>

namespace pagoda::ooc::gltf {
namespace {

bool isFinite(const Vec3d& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Normals go by the inverse transpose, which is the cofactor matrix but for a factor whose sign is
// that of the determinant. Scaled to numbers a float can hold.
glm::mat3 normalTransform(const glm::dmat3& linear) {
    double greatest = 0;
    for (int i = 0; i < 9; ++i) greatest = std::max(greatest, std::abs(linear[i / 3][i % 3]));
    const glm::dmat3 m = greatest > 0 ? linear / greatest : linear;
    glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    if (glm::determinant(m) < 0) cofactors = -cofactors;
    return glm::mat3(cofactors);
}

}  // namespace

void Emitter::emit(const DecodedPrimitive& primitive, const glm::dmat4& toScene, uint32_t object,
                   uint32_t material) {
    const bool isAllFinite = transformPositions(primitive, toScene);
    const glm::dmat3 linear(toScene);
    isMirrored_ = glm::determinant(linear) < 0;
    if (!primitive.normals.empty()) transformNormals(primitive, linear);
    batch_.object = object;
    batch_.material = material;
    const size_t corners = primitive.corners.size();
    for (size_t first = 0; first < corners; first += 3 * kBatchTriangles) {
        fillBatch(primitive, first, std::min(corners, first + 3 * kBatchTriangles));
        const uint64_t gone = isAllFinite ? 0 : dropNonFinite();
        if (!batch_.positions.empty()) sink_.addTriangles(batch_);
        if (gone > 0) sink_.dropped(DropReason::NonFinite, gone);
    }
}

bool Emitter::transformPositions(const DecodedPrimitive& primitive, const glm::dmat4& toScene) {
    const size_t count = primitive.positions.size();
    positions_.resize(count);
    const Vec3d x(toScene[0]), y(toScene[1]), z(toScene[2]), origin(toScene[3]);
    double probe = 0;  // a product with zero is NaN where a factor is NaN or infinite
    for (size_t i = 0; i < count; ++i) {
        const Vec3d& p = primitive.positions[i];
        const Vec3d q = x * p.x + y * p.y + z * p.z + origin;
        positions_[i] = q;
        probe += q.x * 0.0 + q.y * 0.0 + q.z * 0.0;
    }
    return probe == 0.0;
}

void Emitter::transformNormals(const DecodedPrimitive& primitive, const glm::dmat3& linear) {
    const glm::mat3 transform = normalTransform(linear);
    const size_t count = primitive.normals.size();
    normals_.resize(count);
    for (size_t i = 0; i < count; ++i) {
        const Vec3f normal = transform * primitive.normals[i];
        const float squared = glm::dot(normal, normal);
        normals_[i] = squared > 0 ? normal / std::sqrt(squared) : primitive.normals[i];
    }
}

void Emitter::fillBatch(const DecodedPrimitive& primitive, size_t firstCorner, size_t lastCorner) {
    const size_t count = lastCorner - firstCorner;
    const uint32_t* corners = primitive.corners.data() + firstCorner;
    const auto gather = [&](const auto& from, auto& to) {
        to.resize(count);
        const size_t second = isMirrored_ ? 2 : 1, third = isMirrored_ ? 1 : 2;
        for (size_t at = 0; at < count; at += 3) {
            to[at] = from[corners[at]];
            to[at + 1] = from[corners[at + second]];
            to[at + 2] = from[corners[at + third]];
        }
    };
    batch_.clear();
    gather(positions_, batch_.positions);
    if (!primitive.normals.empty()) gather(normals_, batch_.normals);
    if (!primitive.colours.empty()) gather(primitive.colours, batch_.colours);
}

uint64_t Emitter::dropNonFinite() {
    const size_t count = batch_.positions.size();
    size_t kept = 0;
    for (size_t at = 0; at < count; at += 3) {
        const Vec3d* p = &batch_.positions[at];
        if (!isFinite(p[0]) || !isFinite(p[1]) || !isFinite(p[2])) continue;
        for (size_t c = 0; c < 3; ++c) {
            batch_.positions[kept + c] = batch_.positions[at + c];
            if (!batch_.normals.empty()) batch_.normals[kept + c] = batch_.normals[at + c];
            if (!batch_.colours.empty()) batch_.colours[kept + c] = batch_.colours[at + c];
        }
        kept += 3;
    }
    batch_.positions.resize(kept);
    if (!batch_.normals.empty()) batch_.normals.resize(kept);
    if (!batch_.colours.empty()) batch_.colours.resize(kept);
    return (count - kept) / 3;
}

}  // namespace pagoda::ooc::gltf
