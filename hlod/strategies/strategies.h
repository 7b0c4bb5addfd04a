// strategies.h: the table of strategies: name, paper, what it is.
#pragma once

#include "hlod/view/strategy.h"

#include <memory>
#include <span>
#include <string_view>

namespace pagoda::hlod {

struct StrategyRow {
    std::string_view name;
    std::string_view what;
    std::unique_ptr<Strategy> (*make)();
};

[[nodiscard]] std::span<const StrategyRow> strategies();
// Null for a name that is not in the table.
[[nodiscard]] std::unique_ptr<Strategy> makeStrategy(std::string_view name);

// Each strategy's own file defines one of these.
[[nodiscard]] std::unique_ptr<Strategy> makeFrustumStrategy();

}  // namespace pagoda::hlod
