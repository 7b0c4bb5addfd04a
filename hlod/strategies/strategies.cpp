#include "hlod/strategies/strategies.h"

#include <array>

namespace pagoda::hlod {
namespace {

constexpr std::array kStrategies = {
    StrategyRow{"frustum", "SSE cut, frustum culling only", &makeFrustumStrategy},
    StrategyRow{"bool", "coherent culling, queries as yes or no, SSE alone", &makeBoolStrategy},
    StrategyRow{"sw", "hierarchical stop-and-wait, VMSSE: the ideal set", &makeSwStrategy},
    StrategyRow{"simp", "VMSSE, predicted from the last answer in order", &makeSimpStrategy},
    StrategyRow{"coh", "coherent HLOD culling: refine, stop or delay", &makeCohStrategy},
    StrategyRow{"hzb", "as coh, boxes tested against a depth pyramid, no queries", &makeHzbStrategy,
                true},
    StrategyRow{"late", "as coh for late answers: hidden by the pyramid, errors by old queries",
                &makeLateStrategy, true},
    StrategyRow{"slabs", "front to back in slabs of a grid's cells, batched queries",
                &makeSlabsStrategy},
    StrategyRow{"auto", "whichever of coh, hzb and frustum pays here", &makeAutoStrategy},
};

}  // namespace

std::span<const StrategyRow> strategies() {
    return kStrategies;
}

std::unique_ptr<Strategy> makeStrategy(std::string_view name, const StrategyOptions& options) {
    for (const StrategyRow& row : kStrategies) {
        if (row.name == name) return row.make(options);
    }
    return nullptr;
}

}  // namespace pagoda::hlod
