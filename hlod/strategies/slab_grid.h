// slab_grid.h: a grid of cubes over boxes, and its cells from front to back in slabs (paper 003).
// Cells list the parts of the boxes that lie in them. Pure: any thread. Model units.
//
// The slab of a cell is floor(sum of |v_k| |d_k| / max |v_k|) for the direction of view v and the
// cell's steps d from the eye's. Before the eye these are the paper's axis-aligned slabs, planes of
// cells about orthogonal to the direction of view. A ray from the eye never comes back along an
// axis, so that what it enters first has no greater step on any: no cell hides one of an earlier
// slab, wherever the eye is, in the grid too, and however wide the picture.
#pragma once

#include "ooc/base/box.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

struct Grid {
    Vec3d origin{0.0};
    double side = 1.0;  // of a cell, > 0
    Vec3i cells{1};     // along each axis, >= 1
};

// Over a box with extent: `resolution` >= 1 cells along its longest side.
[[nodiscard]] Grid gridOver(const Box3d& box, int resolution);

class SlabOrder {
public:
    SlabOrder(const Vec3d& forward, const Vec3d& eye, const Grid& grid);

    // Sum of the cell's weighted steps. Its whole part is the slab; within a slab, too, what hides
    // is less than what it hides, or equal where the direction of view is along an axis.
    [[nodiscard]] double depth(const Vec3i& cell) const;
    [[nodiscard]] static double slab(double depth);

private:
    Vec3d weights_, eyeCell_;
};

// What lies in a cell of box number `box`. Parts of a box make up all of it, without gaps.
struct GridPart {
    uint32_t box = 0;
    Box3d boxModel;
};

struct GridCell {
    double depth = 0, slab = 0;
    uint32_t number = 0;  // x + X (y + Y z)
    uint32_t firstPart = 0, partCount = 0;
};

// Reused from frame to frame.
struct GridCells {
    std::vector<GridPart> parts;  // cell by cell
    std::vector<GridCell> cells;  // that have parts; from front to back, ties by number

    // Cuts parts at the grid's planes. What lies outside of the grid goes to the nearest cell.
    void fill(const Grid& grid, const SlabOrder& order, std::span<const GridPart> from);
    [[nodiscard]] std::span<const GridPart> partsOf(const GridCell& cell) const {
        return std::span(parts).subspan(cell.firstPart, cell.partCount);
    }

private:
    struct Cut {
        uint32_t cell = 0;
        GridPart part;
    };
    void cut(const Grid& grid, const GridPart& part);

    std::vector<Cut> cuts_;
    std::vector<uint32_t> counts_;  // by cell
};

}  // namespace pagoda::hlod
