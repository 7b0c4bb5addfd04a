#include "hlod/raster/box_raster.h"

#include <algorithm>
#include <cassert>

namespace pagoda::hlod {
namespace {

constexpr int kBlock = 8;

}  // namespace

void BoxRaster::setDepths(const View& view, std::span<const float> depths) {
    faces_.setView(view);
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

void BoxRaster::visiblePixels(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) const {
    assert(boxesModel.size() == pixels.size());
    for (size_t i = 0; i < boxesModel.size(); ++i) pixels[i] = visiblePixels(boxesModel[i]);
}

uint64_t BoxRaster::visiblePixels(const Box3d& box) const {
    std::array<BoxFace, 3> faces;
    const std::span<const BoxFace> facing = faces_.facing(box, faces);
    if (facing.empty()) return static_cast<uint64_t>(width_) * static_cast<uint64_t>(height_);
    uint64_t pixels = 0;
    for (const BoxFace& face : facing) pixels += visiblePixels(face);
    return pixels;
}

uint64_t BoxRaster::visiblePixels(const BoxFace& face) const {
    if (face.rect.isEmpty()) return 0;
    const auto [x0, y0, x1, y1] = face.rect;
    const ScreenPlane& depth = face.depth;
    const std::array<ScreenPlane, 4>& edges = face.edges;

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
            for (const ScreenPlane& line : edges) {
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
