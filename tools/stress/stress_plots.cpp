#include "tools/stress/stress_plots.h"

#include "tools/bench/gnuplot.h"
#include "tools/bench/plot_legend.h"
#include "tools/bench/plot_scripts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <string_view>

namespace pagoda::tools {
namespace {

constexpr int kRowPx = 14, kAroundPx = 76;
// Frames of a strip are joined, the worst first, so that a page stays small.
constexpr size_t kMaxColumns = 300;

constexpr const char* kStyle = R"(set border 1 lc rgb '#333333'
set tics nomirror out scale 0.5 textcolor rgb '#333333'
set xtics offset 0,0.4
set xlabel offset 0,0.7
set lmargin at screen 0.19
set rmargin at screen 0.98
)";

// Labels of ticks are formats of numbers.
std::string tickLabel(const std::string& text) {
    std::string label;
    for (const char c : text) label += c == '%' ? std::string("%%") : std::string(1, c);
    return gnuplotQuoted(label);
}

// One row a cell, from the top, workloads under their names.
struct Rows {
    std::vector<double> heights;  // of the cells' middles
    std::string commands;
    int figureHeightPx = 0;

    explicit Rows(const std::vector<const StressCell*>& cells) {
        std::string tics, names;
        double y = 0;
        const std::string* workload = nullptr;
        for (const StressCell* cell : cells) {
            if (workload == nullptr || *workload != cell->workload) {
                workload = &cell->workload;
                y -= 1.3;
                names += fmt::format(
                    "set label {} at graph 0, first {} right offset -1,0 font "
                    "'Helvetica:Bold,12'\n",
                    gnuplotQuoted(cell->workload), y);
            }
            y -= 1;
            heights.push_back(y);
            tics += fmt::format("{}{} {}", tics.empty() ? "" : ", ", tickLabel(cell->disk.name), y);
        }
        const double count = -y + 0.2;
        figureHeightPx = static_cast<int>(count * kRowPx) + kAroundPx;
        const double height = figureHeightPx;
        commands = fmt::format(
            "set ytics ({}) scale 0 font ',11'\nset yrange [{}:-0.5]\n"
            "set tmargin at screen {}\nset bmargin at screen {}\n{}",
            tics, y - 0.7, 1 - 30 / height, 46 / height, names);
    }
};

// A legend's row lies at a fixed part of the height of wide figures; these are tall.
std::string legendOnTop(const std::vector<LegendEntry>& entries, int heightPx) {
    return legendCommands(entries, kFigureWidthPx, 1 - 14.0 / heightPx);
}

std::string rgbOf(std::string_view colour) {  // "#rrggbb"
    return fmt::format("0x{}", colour.substr(1));
}

// ---- Strips

struct Shade {
    const char* name;
    const char* colour;
};
constexpr std::array kTimeShades = {
    Shade{"to 1.25x the median", "#e8eef4"}, Shade{"to 1.5x", "#b7cde0"}, Shade{"to 2x", "#7fa6c9"},
    Shade{"more, within 16 ms", "#3f6f9f"}, Shade{"hitch", "#d55e00"}};
constexpr std::array kMissingShades = {Shade{"none", "#eeeeee"}, Shade{"to 0.5%", "#f7dca8"},
                                       Shade{"to 5%", "#efb04c"}, Shade{"to 25%", "#d55e00"},
                                       Shade{"more", "#7a1f00"}};

size_t timeShade(double frameMs, double medianMs) {
    if (frameMs > kHitchMs && frameMs > kHitchOverMedian * medianMs) return 4;
    if (frameMs > 2 * medianMs) return 3;
    if (frameMs > 1.5 * medianMs) return 2;
    return frameMs > 1.25 * medianMs ? 1 : 0;
}

size_t missingShade(double share) {
    if (share > 0.25) return 4;
    if (share > 0.05) return 3;
    if (share > 0.005) return 2;
    return share > 0 ? 1 : 0;
}

using Shades = std::vector<size_t>;  // of each frame

// Runs of one shade as one box: frames from `begin` to before `end`.
void addStrip(std::string& data, const Shades& shades, double y, std::span<const Shade> table) {
    const size_t stride = (shades.size() + kMaxColumns - 1) / std::max<size_t>(kMaxColumns, 1);
    const auto shadeFrom = [&](size_t frame) {
        const auto first = shades.begin() + static_cast<ptrdiff_t>(frame);
        const auto left = static_cast<size_t>(shades.end() - first);
        return *std::max_element(first, first + static_cast<ptrdiff_t>(std::min(stride, left)));
    };
    for (size_t begin = 0, end = 0; begin < shades.size(); begin = end) {
        const size_t shade = shadeFrom(begin);
        end = begin + stride;
        while (end < shades.size() && shadeFrom(end) == shade) end += stride;
        end = std::min(end, shades.size());
        data += fmt::format("{} {} {} {} {} {} {}\n", begin, y, begin, end, y - 0.42, y + 0.42,
                            rgbOf(table[shade].colour));
    }
}

struct Drawing {
    std::string commands;
    int heightPx = 0;
};

Drawing strips(const std::vector<const StressCell*>& cells, std::span<const Shade> table,
               const std::function<Shades(const StressCell&)>& shadesOf) {
    const Rows rows(cells);
    std::string data;
    size_t frames = 1;
    for (size_t i = 0; i < cells.size(); ++i) {
        const Shades shades = shadesOf(*cells[i]);
        frames = std::max(frames, shades.size());
        addStrip(data, shades, rows.heights[i], table);
    }
    std::vector<LegendEntry> entries;
    for (const Shade& shade : table) {
        entries.push_back({shade.name, shade.colour, LegendEntry::Mark::Bar});
    }
    return {
        fmt::format("{}{}{}$d << EOD\n{}EOD\nset style fill solid 1 noborder\n"
                    "set xrange [0:{}]\nset xlabel 'frame'\n"
                    "plot $d using 1:2:3:4:5:6:7 with boxxyerror lc rgb variable\n",
                    kStyle, rows.commands, legendOnTop(entries, rows.figureHeightPx), data, frames),
        rows.figureHeightPx};
}

Shades timeShades(const StressCell& cell) {
    Shades shades;
    for (const double frameMs : cell.frameMsSeries) {
        shades.push_back(timeShade(frameMs, cell.frameMs.median));
    }
    return shades;
}

Shades missingShades(const StressCell& cell) {
    Shades shades;
    for (const double share : cell.missingShareSeries) shades.push_back(missingShade(share));
    return shades;
}

// ---- Bytes and budgets

Drawing bytesBars(const std::vector<const StressCell*>& cells) {
    // Tol's muted colours.
    const std::vector<LegendEntry> entries = {
        {"drawn", "#117733", LegendEntry::Mark::Bar},
        {"never drawn", "#cc6677", LegendEntry::Mark::Bar},
        {"read again", "#882255", LegendEntry::Mark::Bar},
        {"index", "#ddcc77", LegendEntry::Mark::Bar},
        {"gaps of joined reads", "#bbbbbb", LegendEntry::Mark::Bar}};
    const Rows rows(cells);
    std::string data;
    double mostMb = 0;
    for (size_t i = 0; i < cells.size(); ++i) {
        const StressBytes& bytes = cells[i]->bytes;
        double sumMb = 0;
        data += fmt::format("{} 0", rows.heights[i]);
        for (const uint64_t part :
             {bytes.drawn, bytes.wasted, bytes.twice, bytes.index, bytes.gaps}) {
            sumMb += static_cast<double>(part) * 1e-6;
            data += fmt::format(" {:.6g}", sumMb);
        }
        data += "\n";
        mostMb = std::max(mostMb, sumMb);
    }
    std::string plots;
    for (size_t k = 0; k < entries.size(); ++k) {
        plots +=
            fmt::format("{}$d using {}:1:{}:{}:($1-0.38):($1+0.38) with boxxyerror lc rgb '{}'",
                        k == 0 ? "plot " : ", ", k + 2, k + 2, k + 3, entries[k].colour);
    }
    return {fmt::format("{}{}{}$d << EOD\n{}EOD\nset style fill solid 1 noborder\n"
                        "set xrange [0:{:g}]\nset xlabel 'read over the cell, MB'\n{}\n",
                        kStyle, rows.commands, legendOnTop(entries, rows.figureHeightPx), data,
                        mostMb > 0 ? 1.05 * mostMb : 1, plots),
            rows.figureHeightPx};
}

double percent(uint64_t part, uint64_t whole) {
    return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 0;
}

Drawing budgetMarks(const std::vector<const StressCell*>& cells) {
    const bool hasUpload = cells.front()->uploadBudget > 0;
    std::vector<LegendEntry> entries = {{"GPU", "#0072b2", LegendEntry::Mark::Point, 7},
                                        {"host", "#e69f00", LegendEntry::Mark::Point, 13}};
    if (hasUpload) entries.push_back({"upload", "#009e73", LegendEntry::Mark::Point, 9});
    const Rows rows(cells);
    std::string data;
    double most = 100;
    for (size_t i = 0; i < cells.size(); ++i) {
        const StressCell& cell = *cells[i];
        const double shares[] = {percent(cell.peaks.gpuBytes, cell.gpuBudget),
                                 percent(cell.peaks.hostBytes, cell.hostBudget),
                                 percent(cell.peaks.uploadBytes, cell.uploadBudget)};
        data += fmt::format("{} {:.5g} {:.5g} {:.5g}\n", rows.heights[i], shares[0], shares[1],
                            shares[2]);
        for (const double share : shares) most = std::max(most, share);
    }
    std::string plots;
    for (size_t k = 0; k < entries.size(); ++k) {
        plots += fmt::format("{}$d using {}:1 with points pt {} ps 0.8 lc rgb '{}'",
                             k == 0 ? "plot " : ", ", k + 2, entries[k].style, entries[k].colour);
    }
    return {fmt::format("{}{}{}$d << EOD\n{}EOD\nset xrange [0:{:g}]\n"
                        "set grid xtics lc rgb '#dddddd' lt 1 lw 0.6\n"
                        "set arrow from 100, graph 0 to 100, graph 1 nohead lw 1.5 lc rgb "
                        "'#d55e00'\nset xlabel 'most of the budget that was held, %'\n{}\n",
                        kStyle, rows.commands, legendOnTop(entries, rows.figureHeightPx), data,
                        1.05 * most, plots),
            rows.figureHeightPx};
}

// ---- Time to sharp

constexpr int kSharpHeightPx = 300;

Drawing sharpMarks(const std::vector<const StressCell*>& cells) {
    const std::vector<LegendEntry> entries = {
        {"until sharp", "#0072b2", LegendEntry::Mark::Point, 7},
        {"not sharp before the next jump", "#d55e00", LegendEntry::Mark::Point, 9},
        {"bound", "#333333", LegendEntry::Mark::Line, 1}};
    std::string tics, sharp = "$s << EOD\n", late = "$l << EOD\n", bounds = "$b << EOD\n";
    double most = 0;
    for (size_t i = 0; i < cells.size(); ++i) {
        tics += fmt::format("{}{} {}", i == 0 ? "" : ", ", tickLabel(cells[i]->disk.name), i);
        const std::vector<StressJump>& jumps = cells[i]->jumps;
        for (size_t k = 0; k < jumps.size(); ++k) {
            const double x =
                static_cast<double>(i) - 0.35 +
                0.7 * (static_cast<double>(k) + 0.5) / static_cast<double>(jumps.size());
            (jumps[k].isSharp ? sharp : late) += fmt::format("{} {:.5g}\n", x, jumps[k].sharpS);
            bounds += fmt::format("{} {:.5g}\n", x, jumps[k].boundS);
            most = std::max({most, jumps[k].sharpS, jumps[k].boundS});
        }
    }
    // A block without points would be an error.
    late += "-9 -9\n";
    sharp += "-9 -9\n";
    return {fmt::format(
                "{}{}{}EOD\n{}EOD\n{}EOD\nset lmargin at screen 0.11\n"
                "set tmargin at screen 0.88\nset bmargin at screen 0.13\nset border 3\n"
                "set grid ytics lc rgb '#dddddd' lt 1 lw 0.6\nset xtics ({}) scale 0 font ',11'\n"
                "set xrange [-0.5:{}]\nset yrange [0:{:g}]\n"
                "set ylabel 'after the jump, s' offset 1,0\n"
                "plot $b using 1:2:(0.05) with xerrorbars pt 0 lw 2 lc rgb '#333333', "
                "$s using 1:2 with points pt 7 ps 0.9 lc rgb '#0072b2', "
                "$l using 1:2 with points pt 9 ps 1.1 lc rgb '#d55e00'\n",
                kStyle, legendOnTop(entries, kSharpHeightPx), sharp, late, bounds, tics,
                static_cast<double>(cells.size()) - 0.5, most > 0 ? 1.1 * most : 1),
            kSharpHeightPx};
}

}  // namespace

