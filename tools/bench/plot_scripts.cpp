#include "tools/bench/plot_scripts.h"

#include "tools/bench/gnuplot.h"
#include "tools/bench/plot_legend.h"
#include "tools/bench/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>

namespace pagoda::tools {
namespace {

// From one value to the other the least ones would lie on the axis.
constexpr double kLogarithmicFrom = 12;

struct Look {
    const char* strategy;
    const char* colour;
    int dash, point;
};
// Okabe and Ito's colours; yellow is too faint on white.
constexpr Look kLooks[] = {
    {"frustum", "#000000", 1, 5}, {"bool", "#e69f00", 1, 7}, {"sw", "#56b4e9", 4, 9},
    {"simp", "#009e73", 2, 11},   {"coh", "#d55e00", 1, 13}, {"hzb", "#cc79a7", 5, 15},
    {"late", "#8c564b", 5, 9},    {"auto", "#0072b2", 3, 3}, {"slabs", "#7f7f00", 4, 1},
};
constexpr Look kOther{"", "#888888", 3, 1};

const Look& lookOf(const std::string& strategy) {
    for (const Look& look : kLooks) {
        if (strategy == look.strategy) return look;
    }
    return kOther;
}

bool hasSameStrategy(const BenchRun& a, const BenchRun& b) {
    return a.strategy == b.strategy;
}

constexpr const char* kStyle = R"(set border 3 lc rgb '#333333'
set tics nomirror out scale 0.6 textcolor rgb '#333333'
set xtics offset 0,0.4
set xlabel offset 0,0.7
set grid ytics lc rgb '#dddddd' lt 1 lw 0.6
)";

// One entry a strategy, in the order of the figure.
std::string legendOf(const std::vector<std::string>& strategies, LegendEntry::Mark mark) {
    std::vector<LegendEntry> entries;
    for (const std::string& strategy : strategies) {
        const Look& look = lookOf(strategy);
        entries.push_back({strategy, look.colour, mark,
                           mark == LegendEntry::Mark::Line ? look.dash : look.point});
    }
    return legendCommands(entries, kFigureWidthPx);
}

// ---- Error against run time

// Style, legend, data, greatest time, axis and plots of the left panel, without a legend those of
// the right one.
constexpr const char* kErrorLayout = R"({}{}{}set multiplot
set tmargin at screen 0.88
set bmargin at screen 0.19
set xrange [0:{:g}]
set xlabel 'CPU time a frame, ms'
set lmargin at screen 0.11
set rmargin at screen 0.49
set ylabel 'PSNR of luma, dB' offset 1,0
{}{}
{}set lmargin at screen 0.62
set rmargin at screen 0.98
set ylabel 'pixels a frame' offset 1,0
{}{}
unset multiplot
)";

// 1, 2 or 5 times a power of ten, such that about four of it make `range`.
double tickStep(double range) {
    const double rough = std::max(range, 1e-6) / 4;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * power >= rough) return factor * power;
    }
    return 10 * power;
}

// PSNR in dB, and above it a place for pictures that are equal.
struct QualityAxis {
    double low = 0, high = 0, equal = 1, step = 1;
    bool hasEqual = false, hasFinite = false;

    explicit QualityAxis(const RunGroup& runs) {
        double least = kEqualDb, most = 0;
        for (const BenchRun* run : runs) {
            if (run->psnrLuma >= kEqualDb) {
                hasEqual = true;
                continue;
            }
            hasFinite = true;
            least = std::min(least, run->psnrLuma);
            most = std::max(most, run->psnrLuma);
        }
        if (!hasFinite) return;
        step = std::max(1.0, tickStep(most - least));
        low = (std::ceil(least / step) - 1) * step;
        high = std::max(std::ceil(most / step), low / step + 1) * step;
        equal = high + step;
    }
    double place(double psnr) const { return psnr >= kEqualDb ? equal : psnr; }
    std::string commands() const {
        std::string tics;
        if (hasFinite) {
            for (int i = 0; low + i * step < high + 0.5 * step; ++i) {
                tics += fmt::format("{:g},", low + i * step);
            }
        }
        if (hasEqual) tics += fmt::format("'equal' {:g},", equal);
        tics.pop_back();
        const double top = hasEqual ? equal + 0.5 * step : high;
        return fmt::format("set ytics ({})\nset yrange [{:g}:{:g}]\n", tics, low, top);
    }
};

// A block of data a strategy: CPU ms, PSNR's place, wrong pixels, RARN's pixels, size of the mark.
std::string errorData(const std::vector<RunGroup>& byStrategy, const QualityAxis& axis,
                      const std::vector<double>& taus) {
    std::string text;
    for (size_t s = 0; s < byStrategy.size(); ++s) {
        text += fmt::format("$s{} << EOD\n", s);
        for (const BenchRun* run : byStrategy[s]) {
            const auto rank = std::find(taus.begin(), taus.end(), run->tauPx) - taus.begin();
            text += fmt::format("{:.6g} {:.6g} {:.6g} {:.6g} {:.3g}\n", run->cpuMs.median,
                                axis.place(run->psnrLuma), run->wrongPixels, run->overdrawnPixels,
                                std::min(0.9 + 0.3 * static_cast<double>(rank), 2.4));
        }
        text += "EOD\n";
    }
    return text;
}

}  // namespace

