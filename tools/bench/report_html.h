// report_html.h: a bench as one HTML file that needs nothing else: no links, no scripts, figures as
// inline SVG. Text that comes from outside (names of files, faults) is escaped.
#pragma once

#include "tools/bench/bench.h"
#include "tools/bench/plots.h"
#include "tools/bench/report_page.h"

#include <string>
#include <vector>

namespace pagoda::tools {

// docs/bench.md says what the numbers mean. `device` is the renderer's name; figures are those of
// drawFigures(runs): where they are missing, the page says how to get them.
[[nodiscard]] std::string benchToHtml(const BenchPlan& plan, const std::vector<BenchRun>& runs,
                                      const std::string& device, const Figures& figures);

}  // namespace pagoda::tools
