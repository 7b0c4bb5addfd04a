// plot_legend.h: a legend in one row above a figure, as gnuplot commands. gnuplot's own breaks rows
// by a guess of the width of letters, and then lies over the data. Pure functions.
#pragma once

#include <string>
#include <vector>

namespace pagoda::tools {

struct LegendEntry {
    std::string name, colour;
    enum class Mark { Line, Point, Bar } mark = Mark::Line;
    int style = 1;  // of a line: its dash; of a point: its shape
};
// Objects at places on the screen, numbered from 1: what is set later may remove them by
// kUnsetLegend, for the second panel of a figure. Long rows begin at the left edge.
// `height` of the row: from below, in parts of the figure.
[[nodiscard]] std::string legendCommands(const std::vector<LegendEntry>& entries, int figureWidthPx,
                                         double height = 0.955);
inline constexpr const char* kUnsetLegend = "unset label\nunset arrow\nunset object\n";

}  // namespace pagoda::tools