std::string errorScript(const RunGroup& runs) {
    const QualityAxis axis(runs);
    const std::vector<double> taus = tausOf(runs);
    const std::vector<RunGroup> byStrategy = grouped(runs, hasSameStrategy);
    double mostMs = 0, mostPixels = 0;
    for (const BenchRun* run : runs) {
        mostMs = std::max(mostMs, run->cpuMs.median);
        mostPixels = std::max({mostPixels, run->wrongPixels, run->overdrawnPixels});
    }
    std::string left, right;
    std::vector<std::string> names;
    for (size_t s = 0; s < byStrategy.size(); ++s) {
        const std::string& strategy = byStrategy[s].front()->strategy;
        const Look& look = lookOf(strategy);
        names.push_back(strategy);
        // Full marks let those below them shine through: '#AARRGGBB'.
        const std::string shine = std::string("#40") + (look.colour + 1);
        left += fmt::format(
            "{0}$s{1} using 1:2 with lines lw 0.8 lc rgb '{3}', "
            "$s{1} using 1:2:5 with points pt {2} ps variable lc rgb '{4}'",
            s == 0 ? "plot " : ", ", s, look.point, look.colour, shine);
        right += fmt::format(
            "{0}$s{1} using 1:($4>0?$4:NaN):($5*1.5) with points pt {2} ps variable lw 1.6 lc rgb "
            "'{4}', $s{1} using 1:3:5 with points pt {3} ps variable lc rgb '{5}'",
            s == 0 ? "plot " : ", ", s, look.point - 1, look.point, look.colour, shine);
    }
    const std::string pixelsAxis = mostPixels > 0
                                       ? fmt::format("set ytics autofreq\nset yrange [{:g}:{:g}]\n",
                                                     -0.04 * mostPixels, 1.1 * mostPixels)
                                       : "set ytics (0, 1)\nset yrange [-0.04:1]\n";
    return fmt::format(kErrorLayout, kStyle, legendOf(names, LegendEntry::Mark::Point),
                       errorData(byStrategy, axis, taus), mostMs > 0 ? 1.1 * mostMs : 1,
                       axis.commands(), left, kUnsetLegend, pixelsAxis, right);
}

// ---- Along the path

namespace {

// From 0, or logarithmic with a tick at 1, 2 and 5 of each power of ten.
std::string valueAxis(double least, double most) {
    if (!(least > 0 && most > kLogarithmicFrom * least)) {
        return fmt::format("set yrange [0:{:g}]\n", most > 0 ? 1.08 * most : 1);
    }
    std::string tics;
    for (double power = std::pow(10, std::floor(std::log10(least))); power <= most; power *= 10) {
        for (const double factor : {1.0, 2.0, 5.0}) {
            tics += fmt::format("{}{:g}", tics.empty() ? "" : ", ", factor * power);
        }
    }
    return fmt::format("set logscale y\nset yrange [{:g}:{:g}]\nset ytics ({})\n", 0.9 * least,
                       1.1 * most, tics);
}

}  // namespace

std::string linesScript(const std::vector<PathLine>& lines, size_t stride, const char* unit) {
    double least = std::numeric_limits<double>::max(), most = 0;
    size_t frames = 1;
    std::string data, plots;
    std::vector<std::string> names;
    for (size_t s = 0; s < lines.size(); ++s) {
        const std::span<const double> values = lines[s].values;
        frames = std::max(frames, values.size());
        data += fmt::format("$s{} << EOD\n", s);
        for (size_t begin = 0; begin < values.size(); begin += stride) {
            const auto part = values.subspan(begin, std::min(stride, values.size() - begin));
            const double mean = spreadOf({part.begin(), part.end()}).mean;
            const double middle = static_cast<double>(begin) + 0.5 * (double(part.size()) - 1);
            least = std::min(least, mean);
            most = std::max(most, mean);
            data += fmt::format("{:g} {:.5g}\n", middle, mean);
        }
        data += "EOD\n";
        const Look& look = lookOf(lines[s].strategy);
        plots += fmt::format("{}$s{} using 1:2 with lines lw 1.5 dt {} lc rgb '{}'",
                             s == 0 ? "plot " : ", ", s, look.dash, look.colour);
        names.push_back(lines[s].strategy);
    }
    return fmt::format(
        "{}{}{}set lmargin at screen 0.11\nset rmargin at screen 0.98\nset tmargin at screen 0.88\n"
        "set bmargin at screen 0.19\n{}set xrange [0:{}]\nset xlabel 'frame'\n"
        "set ylabel '{}' offset 1,0\n{}\n",
        kStyle, legendOf(names, LegendEntry::Mark::Line), data, valueAxis(least, most),
        std::max<size_t>(frames - 1, 1), unit, plots);
}

// ---- Bars

