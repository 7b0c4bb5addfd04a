#include "hlod/raster/box_raster.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace pagoda::hlod {
namespace {

constexpr int kBlock = 8;
constexpr double kGrowPx = 0.5, kGrowShare = 1e-5;
// Projected corners are rounded, edges are not: no pixel centre may fall between the two.
constexpr double kSlackPx = 1e-6;
constexpr double kLeastDepth = 1e-3;  // in near planes: corners closer to the eye project nowhere

// Faces as rings of corners, counter-clockwise from outside; bits 0 to 2 of a corner choose between
// least and greatest x, y and z. In the order -x, +x, -y, +y, -z, +z.
constexpr std::array<std::array<int, 4>, 6> kFaces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

// a x + b y + c of a plane over the screen.
struct Plane {
    double a = 0, b = 0, c = 0;
    [[nodiscard]] double at(double x, double y) const { return a * x + b * y + c; }
    // Greatest over a rectangle of pixel centres.
    [[nodiscard]] double greatest(double x0, double y0, double x1, double y1) const {
        return at(a > 0 ? x1 : x0, b > 0 ? y1 : y0);
    }
};

// Zero on the line from p to q, positive on its left. Corners are homogeneous, so that those behind
// the eye need no clipping.
Plane edge(const Vec3d& p, const Vec3d& q) {
    const Vec3d normal = glm::cross(p, q);
    return {normal.x, normal.y, normal.z};
}

}  // namespace

void BoxRaster::setDepths(const View& view, std::span<const float> depths) {
    eye_ = view.eye();
    right_ = view.right();
    up_ = view.up();
    forward_ = view.forward();
    tanX_ = view.tanX();
    tanY_ = view.tanY();
    near_ = view.nearModelUnits();
    width_ = view.camera().widthPx;
    height_ = view.camera().heightPx;
    assert(depths.size() == static_cast<size_t>(width_) * static_cast<size_t>(height_));
    depths_ = depths;
    blocksX_ = (width_ + kBlock - 1) / kBlock;
    blocksY_ = (height_ + kBlock - 1) / kBlock;
    farthest_.assign(static_cast<size_t>(blocksX_) * static_cast<size_t>(blocksY_), 1e30f);
    for (int y = 0; y < height_; ++y) {
        const float* row = depths.data() + static_cast<ptrdiff_t>(y) * width_;
        float* blocks = farthest_.data() + static_cast<ptrdiff_t>(y / kBlock) * blocksX_;
        for (int x = 0; x < width_; ++x) blocks[x / kBlock] = std::min(blocks[x / kBlock], row[x]);
    }
}

uint64_t BoxRaster::visiblePixels(const Box3d& box) const {
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
    uint64_t pixels = 0;
    bool hasFront = false;
    for (size_t face = 0; face < 6; ++face) {
        if (!(face % 2 == 0 ? sides[face] > 0.0 : sides[face] < 0.0)) continue;
        hasFront = true;
        Quad quad;
        for (size_t i = 0; i < 4; ++i)
            quad.corners[i] = corners[static_cast<size_t>(kFaces[face][i])];
        const auto axis = static_cast<glm::length_t>(face / 2);
        // The ray through a pixel, one unit along the view, reaches the face after side /
        // ray[axis].
        const double scale = near_ / sides[face];
        const double x = 2.0 * tanX_ / width_ * right_[axis], y = 2.0 * tanY_ / height_ * up_[axis];
        quad.depth[0] = scale * x;
        quad.depth[1] = scale * y;
        quad.depth[2] = scale * (forward_[axis] - tanX_ * right_[axis] - tanY_ * up_[axis]);
        pixels += visiblePixels(quad);
    }
    // The grown box holds the eye: visible.
    return hasFront ? pixels : static_cast<uint64_t>(width_) * static_cast<uint64_t>(height_);
}

// Pixels whose centres may lie inside; all when a corner is behind the eye.
BoxRaster::Rect BoxRaster::rectOf(const Quad& quad) const {
    Rect rect{0, 0, width_ - 1, height_ - 1};
    double minX = 1e300, maxX = -1e300, minY = 1e300, maxY = -1e300;
    for (const Vec3d& corner : quad.corners) {
        if (!(corner.z > near_ * kLeastDepth)) return rect;
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

// A front face, counter-clockwise on the screen. Reversed depth is affine over the screen, so that
// one plane gives it everywhere.
uint64_t BoxRaster::visiblePixels(const Quad& quad) const {
    const auto [x0, y0, x1, y1] = rectOf(quad);
    if (x0 > x1 || y0 > y1) return 0;
    const Plane depth{quad.depth[0], quad.depth[1], quad.depth[2]};
    std::array<Plane, 4> edges;
    for (size_t i = 0; i < 4; ++i) edges[i] = edge(quad.corners[i], quad.corners[(i + 1) % 4]);

    uint64_t pixels = 0;
    for (int blockY = y0 / kBlock; blockY <= y1 / kBlock; ++blockY) {
        const int top = std::max(blockY * kBlock, y0),
                  bottom = std::min((blockY + 1) * kBlock - 1, y1);
        for (int blockX = x0 / kBlock; blockX <= x1 / kBlock; ++blockX) {
            const int left = std::max(blockX * kBlock, x0);
            const int right = std::min((blockX + 1) * kBlock - 1, x1);
            const double cx0 = left + 0.5, cx1 = right + 0.5, cy0 = top + 0.5, cy1 = bottom + 0.5;
            const float farthest =
                farthest_[static_cast<size_t>(blockY) * static_cast<size_t>(blocksX_) +
                          static_cast<size_t>(blockX)];
            if (depth.greatest(cx0, cy0, cx1, cy1) < farthest) continue;
            bool isOutside = false;
            for (const Plane& line : edges) {
                isOutside = isOutside || line.greatest(cx0, cy0, cx1, cy1) < 0.0;
            }
            if (isOutside) continue;
            for (int y = top; y <= bottom; ++y) {
                const float* row = depths_.data() + static_cast<ptrdiff_t>(y) * width_;
                for (int x = left; x <= right; ++x) {
                    const double px = x + 0.5, py = y + 0.5;
                    const bool isInside = edges[0].at(px, py) >= 0 && edges[1].at(px, py) >= 0 &&
                                          edges[2].at(px, py) >= 0 && edges[3].at(px, py) >= 0;
                    pixels += isInside && depth.at(px, py) >= row[x];
                }
            }
        }
    }
    return pixels;
}

}  // namespace pagoda::hlod
