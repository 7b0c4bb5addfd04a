#include "hlod/strategies/slab_grid.h"

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

// Cells that [least, most] meets along one axis. One that ends on a plane does not reach beyond.
struct Span {
    int first = 0, last = 0;
};

Span spanOf(double least, double most, int cells) {
    const auto clamped = [cells](double at) {
        return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(cells - 1)));
    };
    const int first = clamped(std::floor(least));
    return {first, std::max(first, clamped(std::ceil(most) - 1.0))};
}

}  // namespace

Grid gridOver(const Box3d& box, int resolution) {
    const Vec3d size = box.max - box.min;
    Grid grid{.origin = box.min};
    grid.side = std::max({size.x, size.y, size.z}) / resolution;
    if (!(grid.side > 0.0)) return {.origin = box.min};
    for (int k = 0; k < 3; ++k) {
        grid.cells[k] = std::clamp(static_cast<int>(std::ceil(size[k] / grid.side)), 1, resolution);
    }
    return grid;
}

SlabOrder::SlabOrder(const Vec3d& forward, const Vec3d& eye, const Grid& grid)
    : weights_(glm::abs(forward)), eyeCell_(glm::floor((eye - grid.origin) / grid.side)) {
    weights_ /= std::max({weights_.x, weights_.y, weights_.z});
}

double SlabOrder::depth(const Vec3i& cell) const {
    const Vec3d steps = glm::abs(Vec3d(cell) - eyeCell_);
    return weights_.x * steps.x + weights_.y * steps.y + weights_.z * steps.z;
}

double SlabOrder::slab(double depth) {
    return std::floor(depth);
}

void GridCells::cut(const Grid& grid, const GridPart& part) {
    Span spans[3];
    for (int k = 0; k < 3; ++k) {
        spans[k] = spanOf((part.boxModel.min[k] - grid.origin[k]) / grid.side,
                          (part.boxModel.max[k] - grid.origin[k]) / grid.side, grid.cells[k]);
    }
    // The first and the last cell take all up to the part's own end.
    const auto ends = [&](int k, int at, Box3d& box) {
        const auto plane = [&](int i) { return grid.origin[k] + grid.side * i; };
        box.min[k] = at == spans[k].first ? part.boxModel.min[k] : plane(at);
        box.max[k] = at == spans[k].last ? part.boxModel.max[k] : plane(at + 1);
    };
    Box3d box = part.boxModel;
    for (int z = spans[2].first; z <= spans[2].last; ++z) {
        ends(2, z, box);
        for (int y = spans[1].first; y <= spans[1].last; ++y) {
            ends(1, y, box);
            for (int x = spans[0].first; x <= spans[0].last; ++x) {
                ends(0, x, box);
                const int number = x + grid.cells.x * (y + grid.cells.y * z);
                cuts_.push_back({static_cast<uint32_t>(number), {part.box, box}});
            }
        }
    }
}

void GridCells::fill(const Grid& grid, const SlabOrder& order, std::span<const GridPart> from) {
    cuts_.clear();
    cells.clear();
    for (const GridPart& part : from) cut(grid, part);
    counts_.assign(static_cast<size_t>(grid.cells.x) * static_cast<size_t>(grid.cells.y) *
                       static_cast<size_t>(grid.cells.z),
                   0);
    for (const Cut& each : cuts_) ++counts_[each.cell];
    // From counts to where each cell's parts begin.
    uint32_t first = 0;
    for (uint32_t number = 0; number < counts_.size(); ++number) {
        const uint32_t count = counts_[number];
        if (count > 0) {
            const int at = static_cast<int>(number), width = grid.cells.x, height = grid.cells.y;
            const double depth =
                order.depth({at % width, at / width % height, at / width / height});
            cells.push_back({depth, SlabOrder::slab(depth), number, first, count});
        }
        counts_[number] = first;
        first += count;
    }
    parts.resize(cuts_.size());
    for (const Cut& each : cuts_) parts[counts_[each.cell]++] = each.part;
    std::sort(cells.begin(), cells.end(), [](const GridCell& a, const GridCell& b) {
        return a.depth != b.depth ? a.depth < b.depth : a.number < b.number;
    });
}

}  // namespace pagoda::hlod
