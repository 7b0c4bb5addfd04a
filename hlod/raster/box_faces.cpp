#include "hlod/raster/box_faces.h"

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

constexpr double kGrowPx = 0.5, kGrowShare = 1e-5;
// Projected corners are rounded, edges are not: no pixel centre may fall between the two.
constexpr double kSlackPx = 1e-6;
constexpr double kLeastDepth = 1e-3;  // in near planes: corners closer to the eye project nowhere

// Faces as rings of corners, counter-clockwise from outside; bits 0 to 2 of a corner choose between
// least and greatest x, y and z. In the order -x, +x, -y, +y, -z, +z.
constexpr std::array<std::array<size_t, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

// Zero on the line from p to q, positive on its left. Corners are homogeneous, so that those behind
// the eye need no clipping.
ScreenPlane edge(const Vec3d& p, const Vec3d& q) {
    const Vec3d normal = glm::cross(p, q);
    return {normal.x, normal.y, normal.z};
}

}  // namespace

void BoxFaces::setView(const View& view) {
    eye_ = view.eye();
    right_ = view.right();
    up_ = view.up();
    forward_ = view.forward();
    tanX_ = view.tanX();
    tanY_ = view.tanY();
    near_ = view.nearModelUnits();
    width_ = view.camera().widthPx;
    height_ = view.camera().heightPx;
}

std::span<const BoxFace> BoxFaces::facing(const Box3d& box, std::array<BoxFace, 3>& faces) const {
    const Vec3d least = box.min - eye_, most = box.max - eye_;
    const double pixel = kGrowPx * 2.0 * tanY_ / height_ * glm::length(0.5 * (least + most));
    const Vec3d grow =
        glm::max(Vec3d(pixel), kGrowShare * glm::max(glm::abs(least), glm::abs(most)));
    const Vec3d low = least - grow, high = most + grow;
    // (x w, y w, w) of a pixel (x, y) and a depth w, by axes.
    const auto place = [&](const Vec3d& p) {
        const double w = glm::dot(forward_, p);
        return Vec3d(0.5 * width_ * (glm::dot(right_, p) / tanX_ + w),
                     0.5 * height_ * (glm::dot(up_, p) / tanY_ + w), w);
    };
    std::array<Vec3d, 8> corners;
    for (size_t i = 0; i < 8; ++i) {
        corners[i] = place({(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                            (i & 4) != 0 ? high.z : low.z});
    }
    // The eye is at the origin: a face is a front face when the origin is on its outer side.
    const double sides[6] = {low.x, high.x, low.y, high.y, low.z, high.z};
    size_t count = 0;
    for (size_t side = 0; side < 6; ++side) {
        if (!(side % 2 == 0 ? sides[side] > 0.0 : sides[side] < 0.0)) continue;
        BoxFace& face = faces[count++];
        Quad quad;
        for (size_t i = 0; i < 4; ++i) quad[i] = corners[kFaces[side][i]];
        for (size_t i = 0; i < 4; ++i) face.edges[i] = edge(quad[i], quad[(i + 1) % 4]);
        face.rect = rectOf(quad);
        const auto axis = static_cast<glm::length_t>(side / 2);
        // The ray through a pixel, one unit along the view, reaches the face after side /
        // ray[axis]; reversed depth is affine over the screen.
        const double scale = near_ / sides[side];
        face.depth.a = scale * (2.0 * tanX_ / width_ * right_[axis]);
        face.depth.b = scale * (2.0 * tanY_ / height_ * up_[axis]);
        face.depth.c = scale * (forward_[axis] - tanX_ * right_[axis] - tanY_ * up_[axis]);
    }
    return {faces.data(), count};
}

// All of the picture when a corner is behind the eye.
BoxFace::Rect BoxFaces::rectOf(const Quad& quad) const {
    const BoxFace::Rect all{0, 0, width_ - 1, height_ - 1};
    double minX = 1e300, maxX = -1e300, minY = 1e300, maxY = -1e300;
    for (const Vec3d& corner : quad) {
        if (!(corner.z > near_ * kLeastDepth)) return all;
        minX = std::min(minX, corner.x / corner.z);
        maxX = std::max(maxX, corner.x / corner.z);
        minY = std::min(minY, corner.y / corner.z);
        maxY = std::max(maxY, corner.y / corner.z);
    }
    const auto first = [](double least, int size) {
        return static_cast<int>(std::clamp(std::ceil(least - 0.5 - kSlackPx), 0.0, 1.0 * size));
    };
    const auto last = [](double most, int size) {
        return static_cast<int>(std::clamp(std::floor(most - 0.5 + kSlackPx), -1.0, size - 1.0));
    };
    return {first(minX, width_), first(minY, height_), last(maxX, width_), last(maxY, height_)};
}

}  // namespace pagoda::hlod
