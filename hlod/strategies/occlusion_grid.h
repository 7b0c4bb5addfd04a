// occlusion_grid.h: which screen rectangles may still show something behind what was drawn.
// Paper 001, section 3: a flat grid of square cells. A draw only marks the cells that it touches
// as outdated; a cell is read again when a test needs it (lazy). `busy`, the paper's baseline,
// reads every touched cell after each draw. Pure logic over a DepthVisibility; knows no device.
// One frame's state only. Render thread.
#pragma once

#include "hlod/view/visibility.h"

#include <cstdint>
#include <vector>

namespace pagoda::hlod {

enum class GridVariant {
    // Asks whether pixels are free. A bit knows no depth: whoever uses it tests all that is not
    // wholly behind an object before drawing that object (the paper's second traversal).
    Occlusion,
    // Compares greatest depths: any order of draws and tests is right.
    DepthBuffer,
};

struct OcclusionGridOptions {
    int cellPixels = 32;  // > 0; the paper's, to be tuned
    GridVariant variant = GridVariant::Occlusion;
    bool busy = false;
    // DepthBuffer only. As printed, a border cell counts as free where no whole read has found it
    // full, although the part that is asked about may be: safe, but nothing is culled there.
    // With this, such a cell is read wherever something was drawn to it.
    bool readTouchedBorders = false;
};

class OcclusionGrid {
public:
    // A picture of `width` x `height` pixels, all background; cells at its edges are cut off.
    OcclusionGrid(int width, int height, const OcclusionGridOptions& options);

    // All is background again. O(cells).
    void beginFrame();

    // May an object show whose pixels all lie in `rectangle` (rounded outwards; clipped here), no
    // nearer than `nearDepth` (view space, model units)? False only when what was drawn hides all
    // of it, or it has no pixel in the picture. `depths` must show all that drawn() was told of.
    [[nodiscard]] bool isVisible(const PixelRect& rectangle, double nearDepth,
                                 DepthVisibility& depths);

    // Something was drawn, all of it within `rectangle`. Only the busy grid asks `depths`.
    void markDrawn(const PixelRect& rectangle, DepthVisibility& depths);

    // Rectangles read from `depths` since the grid was made.
    [[nodiscard]] uint64_t pixelQueries() const noexcept { return pixelQueries_; }

private:
    enum class CellState : uint8_t { Free, Partial, Outdated, Full };
    struct Cell {
        CellState state = CellState::Free;  // Occlusion; Full is never undone within a frame
        double farDepth = 0.0;              // DepthBuffer; from above, infinite: background
        bool isOutdated = false;            // DepthBuffer
        bool isTouched = false;             // DepthBuffer: marked since the frame began
    };
    struct CellRange {
        int minX = 0, minY = 0, maxX = 0, maxY = 0;
    };

    [[nodiscard]] PixelRect clipped(const PixelRect& rectangle) const;
    [[nodiscard]] CellRange cellsOf(const PixelRect& clippedRectangle) const;
    [[nodiscard]] PixelRect pixelsOf(int index) const;
    // Stages 1 and 2 of a test: true once a cell is free unasked; else fills both lists.
    [[nodiscard]] bool isFreeUnasked(const PixelRect& rectangle, double nearDepth);
    [[nodiscard]] bool isInternalFree(const Cell& cell, int index, double nearDepth);
    [[nodiscard]] bool isBorderFree(const Cell& cell, int index, double nearDepth);
    // Reads a whole cell and stores what it is now.
    void refresh(int index, DepthVisibility& depths);
    [[nodiscard]] bool isSeenIn(const PixelRect& rectangle, double nearDepth,
                                DepthVisibility& depths);

    OcclusionGridOptions options_;
    int width_, height_, columns_, rows_;
    std::vector<Cell> cells_;
    std::vector<int> internalToRead_, borderToRead_;  // of one test; kept to allocate once
    uint64_t pixelQueries_ = 0;
};

}  // namespace pagoda::hlod
