// stress_html.h: a stress run as one HTML file that needs nothing else: no links, no scripts,
// figures as inline SVG. Text that comes from outside is escaped.
#pragma once

#include "tools/bench/plots.h"
#include "tools/stress/stress.h"

#include <string>
#include <vector>

namespace pagoda::tools {

// docs/stress.md says what the numbers mean. Figures are those of drawStressFigures(cells): where
// they are missing, the page says how to get them.
[[nodiscard]] std::string stressToHtml(const StressPlan& plan, const std::vector<StressCell>& cells,
                                       const std::string& device, const Figures& figures);

}  // namespace pagoda::tools
