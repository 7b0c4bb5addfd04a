#include "tools/bench/report_html.h"

#include "tools/bench/ratios.h"
#include "tools/bench/report_page.h"
#include "tools/bench/truth.h"
#include "tools/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <thread>

namespace pagoda::tools {
namespace {

std::string decibels(double psnr) {
    return psnr >= kEqualDb ? "equal" : fmt::format("{:.1f}", psnr);
}

std::string configurationName(const BenchRun& run) {
    return fmt::format("{}, {} frames, {}x{}, query latency {}", escapedHtml(run.pathName),
                       run.frames, run.widthPx, run.heightPx, run.queryLatencyFrames);
}

bool isSamePlace(const BenchRun& a, const BenchRun& b) {
    return a.pathName == b.pathName && a.widthPx == b.widthPx && a.heightPx == b.heightPx &&
           a.queryLatencyFrames == b.queryLatencyFrames;
}

// ---- What it is about

std::string summary(const BenchPlan& plan, const std::vector<BenchRun>& runs,
                    const std::string& device, const std::string& name) {
    const hlod::StrategyOptions options = plan.runtime.strategyOptions();
    std::string html = "<dl>\n";
    html += termHtml("Database",
                     fmt::format("{}: {} triangles in {} nodes, {}", escapedHtml(name),
                                 formatCount(plan.modelTriangles), formatCount(plan.modelNodes),
                                 formatBytes(plan.modelBytes)));
    html += termHtml("Machine", fmt::format("{} cores; {}", std::thread::hardware_concurrency(),
                                            escapedHtml(device)));
    html += termHtml(
        "Settings",
        fmt::format("bias {:g},{:g},{:g}, caution {:g}; budgets: host {}, GPU {}, upload {}; disk "
                    "{}; paths at {:g}x "
                    "speed; {} timed {}; pixels compared every {} frames",
                    options.biasS, options.biasT, options.biasFloor, options.caution,
                    escapedHtml(plan.runtime.hostBudget), escapedHtml(plan.runtime.gpuBudget),
                    plan.runtime.uploadBudget.empty() ? "without bound"
                                                      : escapedHtml(plan.runtime.uploadBudget),
                    escapedHtml(plan.runtime.disk), plan.speed, plan.repeats,
                    plan.repeats == 1 ? "pass" : "passes", plan.truthEvery));
    html += termHtml("Command", "<code>" + escapedHtml(plan.command) + "</code>");
    std::string unsettled;
    for (const BenchRun& run : runs) {
        if (run.unsettledFrames == 0) continue;
        unsettled += fmt::format("{}{} at tau {:g}: {}", unsettled.empty() ? "" : "; ",
                                 escapedHtml(run.strategy), run.tauPx, run.unsettledFrames);
    }
    if (!unsettled.empty()) html += termHtml("Not settled, frames", unsettled);
    return html + "</dl>\n";
}

// ---- All runs

constexpr const char* kRunsHead = R"(<thead>
<tr><th colspan="2"></th><th colspan="5" class="part">mean a frame</th>
<th colspan="3" class="part">pixels a frame</th><th colspan="3" class="part">PSNR, dB</th>
<th colspan="4" class="part">CPU ms a frame</th><th colspan="4" class="part">frame ms (wall)</th>
<th colspan="3" class="part">MB over the path</th></tr>
<tr><th>strategy</th><th>tau, px</th>
<th class="part">nodes</th><th>k tri.</th><th>queries</th><th>RARN</th><th>delayed</th>
<th class="part">wrong</th><th>tied</th><th>RARN</th>
<th class="part">Y</th><th>Cb</th><th>Cr</th>
<th class="part">median</th><th>p95</th><th>p99</th><th>max</th>
<th class="part">median</th><th>p95</th><th>p99</th><th>max</th>
<th class="part">read</th><th>exact</th><th>ratio</th></tr>
</thead>
)";

std::string runRow(const BenchRun& run) {
    const bool isCompared = run.truthFrames > 0;
    HtmlRow row;
    row.cell(escapedHtml(run.strategy));
    row.cell(fmt::format("{:g}", run.tauPx));
    row.cell(shownHtml(run.drawnNodes), true);
    for (const double mean : {run.drawnTriangles * 1e-3, run.queries, run.rarn, run.delayed}) {
        row.cell(shownHtml(mean));
    }
    row.cell(isCompared ? shownHtml(run.wrongPixels) : "", true);
    row.cell(isCompared ? shownHtml(run.tiedPixels) : "");
    row.cell(isCompared ? shownHtml(run.overdrawnPixels) : "");
    row.cell(isCompared ? decibels(run.psnrLuma) : "", true);
    row.cell(isCompared ? decibels(run.psnrCb) : "");
    row.cell(isCompared ? decibels(run.psnrCr) : "");
    row.spread(run.cpuMs);
    row.spread(run.frameMs);
    row.cell(megabytesHtml(run.bytesRead), true);
    row.cell(megabytesHtml(run.bytesExact));
    row.cell(run.bytesExact > 0 ? fmt::format("{:.2f}", static_cast<double>(run.bytesRead) /
                                                            static_cast<double>(run.bytesExact))
                                : "");
    return row.take();
}

std::string runsTable(const std::vector<BenchRun>& runs) {
    std::string html = "<h2>All runs</h2>\n<div class=\"wide\"><table>\n";
    html += kRunsHead;
    const BenchRun* place = nullptr;
    for (const BenchRun& run : runs) {
        if (place == nullptr || !isSamePlace(*place, run)) {
            html += fmt::format("{}<tbody><tr><th colspan=\"24\">{}</th></tr>\n",
                                place == nullptr ? "" : "</tbody>\n", configurationName(run));
            place = &run;
        }
        html += runRow(run);
    }
    if (place != nullptr) html += "</tbody>\n";
    return html +
           "</table></div>\n<p class=\"note\">Pixels and PSNR: against the strategy's own cut "
           "(wrong, tied, RARN) and the cut at tau (PSNR), both without culling; equal: no pixel "
           "of any frame differs. RARN: rendered already, refinement needed. Exact: the pages that "
           "the visible pixels need, with their ancestors.</p>\n";
}

// ---- Against the leaves

std::string leavesRow(const BenchRun& run, const char* pass, size_t frames, uint64_t holes,
                      uint64_t holeFrames, const std::string& ids, const std::string& quality) {
    HtmlRow row;
    row.cell(configurationName(run));
    row.cell(escapedHtml(run.strategy));
    row.cell(fmt::format("{:g}", run.tauPx));
    row.cell(pass);
    row.cell(fmt::format("{}", frames));
    row.cell(formatCount(holes));
    row.cell(fmt::format("{}", holeFrames));
    row.cell(ids);
    row.cell(quality);
    return row.take();
}

std::string leavesTable(const std::vector<BenchRun>& runs) {
    std::string rows;
    for (const BenchRun& run : runs) {
        if (run.referenceFrames > 0) {
            rows +=
                leavesRow(run, "all resident", run.referenceFrames, run.holes, run.holeFrames,
                          shownHtml(run.referenceIdDifferences), decibels(run.psnrLumaReference));
        }
        const LivePass& live = run.live;
        if (live.referenceFrames > 0) {
            rows +=
                leavesRow(run, "live", live.referenceFrames, live.holes, live.holeFrames, "", "");
        }
    }
    if (rows.empty()) return "";
    return "<h2>Against the leaves</h2>\n<div class=\"wide\"><table>\n<thead><tr><th>path</th>"
           "<th>strategy</th><th>tau, px</th><th>pass</th><th>frames compared</th><th>holes, "
           "pixels in all</th><th>frames with any</th><th>pixels of other ids, a frame</th>"
           "<th>PSNR Y, dB</th></tr></thead>\n<tbody>\n" +
           rows +
           "</tbody></table></div>\n<p class=\"note\">Hole: the leaves cover all pixels within "
           "ceil(tau) + 1 of it, and it shows background, or a surface behind them all by more "
           "than its node's error.</p>\n";
}

// ---- A camera that stands still

std::string stillTable(const std::vector<BenchRun>& runs) {
    std::string rows;
    for (const BenchRun& run : runs) {
        const StillPass& still = run.still;
        if (still.frames == 0) continue;
        HtmlRow row;
        row.cell(configurationName(run));
        row.cell(escapedHtml(run.strategy));
        row.cell(fmt::format("{:g}", run.tauPx));
        for (const uint64_t count :
             {uint64_t{still.frames}, still.coarser.coarser(), still.coarserFrames,
              still.coarser.byOthers, still.coarser.byStandIns, still.coarser.byTau}) {
            row.cell(formatCount(count));
        }
        rows += row.take();
    }
    if (rows.empty()) return "";
    return "<h2>A camera that stands still</h2>\n<div class=\"wide\"><table>\n<thead><tr>"
           "<th>path</th><th>strategy</th><th>tau, px</th><th>frames</th><th>pixels that got "
           "coarser</th><th>frames with any</th><th>of these: another surface</th><th>not of "
           "these: stand-ins</th><th>tau rose</th></tr></thead>\n<tbody>\n" +
           rows +
           "</tbody></table></div>\n<p class=\"note\">Pixels whose node has a greater error "
           "than in the frame before.</p>\n";
}

// ---- Ratios

const CpuRatio* find(const std::vector<CpuRatio>& ratios, size_t numerator, size_t denominator,
                     bool isHardest) {
    const auto found = std::find_if(ratios.begin(), ratios.end(), [&](const CpuRatio& ratio) {
        return ratio.numerator == numerator && ratio.denominator == denominator &&
               ratio.isHardest == isHardest;
    });
    return found == ratios.end() ? nullptr : &*found;
}

std::string ratioCell(const CpuRatio* ratio) {
    if (ratio == nullptr) return "<td>&middot;</td>";
    return fmt::format("<td>{:.2f} [{:.2f}, {:.2f}]</td>", ratio->ratio.value, ratio->ratio.low,
                       ratio->ratio.high);
}

// Runs of one configuration stand side by side, from `begin` to before `end`.
std::string ratioMatrix(const std::vector<BenchRun>& runs, const std::vector<CpuRatio>& ratios,
                        size_t begin, size_t end) {
    std::string html =
        fmt::format("<tbody><tr><th colspan=\"{}\">{}, tau {:g} px</th></tr>\n<tr><td></td>",
                    end - begin + 1, configurationName(runs[begin]), runs[begin].tauPx);
    for (size_t k = begin; k < end; ++k) {
        html += fmt::format("<td>/ {}</td>", escapedHtml(runs[k].strategy));
    }
    html += "</tr>\n";
    for (size_t i = begin; i < end; ++i) {
        for (const bool isHardest : {false, true}) {
            if (isHardest && runs[i].strategy != "frustum") continue;
            html += fmt::format("<tr><td>{}{}</td>", escapedHtml(runs[i].strategy),
                                isHardest ? ", hardest frames" : "");
            for (size_t k = begin; k < end; ++k) html += ratioCell(find(ratios, i, k, isHardest));
            html += "</tr>\n";
        }
    }
    return html + "</tbody>\n";
}

std::string ratiosTable(const std::vector<BenchRun>& runs) {
    const std::vector<CpuRatio> ratios = cpuRatios(runs);
    if (ratios.empty()) return "";
    std::string html =
        "<h2>CPU time of one strategy over another's</h2>\n"
        "<div class=\"wide\"><table class=\"ratios\">\n";
    for (size_t begin = 0, end = 0; begin < runs.size(); begin = end) {
        while (end < runs.size() && isSameConfiguration(runs[begin], runs[end])) ++end;
        html += ratioMatrix(runs, ratios, begin, end);
    }
    return html +
           "</table></div>\n<p class=\"note\">Row over column, so that 2 means: the column's "
           "strategy is twice as fast. In brackets the bootstrap interval of 95% over pairs of "
           "frames that were measured one after the other. Hardest: the tenth of the frames that "
           "costs frustum most.</p>\n";
}

// ---- The rest

std::string faultsHtml(const std::vector<BenchRun>& runs) {
    std::string items;
    for (const BenchRun& run : runs) {
        for (const std::string& fault : run.faults) {
            items +=
                fmt::format("<li>{}: {}</li>\n", escapedHtml(run.strategy), escapedHtml(fault));
        }
    }
    return items.empty() ? "" : "<h2>Faults</h2>\n<ul>\n" + items + "</ul>\n";
}

}  // namespace

std::string benchToHtml(const BenchPlan& plan, const std::vector<BenchRun>& runs,
                        const std::string& device, const Figures& figures) {
    const std::string name = std::filesystem::path(plan.database).filename().string();
    return htmlPage("Error against run time: " + name,
                    summary(plan, runs, device, name) + faultsHtml(runs) + runsTable(runs) +
                        leavesTable(runs) + stillTable(runs) + ratiosTable(runs) +
                        figuresHtml(figures));
}

}  // namespace pagoda::tools
