#include "ooc/readers/triangle_batcher.h"

#include <cmath>

namespace pagoda::ooc {

TriangleBatcher::TriangleBatcher(TriangleSink& sink, bool hasColours, bool hasNormals)
    : sink_(sink), hasColours_(hasColours), hasNormals_(hasNormals) {
    resize(kBatchTriangles);
}

void TriangleBatcher::resize(size_t triangles) {
    batch_.positions.resize(3 * triangles);
    if (hasColours_) batch_.colours.resize(3 * triangles);
    if (hasNormals_) batch_.normals.resize(3 * triangles);
}

void TriangleBatcher::setTarget(uint32_t object, uint32_t material) {
    if (object == batch_.object && material == batch_.material) return;
    flush();
    batch_.object = object;
    batch_.material = material;
}

void TriangleBatcher::addNormals(const Corner& a, const Corner& b, const Corner& c) {
    const std::array corners = {&a, &b, &c};
    for (size_t k = 0; k < 3; ++k) {
        Vec3f normal = corners[k]->normal;
        if (normal == Vec3f(0)) {
            const Vec3d face = glm::cross(b.position - a.position, c.position - a.position);
            normal = unitNormal(face.x, face.y, face.z);
            if (normal == Vec3f(0)) normal = Vec3f(0, 0, 1);
        }
        batch_.normals[3 * count_ + k] = normal;
    }
}

void TriangleBatcher::flush() {
    if (count_ == 0) return;
    if (count_ != kBatchTriangles) resize(count_);
    const bool wasShort = count_ != kBatchTriangles;
    count_ = 0;
    sink_.addTriangles(batch_);
    if (wasShort) resize(kBatchTriangles);
}

void TriangleBatcher::finish() {
    flush();
    for (size_t reason = 0; reason < dropped_.size(); ++reason) {
        if (dropped_[reason] > 0) sink_.dropped(static_cast<DropReason>(reason), dropped_[reason]);
        dropped_[reason] = 0;
    }
}

Vec3f unitNormal(double x, double y, double z) {
    const double largest = std::fmax(std::fmax(std::fabs(x), std::fabs(y)), std::fabs(z));
    if (!(largest > 0.0) || !std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
        return Vec3f(0);
    }
    const Vec3d scaled = Vec3d(x, y, z) / largest;  // so that squares neither vanish nor overflow
    return Vec3f(scaled / std::sqrt(glm::dot(scaled, scaled)));
}

}  // namespace pagoda::ooc
