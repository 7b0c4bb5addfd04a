// plots.h: the figures of a report: error against run time, what happens along the path, what the
// time goes into, bytes read against bytes needed. Figures are as wide as a page, colours are those
// of Okabe and Ito and of Tol, which colour-blind readers can tell apart; a strategy has the same
// colour and dash in every report.
#pragma once

#include "tools/bench/bench.h"

#include <string>
#include <vector>

namespace pagoda::tools {

struct Figure {
    std::string heading, caption;  // plain text
    std::string svg;               // an <svg> element
};
struct Figures {
    std::vector<Figure> figures;
    std::string problem;  // one line, when there are none for want of gnuplot
};

// Figures of all runs, runs of one path, size and latency together. Long paths are thinned to means
// of neighbouring frames, so that a page of all figures stays small. What was not measured (no
// frame compared, nothing settled) has no figure.
[[nodiscard]] Figures drawFigures(const std::vector<BenchRun>& runs);

}  // namespace pagoda::tools
