#include "hlod/raster/box_raster.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace pagoda::hlod {
namespace {

constexpr int kBlock = 8;
constexpr double kGrowPx = 0.5, kGrowShare = 1e-5;

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

// Zero on the line from p to q, positive on its left.
Plane edge(double px, double py, double qx, double qy) {
    const double a = py - qy, b = qx - px;
    return {a, b, -(a * px + b * py)};
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
    std::array<Corner, 8> corners;
    for (size_t i = 0; i < 8; ++i) {
        const Vec3d p((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                      (i & 4) != 0 ? high.z : low.z);
        // Growing may push a corner behind the eye: it is kept in front, where it is nearest.
        const double depth = std::max(glm::dot(forward_, p), near_ * 1e-3);
        corners[i] = {0.5 * width_ * (1.0 + glm::dot(right_, p) / (depth * tanX_)),
                      0.5 * height_ * (1.0 + glm::dot(up_, p) / (depth * tanY_)), near_ / depth};
    }
    // The eye is at the origin: a face is a front face when the origin is on its outer side.
    const bool isFront[6] = {low.x > 0, high.x<0, low.y> 0, high.y<0, low.z> 0, high.z < 0};
    uint64_t pixels = 0;
    bool hasFront = false;
    for (size_t face = 0; face < 6; ++face) {
        if (!isFront[face]) continue;
        hasFront = true;
        const auto& ring = kFaces[face];
        pixels += visiblePixels(
            corners[static_cast<size_t>(ring[0])], corners[static_cast<size_t>(ring[1])],
            corners[static_cast<size_t>(ring[2])], corners[static_cast<size_t>(ring[3])]);
    }
    // The grown box holds the eye: visible.
    return hasFront ? pixels : static_cast<uint64_t>(width_) * static_cast<uint64_t>(height_);
}

// A convex quadrilateral, counter-clockwise on the screen. Reversed depth is affine over the
// screen, so that one plane gives it everywhere.
uint64_t BoxRaster::visiblePixels(const Corner& a, const Corner& b, const Corner& c,
                                  const Corner& d) const {
    const std::array<const Corner*, 4> ring = {&a, &b, &c, &d};
    double minX = a.x, maxX = a.x, minY = a.y, maxY = a.y;
    for (const Corner* corner : ring) {
        minX = std::min(minX, corner->x);
        maxX = std::max(maxX, corner->x);
        minY = std::min(minY, corner->y);
        maxY = std::max(maxY, corner->y);
    }
    const int x0 = static_cast<int>(std::clamp(std::ceil(minX - 0.5), 0.0, 1.0 * width_));
    const int x1 = static_cast<int>(std::clamp(std::floor(maxX - 0.5), -1.0, width_ - 1.0));
    const int y0 = static_cast<int>(std::clamp(std::ceil(minY - 0.5), 0.0, 1.0 * height_));
    const int y1 = static_cast<int>(std::clamp(std::floor(maxY - 0.5), -1.0, height_ - 1.0));
    if (x0 > x1 || y0 > y1) return 0;

    const double ux = b.x - a.x, uy = b.y - a.y, uz = b.depth - a.depth;
    const double vx = d.x - a.x, vy = d.y - a.y, vz = d.depth - a.depth;
    const double area = ux * vy - uy * vx;
    if (!(area > 0.0)) return 0;  // edge-on
    Plane depth;
    depth.a = (uz * vy - uy * vz) / area;
    depth.b = (ux * vz - uz * vx) / area;
    depth.c = a.depth - depth.a * a.x - depth.b * a.y;
    std::array<Plane, 4> edges;
    for (size_t i = 0; i < 4; ++i) {
        edges[i] = edge(ring[i]->x, ring[i]->y, ring[(i + 1) % 4]->x, ring[(i + 1) % 4]->y);
    }

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
