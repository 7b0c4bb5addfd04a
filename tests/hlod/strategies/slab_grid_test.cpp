// The slabs of paper 003: by hand, and by walking rays through the grid.
#include "hlod/strategies/slab_grid.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace pagoda::hlod {
namespace {

const Grid kUnit{.origin = Vec3d(0.0), .side = 1.0, .cells = Vec3i(8)};

double slabOf(const SlabOrder& order, const Vec3i& cell) {
    return SlabOrder::slab(order.depth(cell));
}

TEST(SlabOrder, LooksAlongAnAxisThroughPlanesOfCells) {
    const SlabOrder order({0, 1, 0}, {4.5, -3.5, 4.5}, kUnit);  // the eye's cell is (4, -4, 4)
    EXPECT_EQ(slabOf(order, {4, 0, 4}), 4.0);
    EXPECT_EQ(slabOf(order, {0, 0, 7}), 4.0);
    EXPECT_EQ(slabOf(order, {7, 5, 0}), 9.0);
}

// By hand: weights are 1 and 0.5.
TEST(SlabOrder, TiltsWithTheDirectionOfView) {
    const SlabOrder order(glm::normalize(Vec3d(2, 1, 0)), {-0.5, -0.5, 0.5}, kUnit);
    EXPECT_EQ(slabOf(order, {0, 0, 0}), 1.0);  // 1 + 0.5
    EXPECT_EQ(slabOf(order, {0, 1, 0}), 2.0);  // 1 + 1
    EXPECT_EQ(slabOf(order, {1, 0, 0}), 2.0);  // 2 + 0.5
    EXPECT_EQ(slabOf(order, {1, 1, 5}), 3.0);
    EXPECT_EQ(slabOf(order, {0, 7, 0}), 5.0);
}

// Behind the eye, too, what is nearer comes first.
TEST(SlabOrder, CountsFromTheEyeInsideTheGrid) {
    const SlabOrder order({1, 0, 0}, {3.5, 3.5, 3.5}, kUnit);
    EXPECT_EQ(slabOf(order, {3, 0, 0}), 0.0);
    EXPECT_EQ(slabOf(order, {4, 3, 3}), 1.0);
    EXPECT_EQ(slabOf(order, {1, 3, 3}), 2.0);
}

// What a ray from the eye enters first is in no later slab, and is asked about first within one:
// any eye, any direction of view, any ray of a picture as wide as can be.
TEST(SlabOrder, NoCellHidesOneOfAnEarlierSlab) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-6, 14), direction(-1, 1);
    const auto anyVector = [&] {
        return Vec3d(direction(random), direction(random), direction(random));
    };
    uint64_t steps = 0, slabsPassed = 0;
    for (int view = 0; view < 300; ++view) {
        const Vec3d eye(place(random), place(random), place(random));
        const Vec3d forward = glm::normalize(anyVector());
        const SlabOrder order(forward, eye, kUnit);
        for (int ray = 0; ray < 30; ++ray) {
            Vec3d along = glm::normalize(anyVector());
            if (glm::dot(along, forward) < 0.0) along = -along;
            double lastDepth = -1.0, lastSlab = -1.0;
            Vec3i last(-100);
            for (double t = 0.0; t < 30.0; t += 0.005) {
                const Vec3i cell(glm::floor(eye + t * along));
                if (cell == last) continue;
                last = cell;
                const double depth = order.depth(cell);
                ASSERT_GE(depth, lastDepth);
                steps += glm::all(glm::greaterThanEqual(cell, Vec3i(0))) &&
                         glm::all(glm::lessThan(cell, Vec3i(8)));
                slabsPassed += SlabOrder::slab(depth) > lastSlab;
                lastDepth = depth;
                lastSlab = SlabOrder::slab(depth);
            }
        }
    }
    EXPECT_GT(steps, 10000u);
    EXPECT_GT(slabsPassed, 10000u);
}

TEST(GridOver, PutsItsCellsAlongTheLongestSide) {
    const Grid grid = gridOver({{1, 2, 3}, {11, 7, 3.1}}, 5);
    EXPECT_EQ(grid.origin, Vec3d(1, 2, 3));
    EXPECT_DOUBLE_EQ(grid.side, 2.0);
    EXPECT_EQ(grid.cells, Vec3i(5, 3, 1));
    EXPECT_EQ(gridOver({{1, 1, 1}, {1, 1, 1}}, 5).cells, Vec3i(1));
}

TEST(GridCells, CutABoxAtThePlanes) {
    GridCells cells;
    const GridPart part{7, {{0.5, 1.0, 2.25}, {2.5, 2.0, 2.75}}};
    cells.fill(kUnit, SlabOrder({1, 0, 0}, {-1, 0, 0}, kUnit), std::span(&part, 1));
    ASSERT_EQ(cells.cells.size(), 3u);  // it ends on the plane y = 2: not in the cells beyond
    const double planes[] = {0.5, 1.0, 2.0, 2.5};
    for (uint32_t x = 0; x < 3; ++x) {
        EXPECT_EQ(cells.cells[x].number, x + 8 * (1 + 8 * 2));
        ASSERT_EQ(cells.partsOf(cells.cells[x]).size(), 1u);
        EXPECT_EQ(cells.partsOf(cells.cells[x])[0].box, 7u);
        const Box3d box{{planes[x], 1.0, 2.25}, {planes[x + 1], 2.0, 2.75}};
        EXPECT_EQ(cells.partsOf(cells.cells[x])[0].boxModel, box);
    }
}

// Whatever a box is, each of its points is in one of its parts, and in the cell that lists it.
TEST(GridCells, PartsLeaveNoGaps) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(0, 1), share(0, 1);
    const Grid grid = gridOver({Vec3d(0.0), {1.0, 0.8, 0.3}}, 7);
    for (int round = 0; round < 200; ++round) {
        std::vector<GridPart> boxes;
        for (uint32_t i = 0; i < 5; ++i) {
            Box3d box;
            for (int corner = 0; corner < 2; ++corner) {
                box.extend(Vec3d(place(random), 0.8 * place(random), 0.3 * place(random)));
            }
            boxes.push_back({i, box});
        }
        GridCells cells;
        cells.fill(grid, SlabOrder({0.6, -0.8, 0}, {2, 3, 4}, grid), boxes);
        for (int i = 0; i < 100; ++i) {
            const GridPart& whole = boxes[static_cast<size_t>(i) % boxes.size()];
            const Vec3d shares(share(random), share(random), share(random));
            const Vec3d point =
                whole.boxModel.min + shares * (whole.boxModel.max - whole.boxModel.min);
            const Vec3i at = glm::min(Vec3i((point - grid.origin) / grid.side), grid.cells - 1);
            const auto number =
                static_cast<uint32_t>(at.x + grid.cells.x * (at.y + grid.cells.y * at.z));
            bool isThere = false;
            for (const GridCell& cell : cells.cells) {
                for (const GridPart& part : cells.partsOf(cell)) {
                    isThere = isThere || (cell.number == number && part.box == whole.box &&
                                          part.boxModel.contains(point));
                }
            }
            EXPECT_TRUE(isThere);
        }
        for (size_t i = 1; i < cells.cells.size(); ++i) {
            EXPECT_LE(cells.cells[i - 1].slab, cells.cells[i].slab);
            EXPECT_LE(cells.cells[i - 1].depth, cells.cells[i].depth);
        }
    }
}

}  // namespace
}  // namespace pagoda::hlod
