// open_space.h: the air around a model, on a coarse grid: how far each cell is from the nearest
// surface, and which cells can be reached from outside. Upright space. Read-only once made.
#pragma once

#include "tools/paths/makers.h"

#include <cstdint>
#include <vector>

namespace pagoda::tools {

class OpenSpace {
public:
    // Cells that a path may use keep so many cells from any surface.
    static constexpr double kClearCells = 2;

    // Streams a cut that is off by less than a cell. About 60 MB.
    explicit OpenSpace(const PathScene& scene);

    [[nodiscard]] double cellSize() const noexcept { return cell_; }
    [[nodiscard]] size_t cellCount() const noexcept { return distance_.size(); }
    [[nodiscard]] Vec3d centreOf(size_t cell) const;
    // Nearest cell for a point outside of the grid.
    [[nodiscard]] size_t cellAt(const Vec3d& point) const;
    [[nodiscard]] bool isOpen(size_t cell) const { return isOpen_[cell]; }
    [[nodiscard]] bool isOpen(const Vec3d& point) const;  // false outside of the grid
    // Cells to the nearest surface, at most 80.
    [[nodiscard]] double distance(size_t cell) const { return distance_[cell] / 3.0; }
    // Something stands beside the cell, not only below it, within so many cells.
    [[nodiscard]] bool isBeside(size_t cell, int reach) const;
    // Way along the unit vector `direction` to the first surface; `maxLength` when there is none so
    // near or the ray leaves the grid.
    [[nodiscard]] double freeLength(const Vec3d& from, const Vec3d& direction,
                                    double maxLength) const;
    // Centres of open cells from neighbour to neighbour, both ends included; prefers `liked` cells
    // from the surface. Both ends are open.
    [[nodiscard]] std::vector<Vec3d> way(size_t from, size_t to, double liked) const;

private:
    void measure();
    void flood();
    [[nodiscard]] size_t index(const Vec3i& c) const {
        return (static_cast<size_t>(c.z) * static_cast<size_t>(size_.y) +
                static_cast<size_t>(c.y)) *
                   static_cast<size_t>(size_.x) +
               static_cast<size_t>(c.x);
    }
    [[nodiscard]] Vec3i coordinates(size_t cell) const;
    [[nodiscard]] bool contains(const Vec3i& c) const {
        return glm::all(glm::greaterThanEqual(c, Vec3i(0))) && glm::all(glm::lessThan(c, size_));
    }

    Vec3d origin_;
    double cell_;
    Vec3i size_;
    std::vector<uint8_t> distance_;  // thirds of a cell; 0: solid
    std::vector<bool> isOpen_;
};

}  // namespace pagoda::tools