namespace {

std::string barLabel(const BenchRun& run, bool hasTaus) {
    return gnuplotQuoted(hasTaus ? fmt::format("{} {:g} px", run.strategy, run.tauPx)
                                 : run.strategy);
}

// Columns are numbered and then values; labels stand below the bars.
std::string barFrame(const RunGroup& runs, const std::string& data, const char* unit, double most) {
    const bool hasTaus = tausOf(runs).size() > 1;
    std::string tics;
    for (size_t i = 0; i < runs.size(); ++i) {
        tics += fmt::format("{}{} {}", i == 0 ? "" : ", ", barLabel(*runs[i], hasTaus), i);
    }
    const bool isCrowded = hasTaus && runs.size() > 7;
    return fmt::format(
        "{}$d << EOD\n{}EOD\nset style fill solid 1 noborder\nset xrange [-0.6:{}]\n"
        "set yrange [0:{:g}]\nset xtics ({}) scale 0{}\nset ylabel '{}' offset 1,0\n"
        "set lmargin at screen 0.11\nset rmargin at screen 0.98\nset tmargin at screen 0.88\n"
        "set bmargin at screen {}\n",
        kStyle, data, static_cast<double>(runs.size()) - 0.4, most > 0 ? 1.12 * most : 1, tics,
        isCrowded ? " rotate by 45 right offset 0.6,0.1" : "", unit, isCrowded ? 0.24 : 0.13);
}

// Tol's muted colours: other ones than the strategies'.
struct Part {
    const char* name;
    const char* colour;
    Spread BenchRun::*spread;
};
constexpr Part kParts[] = {{"traverse", "#332288", &BenchRun::traverseMs},
                           {"query", "#88ccee", &BenchRun::queryMs},
                           {"draw", "#ddcc77", &BenchRun::drawMs},
                           {"upload", "#aa4499", &BenchRun::streamMs}};

}  // namespace

std::string partsScript(const RunGroup& runs) {
    std::string data;
    double most = 0;
    for (size_t i = 0; i < runs.size(); ++i) {
        double sum = 0;
        data += fmt::format("{} 0", i);
        for (const Part& part : kParts) {
            sum += (runs[i]->*part.spread).median;
            data += fmt::format(" {:.5g}", sum);
        }
        data += "\n";
        most = std::max(most, sum);
    }
    std::vector<LegendEntry> entries;
    for (const Part& part : kParts) {
        entries.push_back({part.name, part.colour, LegendEntry::Mark::Bar});
    }
    std::string script = barFrame(runs, data, "wall time a frame, ms", most) +
                         legendCommands(entries, kFigureWidthPx);
    for (size_t p = 0; p < std::size(kParts); ++p) {
        script +=
            fmt::format("{}$d using 1:(0):($1-0.32):($1+0.32):{}:{} with boxxyerror lc rgb '{}'",
                        p == 0 ? "plot " : ", ", p + 2, p + 3, kParts[p].colour);
    }
    return script + "\n";
}

std::string bytesScript(const RunGroup& runs) {
    constexpr double kMegabyte = 1e6;
    std::string data;
    double most = 0;
    for (size_t i = 0; i < runs.size(); ++i) {
        const BenchRun& run = *runs[i];
        const auto exact = static_cast<double>(run.bytesExact) / kMegabyte;
        const auto read = static_cast<double>(run.bytesRead) / kMegabyte;
        data += fmt::format("{} {:.5g} {:.5g} {:.5g} \"{}\"\n", i, exact,
                            static_cast<double>(run.pageBytesRead) / kMegabyte, read,
                            exact > 0 ? fmt::format("{:.2f}x", read / exact) : "");
        most = std::max({most, exact, read});
    }
    using enum LegendEntry::Mark;
    const std::vector<LegendEntry> entries = {
        {"needed by what is seen", kParts[0].colour, Bar},
        {"pages read", kParts[1].colour, Bar},
        {"and what joined reads bring along", kParts[2].colour, Bar}};
    std::string script = barFrame(runs, data, "bytes over the path, MB", most) +
                         legendCommands(entries, kFigureWidthPx) + "plot ";
    for (size_t k = 0; k < entries.size(); ++k) {
        const double left = -0.36 + 0.25 * static_cast<double>(k);
        script +=
            fmt::format("$d using 1:(0):($1+{:g}):($1+{:g}):(0):{} with boxxyerror lc rgb '{}', ",
                        left, left + 0.23, k + 2, entries[k].colour);
    }
    return script + "$d using ($1+0.25):4:5 with labels offset 0,0.6 font ',11'\n";
}

// ---- Runs together

std::vector<RunGroup> grouped(const RunGroup& runs,
                              const std::function<bool(const BenchRun&, const BenchRun&)>& isSame) {
    std::vector<RunGroup> groups;
    for (const BenchRun* run : runs) {
        const auto group = std::find_if(groups.begin(), groups.end(), [&](const RunGroup& other) {
            return isSame(*other.front(), *run);
        });
        if (group == groups.end()) {
            groups.push_back({run});
        } else {
            group->push_back(run);
        }
    }
    return groups;
}

std::vector<double> tausOf(const RunGroup& runs) {
    std::set<double> taus;
    for (const BenchRun* run : runs) taus.insert(run->tauPx);
    return {taus.begin(), taus.end()};
}

}  // namespace pagoda::tools
