#include "tools/generate/scene_kit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

// Coordinates are multiples of 1/32768 m: exact as floats up to 512 m from the origin.
Vec3d onGrid(const Vec3d& position) {
    return glm::round(position * 32768.0) / 32768.0;
}

Vec3d anyPerpendicular(const Vec3d& axis) {
    const Vec3d helper = std::abs(axis.z) < 0.9 ? Vec3d(0, 0, 1) : Vec3d(1, 0, 0);
    return glm::normalize(glm::cross(helper, axis));
}

}  // namespace

Frame Frame::turned(double radians) const {
    const double c = std::cos(radians), s = std::sin(radians);
    return {origin, c * x + s * y, c * y - s * x, z};
}

Frame Frame::quarterTurned(int quarters) const {
    Frame frame = *this;
    for (int i = 0; i < (quarters & 3); ++i) frame = {origin, frame.y, -frame.x, z};
    return frame;
}

Frame Frame::aligned(const Vec3d& at, const Vec3d& axis) const {
    const Vec3d up = glm::normalize(direction(axis));
    const Vec3d side = anyPerpendicular(up);
    return {point(at), side, glm::cross(up, side), up};
}

uint32_t SceneKit::addMaterial(std::string_view name, uint32_t rgb, double opacity) {
    const uint32_t alpha = static_cast<uint32_t>(std::lround(opacity * 255));
    const uint32_t colour = (rgb >> 16 & 255u) | (rgb & 0xFF00u) | (rgb & 255u) << 16 | alpha << 24;
    if (sink_ == nullptr) return materials_++;
    return sink_->addMaterial(
        {.name = std::string(name), .colour = colour, .isTranslucent = opacity < 1.0});
}

void SceneKit::beginGroup(const std::string& name) {
    const uint32_t parent = groups_.empty() ? ooc::ObjectInfo::kNoParent : groups_.back();
    groups_.push_back(sink_ == nullptr ? 0 : sink_->addObject({.name = name, .parent = parent}));
}

void SceneKit::endGroup() {
    groups_.pop_back();
}

void SceneKit::beginObject(const std::string& name) {
    ++objects_;
    if (sink_ == nullptr) return;
    flush();
    const uint32_t parent = groups_.empty() ? ooc::ObjectInfo::kNoParent : groups_.back();
    object_ = sink_->addObject({.name = name, .parent = parent});
}

void SceneKit::paint(uint32_t material) {
    if (material == material_) return;
    flush();
    material_ = material;
}

void SceneKit::flush() {
    flushBatch(flat_);
    flushBatch(smooth_);
}

void SceneKit::flushBatch(ooc::TriangleBatch& batch) {
    if (sink_ != nullptr && batch.triangleCount() > 0) {
        batch.object = object_;
        batch.material = material_;
        sink_->addTriangles(batch);
    }
    batch.clear();
}

void SceneKit::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    ++triangles_;
    if (sink_ == nullptr) return;
    for (const Vec3d& corner : {a, b, c}) flat_.positions.push_back(onGrid(corner));
    if (flat_.triangleCount() >= ooc::kBatchTriangles) flushBatch(flat_);
}

void SceneKit::quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    triangle(a, b, c);
    triangle(a, c, d);
}

void SceneKit::smoothTriangle(const Vec3d (&corners)[3], const Vec3d (&normals)[3]) {
    ++triangles_;
    if (sink_ == nullptr) return;
    for (int i = 0; i < 3; ++i) {
        smooth_.positions.push_back(onGrid(corners[i]));
        smooth_.normals.push_back(Vec3f(normals[i]));
    }
    if (smooth_.triangleCount() >= ooc::kBatchTriangles) flushBatch(smooth_);
}

void SceneKit::smoothQuad(const Vec3d (&corners)[4], const Vec3d (&normals)[4]) {
    smoothTriangle({corners[0], corners[1], corners[2]}, {normals[0], normals[1], normals[2]});
    smoothTriangle({corners[0], corners[2], corners[3]}, {normals[0], normals[2], normals[3]});
}

int SceneKit::sides(double radius) const {
    // About 8 sides for a hand rail, 16 for a large pipe, 48 for a tank.
    const double wanted = 16.0 * std::sqrt(detail_) * std::pow(radius / 0.2, 0.35);
    return std::clamp(static_cast<int>(std::lround(wanted)), 5, 384);
}

void SceneKit::prepareCircle(int sides) {
    if (sides == circleSides_) return;
    circleSides_ = sides;
    circle_.resize(static_cast<size_t>(sides) + 1);
    for (int i = 0; i <= sides; ++i) {
        const double angle = 2 * std::numbers::pi * (i % sides) / sides;
        circle_[static_cast<size_t>(i)] = {std::cos(angle), std::sin(angle)};
    }
}

void SceneKit::sweep(std::span<const Ring> rings, double radius, bool capped, bool closed) {
    const int count = sides(radius);
    const size_t spans = rings.size() - (closed ? 0 : 1);
    if (sink_ == nullptr) {
        triangles_ += 2 * spans * static_cast<size_t>(count);
        if (capped) triangles_ += 2 * static_cast<uint64_t>(count - 2);
        return;
    }
    prepareCircle(count);
    const auto outward = [&](const Ring& ring, size_t i) {
        return circle_[i].x * ring.u + circle_[i].y * ring.v;
    };
    for (size_t s = 0; s < spans; ++s) {
        const Ring& lower = rings[s];
        const Ring& upper = rings[(s + 1) % rings.size()];
        for (size_t i = 0; i < static_cast<size_t>(count); ++i) {
            const Vec3d normals[4] = {outward(lower, i), outward(lower, i + 1),
                                      outward(upper, i + 1), outward(upper, i)};
            const Vec3d corners[4] = {
                lower.centre + radius * normals[0], lower.centre + radius * normals[1],
                upper.centre + radius * normals[2], upper.centre + radius * normals[3]};
            smoothQuad(corners, normals);
        }
    }
    if (!capped) return;
    disc(rings.front(), radius, true);
    disc(rings.back(), radius, false);
}

void SceneKit::disc(const Ring& ring, double radius, bool isTurned) {
    const auto corner = [&](int i) {
        const glm::dvec2 direction = circle_[static_cast<size_t>(i)];
        return ring.centre + radius * (direction.x * ring.u + direction.y * ring.v);
    };
    for (int i = 1; i + 1 < circleSides_; ++i) {
        if (isTurned) {
            triangle(corner(0), corner(i + 1), corner(i));
        } else {
            triangle(corner(0), corner(i), corner(i + 1));
        }
    }
}

}  // namespace pagoda::tools
