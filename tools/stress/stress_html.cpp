#include "tools/stress/stress_html.h"

#include "tools/bench/report_page.h"
#include "tools/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <thread>

namespace pagoda::tools {
namespace {

std::string percentHtml(double share) {
    if (share == 0) return "0";
    return share < 0.0001 ? "&lt; 0.01%" : fmt::format("{:.2f}%", 100 * share);
}

std::string nameOf(const StressCell& cell) {
    return escapedHtml(cell.workload + ", " + cell.disk.name);
}

// ---- What it is about

std::string budgetHtml(const std::string& text) {
    return text.empty() ? "without bound" : escapedHtml(text);
}

std::string summary(const StressPlan& plan, const std::string& device, const std::string& name) {
    const RuntimeOptions& runtime = plan.runtime;
    return "<dl>\n" +
           termHtml("Database",
                    fmt::format("{}: {} triangles in {} nodes, {}", escapedHtml(name),
                                formatCount(plan.modelTriangles), formatCount(plan.modelNodes),
                                formatBytes(plan.modelBytes))) +
           termHtml("Machine", fmt::format("{} cores; {}", std::thread::hardware_concurrency(),
                                           escapedHtml(device))) +
           termHtml("Settings",
                    fmt::format("{}, tau {:g} px, {}x{}, query latency {}; budgets: host {}, GPU "
                                "{}, upload {}; {} frames a cell at {:g} a second; seed {}",
                                escapedHtml(runtime.strategy), runtime.tauPx, plan.widthPx,
                                plan.heightPx, runtime.queryLatencyFrames,
                                budgetHtml(runtime.hostBudget), budgetHtml(runtime.gpuBudget),
                                budgetHtml(runtime.uploadBudget), plan.frames, plan.framesPerSecond,
                                plan.seed)) +
           termHtml("Command", "<code>" + escapedHtml(plan.command) + "</code>") + "</dl>\n";
}

// ---- At a glance

const StressCell& worst(const std::vector<StressCell>& cells,
                        const std::function<double(const StressCell&)>& badness) {
    return *std::max_element(
        cells.begin(), cells.end(),
        [&](const StressCell& a, const StressCell& b) { return badness(a) < badness(b); });
}

std::string budgetsAnswer(const std::vector<StressCell>& cells) {
    uint64_t over = 0, frames = 0;
    for (const StressCell& cell : cells) {
        over += cell.peaks.framesOver;
        frames += cell.frames;
    }
    if (over == 0) return fmt::format("Never, in {} frames.", formatCount(frames));
    const StressCell& cell =
        worst(cells, [](const StressCell& c) { return static_cast<double>(c.peaks.framesOver); });
    return fmt::format("<b>Yes: in {} of {} frames</b>, most in {}.", formatCount(over),
                       formatCount(frames), nameOf(cell));
}

std::string hitchesAnswer(const std::vector<StressCell>& cells) {
    uint64_t hitches = 0, frames = 0;
    for (const StressCell& cell : cells) {
        hitches += cell.hitches;
        frames += cell.frames;
    }
    if (hitches == 0) return fmt::format("Nowhere, in {} frames.", formatCount(frames));
    const StressCell& cell =
        worst(cells, [](const StressCell& c) { return static_cast<double>(c.hitches); });
    return fmt::format("{} of {} frames, most in {}: {} of {}, the longest {:.1f} ms.",
                       formatCount(hitches), formatCount(frames), nameOf(cell), cell.hitches,
                       cell.frames, cell.frameMs.max);
}

std::string missingAnswer(const std::vector<StressCell>& cells) {
    const StressCell& cell = worst(cells, [](const StressCell& c) { return c.missingShare(); });
    if (cell.missingPxS <= 0) return "Nowhere.";
    return fmt::format(
        "Most in {}: {} of all pixel-seconds, in {} of {} frames, at worst {} of a picture.",
        nameOf(cell), percentHtml(cell.missingShare()), cell.framesMissing, cell.frames,
        percentHtml(cell.worstMissingShare));
}

std::string glance(const std::vector<StressCell>& cells) {
    return "<h2>At a glance</h2>\n<dl>\n" + termHtml("Where does it hitch?", hitchesAnswer(cells)) +
           termHtml("Where is detail missing?", missingAnswer(cells)) +
           termHtml("Is a budget ever passed?", budgetsAnswer(cells)) + "</dl>\n";
}

// ---- Workloads across, disks down

std::vector<std::string> distinct(const std::vector<StressCell>& cells,
                                  const std::function<std::string(const StressCell&)>& nameOfCell) {
    std::vector<std::string> names;
    for (const StressCell& cell : cells) {
        const std::string name = nameOfCell(cell);
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    return names;
}

// White to orange: how many of the bounds a value passes.
struct Measure {
    const char* heading;
    std::vector<double> bounds;
    std::function<double(const StressCell&)> value;
    std::function<std::string(const StressCell&)> text;
};

std::string_view shadeOf(const Measure& measure, double value) {
    constexpr std::string_view kShades[] = {"", "#fdf1d8", "#f9d796", "#f2b36a"};
    size_t passed = 0;
    while (passed < measure.bounds.size() && passed < 3 && value > measure.bounds[passed]) ++passed;
    return kShades[passed];
}

std::string matrix(const std::vector<StressCell>& cells, const Measure& measure) {
    const auto workloads = distinct(cells, [](const StressCell& cell) { return cell.workload; });
    const auto disks = distinct(cells, [](const StressCell& cell) { return cell.disk.name; });
    std::string html = fmt::format("<table>\n<thead><tr><th>{}</th>", measure.heading);
    for (const std::string& workload : workloads) html += fmt::format("<th>{}</th>", workload);
    html += "</tr></thead>\n<tbody>\n";
    for (const std::string& disk : disks) {
        HtmlRow row;
        row.cell(escapedHtml(disk));
        for (const std::string& workload : workloads) {
            const auto cell = std::find_if(cells.begin(), cells.end(), [&](const StressCell& c) {
                return c.workload == workload && c.disk.name == disk;
            });
            row.shaded(measure.text(*cell), shadeOf(measure, measure.value(*cell)));
        }
        html += row.take();
    }
    return html + "</tbody></table>\n";
}

std::string matrices(const std::vector<StressCell>& cells) {
    const auto hitches = [](const StressCell& cell) { return static_cast<double>(cell.hitches); };
    const auto missing = [](const StressCell& cell) { return cell.missingShare(); };
    const auto ratio = [](const StressCell& cell) { return cell.cpuP99OverResident; };
    const auto tau = [](const StressCell& cell) { return cell.greatestTauPx; };
    const Measure measures[] = {
        {"Hitches, frames",
         {0, 3, 10},
         hitches,
         [](const StressCell& cell) { return std::to_string(cell.hitches); }},
        {"p99 of CPU time / all resident",
         {1.1, 1.5, 3},
         ratio,
         [](const StressCell& cell) { return fmt::format("{:.2f}", cell.cpuP99OverResident); }},
        {"Missing detail, share of pixel-seconds",
         {0, 0.005, 0.05},
         missing,
         [](const StressCell& cell) { return percentHtml(cell.missingShare()); }},
        {"Greatest effective tau, px",
         {cells.front().leastTauPx, 8, 64},
         tau,
         [](const StressCell& cell) { return shownHtml(cell.greatestTauPx); }},
    };
    std::string html = "<div class=\"wide\" style=\"display:flex;flex-wrap:wrap;gap:1.5rem\">\n";
    for (const Measure& measure : measures) html += matrix(cells, measure);
    return html + "</div>\n";
}

// ---- All cells

constexpr const char* kCellsHead = R"(<thead>
<tr><th></th><th colspan="4" class="part">frame ms (wall)</th>
<th colspan="4" class="part">CPU ms a frame</th><th colspan="2" class="part">hitches</th>
<th colspan="2" class="part">p99 / resident</th><th colspan="3" class="part">missing detail</th>
<th colspan="3" class="part">sharp after a jump</th><th colspan="6" class="part">MB</th>
<th colspan="3" class="part">reads</th><th colspan="3" class="part">peaks, MB</th>
<th class="part">tau</th></tr>
<tr><th>disk</th>
<th class="part">median</th><th>p95</th><th>p99</th><th>max</th>
<th class="part">median</th><th>p95</th><th>p99</th><th>max</th>
<th class="part">wall</th><th>CPU</th><th class="part">wall</th><th>CPU</th>
<th class="part">Mpx s</th><th>share</th><th>worst</th>
<th class="part">median s</th><th>jumps</th><th>/ bound</th>
<th class="part">read</th><th>drawn</th><th>waste</th><th>twice</th><th>index</th><th>gaps</th>
<th class="part">sent</th><th>failed</th><th>retried</th>
<th class="part">GPU</th><th>host</th><th>upload</th><th class="part">max</th></tr>
</thead>
)";
constexpr int kColumns = 33;

void jumpCells(HtmlRow& row, const StressCell& cell) {
    if (cell.jumps.empty()) {
        row.cell("", true);
        row.cell("");
        row.cell("");
        return;
    }
    const SharpTimes sharp = sharpTimesOf(cell);
    row.cell(sharp.count > 0 ? fmt::format("{:.2f}", sharp.medianS) : "", true);
    row.cell(fmt::format("{} of {}", sharp.count, cell.jumps.size()));
    row.cell(sharp.worstOverBound > 0 ? fmt::format("{:.2f}", sharp.worstOverBound) : "");
}

std::string cellRow(const StressCell& cell) {
    HtmlRow row;
    row.cell(escapedHtml(cell.disk.name));
    row.spread(cell.frameMs);
    row.spread(cell.cpuMs);
    row.cell(std::to_string(cell.hitches), true);
    row.cell(std::to_string(cell.cpuHitches));
    row.cell(shownHtml(cell.frameP99OverResident), true);
    row.cell(shownHtml(cell.cpuP99OverResident));
    row.cell(shownHtml(cell.missingPxS * 1e-6), true);
    row.cell(percentHtml(cell.missingShare()));
    row.cell(percentHtml(cell.worstMissingShare));
    jumpCells(row, cell);
    row.cell(megabytesHtml(cell.bytes.read), true);
    for (const uint64_t bytes : {cell.bytes.drawn, cell.bytes.wasted, cell.bytes.twice,
                                 cell.bytes.index, cell.bytes.gaps}) {
        row.cell(megabytesHtml(bytes));
    }
    row.cell(formatCount(cell.reads), true);
    row.cell(formatCount(cell.failedReads));
    row.cell(formatCount(cell.retries));
    row.cell(megabytesHtml(cell.peaks.gpuBytes), true);
    row.cell(megabytesHtml(cell.peaks.hostBytes));
    row.cell(megabytesHtml(std::max(cell.peaks.uploadBytes, cell.peaks.uploadBytesOfOnePage)));
    row.cell(shownHtml(cell.greatestTauPx), true);
    return row.take();
}

std::string cellsTable(const std::vector<StressCell>& cells) {
    std::string html = "<h2>All cells</h2>\n<div class=\"wide\"><table>\n";
    html += kCellsHead;
    const StressCell* group = nullptr;
    for (const StressCell& cell : cells) {
        if (group == nullptr || group->workload != cell.workload) {
            html += fmt::format(
                "{}<tbody><tr><th colspan=\"{}\">{} ({}), {} frames; GPU budget {}{}</th></tr>\n",
                group == nullptr ? "" : "</tbody>\n", kColumns, escapedHtml(cell.workload),
                escapedHtml(cell.madeOf), cell.frames,
                formatBytes(cells[static_cast<size_t>(&cell - cells.data()) +
                                  (cell.isResident && &cell != &cells.back() ? 1 : 0)]
                                .gpuBudget),
                cell.neededGpuBytes > 0
                    ? fmt::format("; needed {}", formatBytes(cell.neededGpuBytes))
                    : "");
            group = &cell;
        }
        html += cellRow(cell);
    }
    return html + (group == nullptr ? "" : "</tbody>\n") +
           "</table></div>\n<p class=\"note\">Missing detail: pixels drawn by stand-ins, "
           "integrated "
           "over virtual time. Bytes: pages drawn by some frame, by none, read again, index "
           "blocks, and what joined reads bring along. Upload: most in a frame. A hitch takes more "
           "than twice the median of its cell and more than 16 ms.</p>\n";
}

std::string faultsHtml(const std::vector<StressCell>& cells) {
    std::string items;
    for (const StressCell& cell : cells) {
        for (const std::string& fault : cell.faults) {
            items += fmt::format("<li>{}: {}</li>\n", nameOf(cell), escapedHtml(fault));
        }
    }
    return items.empty() ? "" : "<h2>Faults</h2>\n<ul>\n" + items + "</ul>\n";
}

}  // namespace

std::string stressToHtml(const StressPlan& plan, const std::vector<StressCell>& cells,
                         const std::string& device, const Figures& figures) {
    const std::string name = std::filesystem::path(plan.database).filename().string();
    return htmlPage("Streaming under load: " + name, summary(plan, device, name) + glance(cells) +
                                                         matrices(cells) + figuresHtml(figures) +
                                                         cellsTable(cells) + faultsHtml(cells));
}

}  // namespace pagoda::tools
