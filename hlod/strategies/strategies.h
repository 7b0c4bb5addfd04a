// strategies.h: the table of strategies: name, paper, what it is, and what they can be told.
#pragma once

#include "hlod/view/strategy.h"

#include <memory>
#include <span>
#include <string_view>

namespace pagoda::hlod {

// Of `slabs` (paper 003).
struct SlabsOptions {
    bool isNested = false;          // grids within cells; else one uniform grid
    int resolution = 40;            // uniform: cells along the scene's longest side, 1 to 512
    int branching = 4;              // nested: cells of each grid along an axis, 2 to 16
    double splitTriangles = 10000;  // nested: a visible cell with more is cut
    size_t batch = 64;              // queries before an answer is waited for, 1 or more
    // A cell that would draw less is drawn unasked.
    uint64_t queryTriangles = 1;
};

struct StrategyOptions {
    // The sigmoid bias (paper 004): s blends linear (0) and sigmoid (1), t is its turnover: smaller
    // keeps more detail. Both in [0, 1]. The paper's are s = 1, t = 0.5.
    double biasS = 1.0, biasT = 1.0;
    // Beyond the paper: what is seen through a chink counts at least for so much. An error of more
    // than tau / biasFloor pixels is never drawn, however little of it is seen. 0 is the paper's.
    double biasFloor = 1.0 / 64;
    // Beyond the paper: a stop that is foretold within this share of the allowed error waits for
    // its answer (delay), since it would often turn out wrong and be drawn in vain (RARN). 0 is
    // the paper's.
    double caution = 0.15;
    // Beyond the paper: a stop that was seen is asked about in every so many frames only, each at
    // its own time, and in a still view; in between it counts as seen, as before. 1: in every
    // frame.
    uint32_t retestEvery = 1;
    // Beyond the paper: so many boxes that were hidden for some frames are asked about together;
    // only when anything is seen, each by itself. 1: each. Of queries only, not of a depth pyramid.
    uint32_t hiddenBatch = 1;
    // Beyond the paper: a node takes the place of its children only when its error is less than tau
    // by this share, so that it does not come and go. 0: at tau.
    double hysteresis = 0.0;
    // The traversal as it was published: without the rules that let a still view come to rest.
    bool isAsPublished = false;
    SlabsOptions slabs{};
};

// Biases that the paper states, and nothing beyond it.
inline constexpr StrategyOptions kPaperOptions{
    .biasS = 1.0, .biasT = 0.5, .biasFloor = 0.0, .caution = 0.0, .isAsPublished = true};

struct StrategyRow {
    std::string_view name;
    std::string_view what;
    std::unique_ptr<Strategy> (*make)(const StrategyOptions& options);
    bool hidesByPyramid = false;  // nothing is hidden by any other answer
};

[[nodiscard]] std::span<const StrategyRow> strategies();
// Null for a name that is not in the table.
[[nodiscard]] std::unique_ptr<Strategy> makeStrategy(std::string_view name,
                                                     const StrategyOptions& options = {});

// Each strategy's own file defines these.
[[nodiscard]] std::unique_ptr<Strategy> makeFrustumStrategy(const StrategyOptions& options);
[[nodiscard]] std::unique_ptr<Strategy> makeBoolStrategy(const StrategyOptions& options);
[[nodiscard]] std::unique_ptr<Strategy> makeSwStrategy(const StrategyOptions& options);
[[nodiscard]] std::unique_ptr<Strategy> makeSimpStrategy(const StrategyOptions& options);
[[nodiscard]] std::unique_ptr<Strategy> makeCohStrategy(const StrategyOptions& options);
[[nodiscard]] std::unique_ptr<Strategy> makeHzbStrategy(const StrategyOptions& options);
[[nodiscard]] std::unique_ptr<Strategy> makeLateStrategy(const StrategyOptions& options);
[[nodiscard]] std::unique_ptr<Strategy> makeSlabsStrategy(const StrategyOptions& options);
[[nodiscard]] std::unique_ptr<Strategy> makeAutoStrategy(const StrategyOptions& options);

}  // namespace pagoda::hlod