Figures drawStressFigures(const std::vector<StressCell>& cells) {
    std::vector<const StressCell*> all, streaming, jumping;
    for (const StressCell& cell : cells) {
        all.push_back(&cell);
        if (cell.isResident) continue;
        streaming.push_back(&cell);
        if (!cell.jumps.empty()) jumping.push_back(&cell);
    }
    Figures figures;
    Gnuplot gnuplot;
    const auto add = [&](const char* heading, const char* caption, const Drawing& drawing) {
        const std::string id = fmt::format("f{}", figures.figures.size());
        figures.figures.push_back(
            {heading, caption,
             gnuplot.svg(drawing.commands, {kFigureWidthPx, drawing.heightPx}, id)});
    };
    add("Where it hitches",
        "Wall time of every frame against the median of its cell. A hitch takes more than twice "
        "the median and more than 16 ms.",
        strips(all, kTimeShades, timeShades));
    add("Where detail is missing",
        "Pixels drawn by a stand-in, coarser than they should be, because what they need is not "
        "there yet: share of the pixels that show the model, every frame.",
        strips(all, kMissingShades, missingShades));
    if (!jumping.empty()) {
        add("From a jump to a sharp picture",
            "Virtual time. Bound: bytes read until then / bandwidth + levels read x (latency + 2 "
            "frames).",
            sharpMarks(jumping));
    }
    add("What the bytes were read for",
        "Drawn: pages that some frame of the cell drew, whether seen or not.",
        bytesBars(streaming));
    add("Budgets and their peaks", "None may pass 100%.", budgetMarks(streaming));
    if (!gnuplot.problem().empty()) figures = {{}, gnuplot.problem()};
    return figures;
}

}  // namespace pagoda::tools
