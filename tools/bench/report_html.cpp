#include "tools/bench/report_html.h"

#include "tools/bench/ratios.h"
#include "tools/bench/truth.h"
#include "tools/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <thread>

namespace pagoda::tools {
namespace {

// Readable on a screen and on A4; on paper, tables get smaller and figures do not.
constexpr const char* kStyle = R"(
body { font: 15px/1.45 "Liberation Sans", Arial, Helvetica, sans-serif; color: #1a1a1a;
  background: #fff; max-width: 74rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; }
h2 { break-after: avoid; font-size: 1.15rem; margin: 2.2rem 0 .5rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: 1rem 0; }
dt { color: #555; } dd { margin: 0; }
code { font: .87em "Liberation Mono", Consolas, monospace; overflow-wrap: anywhere; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 12px; font-variant-numeric: tabular-nums; }
th, td { padding: 2px 6px; text-align: right; white-space: nowrap; }
th { font-weight: normal; color: #444; vertical-align: bottom; }
td:first-child, th:first-child { text-align: left; }
thead tr:first-child th { text-align: center; border-bottom: 1px solid #bbb; }
thead tr:last-child th { border-bottom: 1px solid #333; }
tbody th { text-align: left; padding-top: 8px; font-weight: bold; color: #1a1a1a; }
tbody tr:last-child td { border-bottom: 1px solid #bbb; }
.part { border-left: 1px solid #ddd; }
.note, figcaption { color: #444; font-size: .87rem; max-width: 46rem; }
figure { margin: 1.6rem 0 2.2rem; max-width: 720px; break-inside: avoid; }
figure h3 { font-size: 1rem; margin: 0 0 .2rem; }
svg { width: 100%; height: auto; display: block; }
@media print { @page { size: A4; margin: 12mm; } body { margin: 0; max-width: none; }
  table { font-size: 8.5px; } th, td { padding: 1px 2.5px; } .wide { overflow: visible; } }
)";

// Three digits, more where they stand before the point: what differs further is noise.
std::string number(double value) {
    if (value == 0) return "0";
    const double size = std::abs(value);
    if (size < 0.01) return fmt::format("{:.1e}", value);
    if (size < 10) return fmt::format("{:.2f}", value);
    if (size < 100) return fmt::format("{:.1f}", value);
    if (size < 1e15) return formatCount(static_cast<uint64_t>(std::llround(size)));
    return fmt::format("{:.2e}", value);
}

std::string decibels(double psnr) {
    return psnr >= kEqualDb ? "equal" : fmt::format("{:.1f}", psnr);
}

std::string megabytes(uint64_t bytes) {
    return number(static_cast<double>(bytes) * 1e-6);
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

std::string term(const char* name, const std::string& html) {
    return fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, html);
}

std::string summary(const BenchPlan& plan, const std::vector<BenchRun>& runs,
                    const std::string& device, const std::string& name) {
    const hlod::StrategyOptions options = plan.runtime.strategyOptions();
    std::string html = "<dl>\n";
    html +=
        term("Database", fmt::format("{}: {} triangles in {} nodes, {}", escapedHtml(name),
                                     formatCount(plan.modelTriangles), formatCount(plan.modelNodes),
                                     formatBytes(plan.modelBytes)));
    html += term("Machine", fmt::format("{} cores; {}", std::thread::hardware_concurrency(),
                                        escapedHtml(device)));
    html +=
        term("Settings",
             fmt::format("bias {:g},{:g}, caution {:g}; budgets: host {}, GPU {}, upload {}; disk "
                         "{}; paths at {:g}x "
                         "speed; {} timed {}; pixels compared every {} frames",
                         options.biasS, options.biasT, options.caution,
                         escapedHtml(plan.runtime.hostBudget), escapedHtml(plan.runtime.gpuBudget),
                         plan.runtime.uploadBudget.empty() ? "without bound"
                                                           : escapedHtml(plan.runtime.uploadBudget),
                         escapedHtml(plan.runtime.disk), plan.speed, plan.repeats,
                         plan.repeats == 1 ? "pass" : "passes", plan.truthEvery));
    html += term("Command", "<code>" + escapedHtml(plan.command) + "</code>");
    std::string unsettled;
    for (const BenchRun& run : runs) {
        if (run.unsettledFrames == 0) continue;
        unsettled += fmt::format("{}{} at tau {:g}: {}", unsettled.empty() ? "" : "; ",
                                 escapedHtml(run.strategy), run.tauPx, run.unsettledFrames);
    }
    if (!unsettled.empty()) html += term("Not settled, frames", unsettled);
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

class Row {
public:
    void cell(const std::string& text, bool isFirstOfPart = false) {
        html_ += fmt::format("<td{}>{}</td>", isFirstOfPart ? " class=\"part\"" : "", text);
    }
    void spread(const Spread& spread) {
        cell(number(spread.median), true);
        for (const double value : {spread.p95, spread.p99, spread.max}) cell(number(value));
    }
    std::string take() { return "<tr>" + html_ + "</tr>\n"; }

private:
    std::string html_;
};

std::string runRow(const BenchRun& run) {
    const bool isCompared = run.truthFrames > 0;
    Row row;
    row.cell(escapedHtml(run.strategy));
    row.cell(fmt::format("{:g}", run.tauPx));
    row.cell(number(run.drawnNodes), true);
    for (const double mean : {run.drawnTriangles * 1e-3, run.queries, run.rarn, run.delayed}) {
        row.cell(number(mean));
    }
    row.cell(isCompared ? number(run.wrongPixels) : "", true);
    row.cell(isCompared ? number(run.tiedPixels) : "");
    row.cell(isCompared ? number(run.overdrawnPixels) : "");
    row.cell(isCompared ? decibels(run.psnrLuma) : "", true);
    row.cell(isCompared ? decibels(run.psnrCb) : "");
    row.cell(isCompared ? decibels(run.psnrCr) : "");
    row.spread(run.cpuMs);
    row.spread(run.frameMs);
    row.cell(megabytes(run.bytesRead), true);
    row.cell(megabytes(run.bytesExact));
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

std::string leavesTable(const std::vector<BenchRun>& runs) {
    std::string rows;
    for (const BenchRun& run : runs) {
        if (run.referenceFrames == 0) continue;
        rows += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:g}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            configurationName(run), escapedHtml(run.strategy), run.tauPx, run.referenceFrames,
            number(run.referenceIdDifferences), decibels(run.psnrLumaReference));
    }
    if (rows.empty()) return "";
    return "<h2>Against the leaves</h2>\n<div class=\"wide\"><table>\n<thead><tr><th>path</th>"
           "<th>strategy</th><th>tau, px</th><th>frames compared</th>"
           "<th>pixels of other ids, a frame</th><th>PSNR Y, dB</th></tr></thead>\n<tbody>\n" +
           rows + "</tbody></table></div>\n";
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

std::string figuresHtml(const Figures& figures) {
    std::string html = "<h2>Figures</h2>\n";
    if (!figures.problem.empty()) {
        html += fmt::format(
            "<p class=\"note\">No figures: {}. Install the package gnuplot-nox and "
            "run the command again.</p>\n",
            escapedHtml(figures.problem));
    }
    for (const Figure& figure : figures.figures) {
        html += fmt::format("<figure>\n<h3>{}</h3>\n{}<figcaption>{}</figcaption>\n</figure>\n",
                            escapedHtml(figure.heading), figure.svg, escapedHtml(figure.caption));
    }
    return html;
}

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

std::string escapedHtml(std::string_view text) {
    std::string html;
    for (const char c : text) {
        switch (c) {
            case '&':
                html += "&amp;";
                break;
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '"':
                html += "&quot;";
                break;
            case '\'':
                html += "&#39;";
                break;
            default:
                html += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
        }
    }
    return html;
}

std::string benchToHtml(const BenchPlan& plan, const std::vector<BenchRun>& runs,
                        const std::string& device, const Figures& figures) {
    const std::string name = std::filesystem::path(plan.database).filename().string();
    const std::string title = "Error against run time: " + escapedHtml(name);
    return fmt::format(
               "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
               "<meta name=\"viewport\" content=\"width=device-width\">\n"
               "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
               title, kStyle) +
           summary(plan, runs, device, name) + faultsHtml(runs) + runsTable(runs) +
           leavesTable(runs) + ratiosTable(runs) + figuresHtml(figures) + "</body>\n</html>\n";
}

}  // namespace pagoda::tools
