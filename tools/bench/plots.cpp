#include "tools/bench/plots.h"

#include "tools/bench/gnuplot.h"
#include "tools/bench/plot_scripts.h"

#include <fmt/format.h>

#include <algorithm>

namespace pagoda::tools {
namespace {

// Points of all lines together: some 12 bytes each in SVG, so that lines take less than 150 kB.
constexpr size_t kMaxLinePoints = 12000;
bool isSamePlace(const BenchRun& a, const BenchRun& b) {
    return a.pathName == b.pathName && a.widthPx == b.widthPx && a.heightPx == b.heightPx &&
           a.queryLatencyFrames == b.queryLatencyFrames;
}
bool hasSameTau(const BenchRun& a, const BenchRun& b) {
    return a.tauPx == b.tauPx;
}
std::string errorCaption(const RunGroup& runs) {
    std::string caption =
        "Left: mean PSNR of luma against the cut at tau without culling; equal: no pixel of any "
        "frame differs. Right: full marks are wrong pixels; hollow ones, where there are any, "
        "are pixels of nodes drawn beside what refines them (RARN). Times are medians.";
    const std::vector<double> taus = tausOf(runs);
    if (taus.size() > 1) {
        caption += " Larger marks are larger tau: ";
        for (const double tau : taus) {
            caption += fmt::format("{}{:g}", tau == taus.front() ? "" : ", ", tau);
        }
        caption += " px.";
    }
    return caption;
}

// The median over the repeats of each frame.
std::vector<double> medianOverRepeats(const std::vector<double>& series, size_t frames) {
    std::vector<double> medians;
    for (size_t frame = 0; frame < frames; ++frame) {
        std::vector<double> values;
        for (size_t i = frame; i < series.size(); i += frames) values.push_back(series[i]);
        medians.push_back(spreadOf(std::move(values)).median);
    }
    return medians;
}

class Drawing {
public:
    explicit Drawing(size_t runCount)
        : maxPoints_(
              std::clamp<size_t>(kMaxLinePoints / (2 * std::max<size_t>(runCount, 1)), 25, 250)) {}

    void errorAndBars(const RunGroup& runs, const std::string& where) {
        if (runs.front()->truthFrames > 0) {
            add("Error against run time: " + where, errorCaption(runs), errorScript(runs), 300);
        }
        add("Where the time goes: " + where, "Medians of the parts of a frame.", partsScript(runs),
            barHeight(runs));
        if (runs.front()->bytesExact > 0) {
            add("Bytes read: " + where,
                "From cold, every frame settled. Needed: pages with a pixel in the picture, and "
                "their ancestors. Above the bars: read over needed.",
                bytesScript(runs), barHeight(runs));
        }
    }

    void alongThePath(const RunGroup& runs, const std::string& where) {
        const size_t frames = runs.front()->frames;
        const size_t stride = (frames + maxPoints_ - 1) / maxPoints_;
        std::vector<PathLine> times, nodes;
        for (const BenchRun* run : runs) {
            times.push_back({run->strategy, medianOverRepeats(run->cpuMsSeries, frames)});
            nodes.push_back({run->strategy, run->drawnNodesSeries});
        }
        const std::string means =
            stride > 1 ? fmt::format(" Points are means of {} frames.", stride) : "";
        add("CPU time along the path: " + where,
            fmt::format("Median over {} {}.{}", runs.front()->repeats,
                        runs.front()->repeats == 1 ? "pass" : "passes", means),
            linesScript(times, stride, "CPU time a frame, ms"), 300);
        add("Drawn nodes along the path: " + where, "The last pass." + means,
            linesScript(nodes, stride, "drawn nodes a frame"), 300);
    }

    Figures take() {
        if (!gnuplot_.problem().empty()) figures_ = {{}, gnuplot_.problem()};
        return std::move(figures_);
    }

private:
    static int barHeight(const RunGroup& runs) { return runs.size() > 7 ? 340 : 270; }
    void add(std::string heading, std::string caption, const std::string& script, int height) {
        const std::string id = fmt::format("f{}", figures_.figures.size());
        std::string svg = gnuplot_.svg(script, {kFigureWidthPx, height}, id);
        figures_.figures.push_back({std::move(heading), std::move(caption), std::move(svg)});
    }

    size_t maxPoints_;
    Gnuplot gnuplot_;
    Figures figures_;
};

}  // namespace

Figures drawFigures(const std::vector<BenchRun>& runs) {
    RunGroup all;
    for (const BenchRun& run : runs) all.push_back(&run);
    Drawing drawing(runs.size());
    for (const RunGroup& place : grouped(all, isSamePlace)) {
        const BenchRun& first = *place.front();
        const std::string where = fmt::format(
            "{}, {}x{}{}", first.pathName, first.widthPx, first.heightPx,
            first.queryLatencyFrames == 0 ? ""
                                          : fmt::format(", latency {}", first.queryLatencyFrames));
        drawing.errorAndBars(place, where);
        for (const RunGroup& runsAtTau : grouped(place, hasSameTau)) {
            drawing.alongThePath(runsAtTau,
                                 fmt::format("{}, tau {:g} px", where, runsAtTau.front()->tauPx));
        }
    }
    return drawing.take();
}

}  // namespace pagoda::tools
