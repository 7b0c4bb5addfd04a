#include "hlod/strategies/occlusion_grid.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace pagoda::hlod {

namespace {

constexpr double kBackground = std::numeric_limits<double>::infinity();

bool isEmpty(const PixelRect& rectangle) {
    return rectangle.minX >= rectangle.maxX || rectangle.minY >= rectangle.maxY;
}

PixelRect intersection(const PixelRect& a, const PixelRect& b) {
    return {std::max(a.minX, b.minX), std::max(a.minY, b.minY), std::min(a.maxX, b.maxX),
            std::min(a.maxY, b.maxY)};
}

bool contains(const PixelRect& outer, const PixelRect& inner) {
    return outer.minX <= inner.minX && outer.minY <= inner.minY && outer.maxX >= inner.maxX &&
           outer.maxY >= inner.maxY;
}

}  // namespace

OcclusionGrid::OcclusionGrid(int width, int height, const OcclusionGridOptions& options)
    : options_(options),
      width_(width),
      height_(height),
      columns_((width + options.cellPixels - 1) / options.cellPixels),
      rows_((height + options.cellPixels - 1) / options.cellPixels) {
    assert(width > 0 && height > 0 && options.cellPixels > 0);
    beginFrame();
}

void OcclusionGrid::beginFrame() {
    const size_t count = static_cast<size_t>(columns_) * static_cast<size_t>(rows_);
    cells_.assign(count, Cell{CellState::Free, kBackground, false, false});
}

bool OcclusionGrid::isVisible(const PixelRect& rectangle, double nearDepth,
                              DepthVisibility& depths) {
    const PixelRect inside = clipped(rectangle);
    if (isEmpty(inside)) return false;
    if (isFreeUnasked(inside, nearDepth)) return true;
    for (const int index : internalToRead_) {
        refresh(index, depths);
        const Cell& cell = cells_[static_cast<size_t>(index)];
        const bool isFree = options_.variant == GridVariant::Occlusion
                                ? cell.state != CellState::Full
                                : nearDepth <= cell.farDepth;
        if (isFree) return true;
    }
    for (const int index : borderToRead_) {
        if (!isSeenIn(intersection(pixelsOf(index), inside), nearDepth, depths)) continue;
        // A free pixel was seen: the cell is not full. (DepthBuffer stores nothing.)
        if (options_.variant == GridVariant::Occlusion)
            cells_[static_cast<size_t>(index)].state = CellState::Partial;
        return true;
    }
    return false;
}

void OcclusionGrid::markDrawn(const PixelRect& rectangle, DepthVisibility& depths) {
    const PixelRect inside = clipped(rectangle);
    if (isEmpty(inside)) return;
    const CellRange range = cellsOf(inside);
    for (int y = range.minY; y < range.maxY; ++y) {
        for (int x = range.minX; x < range.maxX; ++x) {
            const int index = y * columns_ + x;
            Cell& cell = cells_[static_cast<size_t>(index)];
            if (cell.state == CellState::Full) continue;
            cell.isTouched = true;
            if (options_.busy) {
                refresh(index, depths);
                continue;
            }
            if (options_.variant == GridVariant::Occlusion) cell.state = CellState::Outdated;
            cell.isOutdated = true;
        }
    }
}

PixelRect OcclusionGrid::clipped(const PixelRect& rectangle) const {
    return intersection(rectangle, {0, 0, width_, height_});
}

OcclusionGrid::CellRange OcclusionGrid::cellsOf(const PixelRect& r) const {
    const int size = options_.cellPixels;
    return {r.minX / size, r.minY / size, (r.maxX - 1) / size + 1, (r.maxY - 1) / size + 1};
}

PixelRect OcclusionGrid::pixelsOf(int index) const {
    const int size = options_.cellPixels;
    const int x = index % columns_ * size, y = index / columns_ * size;
    return clipped({x, y, x + size, y + size});
}

bool OcclusionGrid::isFreeUnasked(const PixelRect& rectangle, double nearDepth) {
    internalToRead_.clear();
    borderToRead_.clear();
    const CellRange range = cellsOf(rectangle);
    // The stages of the paper one after the other: either pass may end the test.
    for (const bool wantInternal : {true, false}) {
        for (int y = range.minY; y < range.maxY; ++y) {
            for (int x = range.minX; x < range.maxX; ++x) {
                const int index = y * columns_ + x;
                if (contains(rectangle, pixelsOf(index)) != wantInternal) continue;
                const Cell& cell = cells_[static_cast<size_t>(index)];
                if (wantInternal ? isInternalFree(cell, index, nearDepth)
                                 : isBorderFree(cell, index, nearDepth))
                    return true;
            }
        }
    }
    return false;
}

bool OcclusionGrid::isInternalFree(const Cell& cell, int index, double nearDepth) {
    if (options_.variant == GridVariant::Occlusion) {
        if (cell.state == CellState::Full) return false;
        if (cell.state != CellState::Outdated) return true;
    } else {
        // Depths only fall: what lies behind an outdated one lies behind the true one, too.
        if (nearDepth > cell.farDepth) return false;
        if (!cell.isOutdated) return true;
    }
    internalToRead_.push_back(index);
    return false;
}

bool OcclusionGrid::isBorderFree(const Cell& cell, int index, double nearDepth) {
    if (options_.variant == GridVariant::Occlusion) {
        if (cell.state == CellState::Full) return false;
        if (cell.state == CellState::Free) return true;
    } else {
        // An infinite depth may be a stale one, or a single free pixel elsewhere in the cell; the
        // paper stops here all the same.
        const bool mayStop = !cell.isTouched || !options_.readTouchedBorders;
        if (cell.farDepth == kBackground && mayStop) return true;
        if (nearDepth > cell.farDepth) return false;
    }
    borderToRead_.push_back(index);
    return false;
}

void OcclusionGrid::refresh(int index, DepthVisibility& depths) {
    Cell& cell = cells_[static_cast<size_t>(index)];
    ++pixelQueries_;
    if (options_.variant == GridVariant::Occlusion) {
        cell.state = depths.anyFree(pixelsOf(index)) ? CellState::Partial : CellState::Full;
    } else {
        cell.farDepth = depths.maxDepth(pixelsOf(index));
        cell.isOutdated = false;
    }
}

bool OcclusionGrid::isSeenIn(const PixelRect& rectangle, double nearDepth,
                             DepthVisibility& depths) {
    ++pixelQueries_;
    if (options_.variant == GridVariant::Occlusion) return depths.anyFree(rectangle);
    return nearDepth <= depths.maxDepth(rectangle);
}

}  // namespace pagoda::hlod
