// surface_sketch.h: a picture of a surface in bounded memory while its triangles stream by in any
// order, with no bounds known beforehand.
// Triangles that are larger than a cell of a grid are kept as they are; of the smaller ones each
// occupied cell keeps the mean position, normal and colour: vertex clustering (Rossignac, Borrel
// 1993; out of core: Lindstrom 2000), drawn as discs as large as a cell (QSplat, Rusinkiewicz,
// Levoy 2000). When there are too many of either, the cells become twice as large. One thread.
#pragma once

#include "viewer/window/model_opening.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pagoda::tools {

class SurfaceSketch {
public:
    // About 84 bytes a cell and 40 a triangle: 13 MiB. At 640x480 a cell of the most that a closed
    // surface can take is 2 to 4 pixels.
    struct Limits {
        size_t cells = size_t{1} << 17, triangles = size_t{1} << 16;
    };
    SurfaceSketch() : SurfaceSketch(Limits{}) {}
    explicit SurfaceSketch(Limits limits);

    // Coordinates must be finite. `colour`: RGBA8, red in the low byte; its alpha is ignored.
    void add(const Vec3d& a, const Vec3d& b, const Vec3d& c, uint32_t colour);

    // `isSample`: the triangles are some of those that lie where they lie, not all; then cells are
    // made so large that the stream has come to each several times (neighbours in a row count
    // once), and no gap shows where triangles were left out. At least
    // one triangle was added. `up` is left for the caller.
    [[nodiscard]] viewer::Preview picture(bool isSample) const;

    [[nodiscard]] uint64_t trianglesSeen() const noexcept { return seen_; }
    [[nodiscard]] size_t cellCount() const noexcept { return cells_.size(); }
    [[nodiscard]] size_t triangleCount() const noexcept { return triangles_.size(); }
    [[nodiscard]] double cellModelUnits() const noexcept { return cellModelUnits_; }

private:
    using CellPlace = glm::ivec3;  // of the cell in the grid, from the cell of the origin
    struct Cell {
        CellPlace place;
        Vec3f positions;  // sums over `count` triangles: from the cell's corner, in cells;
        Vec3f normals;    // area times normal, model units squared;
        Vec3f colours;    // 0 ... 255
        float count;
    };
    struct Triangle {
        std::array<Vec3f, 3> corners;  // model units from the origin
        uint32_t colour;
    };

    void addToCell(const Triangle& triangle);
    void addCell(const Cell& cell);
    void countVisit(const CellPlace& place);
    [[nodiscard]] bool isSmall(const Triangle& triangle) const;
    void coarsen();  // once
    void makeRoom();
    [[nodiscard]] uint64_t partCount() const;
    [[nodiscard]] bool hasGaps() const;

    Limits limits_;
    Vec3d origin_{0.0};
    Box3d box_;
    double cellModelUnits_ = 0.0;
    uint64_t seen_ = 0;
    // How often the stream went from one cell to another, by the bits in which their coordinates
    // differ: in cells 2^k times as large it did so visits_[k + 1] + visits_[k + 2] + ... times.
    std::array<uint64_t, 33> visits_{};
    CellPlace lastPlace_{0};
    std::vector<Triangle> triangles_;
    std::vector<Cell> cells_;
    std::vector<uint32_t> slots_;  // open addressing: 1 + index into cells_, 0: free
};

}  // namespace pagoda::tools
