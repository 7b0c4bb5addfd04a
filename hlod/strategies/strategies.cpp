#include "hlod/strategies/strategies.h"

#include <array>

namespace pagoda::hlod {
namespace {

constexpr std::array kStrategies = {
    StrategyRow{"frustum", "SSE cut, frustum culling only", &makeFrustumStrategy},
};

}  // namespace

std::span<const StrategyRow> strategies() {
    return kStrategies;
}

std::unique_ptr<Strategy> makeStrategy(std::string_view name) {
    for (const StrategyRow& row : kStrategies) {
        if (row.name == name) return row.make();
    }
    return nullptr;
}

}  // namespace pagoda::hlod
