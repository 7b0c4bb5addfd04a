#include "tools/bench/plot_legend.h"

#include "tools/bench/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>

namespace pagoda::tools {
namespace {

// CSS pixels; letters of 13 px Helvetica are 6.5 wide on average, some more.
constexpr double kMarkPx = 24, kGapPx = 6, kLetterPx = 6.9;
constexpr double kMostBetweenPx = 20, kEdgePx = 12;

double widthPx(const LegendEntry& entry) {
    return kMarkPx + kGapPx + kLetterPx * static_cast<double>(entry.name.size());
}

std::string markCommand(const LegendEntry& entry, double left, double right, double height) {
    // As thick on tall figures, whose row lies nearer to the edge.
    const double halfBar = 0.35 * (1 - height);
    switch (entry.mark) {
        case LegendEntry::Mark::Line:
            return fmt::format(
                "set arrow from screen {:.4f},{} to screen {:.4f},{} nohead lw 1.8 dt {} lc rgb "
                "'{}'\n",
                left, height, right, height, entry.style, entry.colour);
        case LegendEntry::Mark::Point:
            return fmt::format("set label '' at screen {:.4f},{} point pt {} ps 1.1 lc rgb '{}'\n",
                               0.5 * (left + right), height, entry.style, entry.colour);
        case LegendEntry::Mark::Bar:
            return fmt::format(
                "set object rect from screen {:.4f},{} to screen {:.4f},{} fc rgb '{}' fs solid 1 "
                "noborder\n",
                left, height - halfBar, right, height + halfBar, entry.colour);
    }
    return {};
}

}  // namespace

std::string legendCommands(const std::vector<LegendEntry>& entries, int figureWidthPx,
                           double height) {
    const double figure = figureWidthPx;
    double total = 0;
    for (const LegendEntry& entry : entries) total += widthPx(entry);
    // Many entries stand closer together.
    const double gaps = entries.size() > 1 ? static_cast<double>(entries.size() - 1) : 1.0;
    const double betweenPx = std::min(kMostBetweenPx, (figure - 2 * kEdgePx - total) / gaps);
    total += betweenPx * gaps;
    double x = std::clamp(0.54 * figure - 0.5 * total, kEdgePx,
                          std::max(kEdgePx, figure - kEdgePx - total));
    std::string commands = "unset key\n";
    for (const LegendEntry& entry : entries) {
        commands += markCommand(entry, x / figure, (x + kMarkPx) / figure, height);
        commands += fmt::format("set label {} at screen {:.4f},{} left\n",
                                gnuplotQuoted(entry.name), (x + kMarkPx + kGapPx) / figure, height);
        x += widthPx(entry) + betweenPx;
    }
    return commands;
}

}  // namespace pagoda::tools
