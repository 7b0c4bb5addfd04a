#include "tools/stress/stress.h"
#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "tools/bench/report_file.h"
#include "tools/session.h"
#include "tools/stress/stress_html.h"
#include "tools/stress/stress_plots.h"
#include "tools/stress/workloads.h"
#include "viewer/gl_context.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda stress plant.pagoda --html stress.html
  pagoda stress plant.pagoda --workload teleport,thrash --json r.json --csv r.csv
  pagoda stress plant.pagoda --disk 20MB/s,5ms --disk 500MB/s,fail=10% --gpu-budget 64MiB
  pagoda stress plant.pagoda --upload-budget 1MiB --frames 120 --size 1024x768

Workloads: orbit; flythrough (through the rooms, or past the surface where there are none); zigzag;
teleport (four places); thrash (the flythrough with 5% of the GPU memory that it needs). Each runs
from cold against each disk, and once with all it needs in memory. Disks are simulated on a virtual
clock, a fixed time a frame: what is read, missing and drawn is the same on every run with the same
options. Frame times are measured: they depend on the machine. A hitch is a frame of more than twice
the cell's median and more than 16 ms. docs/stress.md says what each number means.

Memory: up to the host and GPU budgets for each disk, and what the workload needs once more.)";

struct Arguments {
    std::vector<std::string> disks;
    std::string up, size = "640x480", json, csv, html;
    StressPlan plan;
};

void fillPlan(Arguments& arguments) {
    StressPlan& plan = arguments.plan;
    if (plan.workloads.empty()) {
        for (const Workload& workload : workloads()) plan.workloads.emplace_back(workload.name);
    }
    for (const std::string& profile : arguments.disks) {
        static_cast<void>(cache::parseDiskProfile(profile));
        plan.disks.push_back({profile, profile});
    }
    if (plan.disks.empty()) plan.disks = stressDisks();
    const PictureSize size = parsePictureSize(arguments.size);
    plan.widthPx = size.widthPx;
    plan.heightPx = size.heightPx;
    plan.runtime.checkStrategies(std::span(&plan.runtime.strategy, 1));
    static_cast<void>(plan.runtime.rendererOptions());  // throws for budgets that are none
    for (const std::string* file : {&arguments.json, &arguments.csv, &arguments.html}) {
        checkReportFile(*file);
    }
    const ooc::Database database = ooc::Database::open(plan.database);
    plan.modelTriangles = database.header().triangleCount;
    plan.modelNodes = database.header().nodeCount;
    plan.modelBytes = database.header().fileBytes;
    if (arguments.up.empty()) {
        plan.up = hlod::upAxisOf(database.metadataJson());
    } else if (arguments.up == "y") {
        plan.up = hlod::UpAxis::Y;
    }
}

void printTable(const std::vector<StressCell>& cells) {
    fmt::print("{:<10} {:<17} {:>8} {:>8} {:>8} {:>7} {:>7} {:>8} {:>9} {:>8} {:>6} {:>6} {:>6}\n",
               "workload", "disk", "p50 ms", "p99 ms", "max ms", "p99/res", "hitches", "missing",
               "sharp s", "read MB", "waste", "tau", "over");
    for (const StressCell& cell : cells) {
        const SharpTimes sharp = sharpTimesOf(cell);
        const double read = static_cast<double>(cell.bytes.read);
        std::string sharpText = "-";
        if (!cell.jumps.empty()) {
            sharpText = fmt::format("{:.2f} {}/{}", sharp.medianS, sharp.count, cell.jumps.size());
        }
        fmt::print(
            "{:<10} {:<17} {:>8.2f} {:>8.2f} {:>8.2f} {:>7.2f} {:>7} {:>7.2f}% {:>9} {:>8.2f} "
            "{:>5.0f}% {:>6.2f} {:>6}\n",
            cell.workload, cell.disk.name, cell.frameMs.median, cell.frameMs.p99, cell.frameMs.max,
            cell.frameP99OverResident, cell.hitches, 100 * cell.missingShare(), sharpText,
            read * 1e-6, read > 0 ? 100 * static_cast<double>(cell.bytes.wasted) / read : 0.0,
            cell.greatestTauPx, cell.peaks.framesOver);
    }
}

void writeReports(const Arguments& arguments, const std::vector<StressCell>& cells,
                  const std::string& device, Progress& progress) {
    const StressPlan& plan = arguments.plan;
    if (!arguments.json.empty()) {
        writeReportFile(arguments.json, stressToJson(plan, cells, device));
    }
    if (!arguments.csv.empty()) writeReportFile(arguments.csv, stressToCsv(cells));
    if (arguments.html.empty()) return;
    const Figures figures = drawStressFigures(cells);
    writeReportFile(arguments.html, stressToHtml(plan, cells, device, figures));
    if (!figures.problem.empty()) {
        progress.warn(fmt::format("{}: without figures: {}", arguments.html, figures.problem));
    }
}

void stress(Arguments& arguments, Session& session) {
    fillPlan(arguments);
    const StressPlan& plan = arguments.plan;
    const ooc::Database database = ooc::Database::open(plan.database);
    const viewer::GlContext context = viewer::GlContext::headless();
    WorkloadPaths paths(database, plan.up, plan.frames, plan.seed, *session.progress);
    std::vector<StressCell> cells;
    for (const std::string& workload : plan.workloads) {
        for (StressCell& cell : runStress(plan, workload, paths, *session.progress)) {
            for (const std::string& fault : cell.faults) {
                std::cerr << "pagoda: " << plan.database << ": " << fault << '\n';
                // What a simulated disk fails is what it was asked for.
                if (fault.find("simulated") == std::string::npos) session.exitCode = 1;
            }
            cells.push_back(std::move(cell));
        }
    }
    printTable(cells);
    writeReports(arguments, cells, context.rendererName(), *session.progress);
}

void addPlanOptions(CLI::App& command, Arguments& arguments) {
    StressPlan& plan = arguments.plan;
    std::vector<std::string> names;
    for (const Workload& workload : workloads()) names.emplace_back(workload.name);
    command.add_option("--workload", plan.workloads, "Which (default: all)")
        ->delimiter(',')
        ->check(CLI::IsMember(names));
    command.add_option("--frames", plan.frames, "Of each workload on each disk")
        ->check(CLI::Range(size_t{4}, size_t{100'000}))
        ->capture_default_str();
    command.add_option("--fps", plan.framesPerSecond, "Frames a second of the virtual clock")
        ->check(CLI::Range(1.0, 1000.0))
        ->capture_default_str();
    command.add_option("--size", arguments.size, "Width and height of the picture, pixels")
        ->capture_default_str();
    command.add_option("--seed", plan.seed, "Of paths and failures")->capture_default_str();
    command.add_option("--strategy", plan.runtime.strategy, "What to draw with")
        ->check(CLI::IsMember(strategyNames()))
        ->capture_default_str();
    command.add_option("--tau", plan.runtime.tauPx, "Allowed error on the screen, pixels")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    addDetailOption(command, plan.runtime);
    command.add_flag("!--no-resident", plan.hasResident,
                     "Leave the cells out that have all in memory");
    command.add_option("--up", arguments.up, "Up axis (default: the database's)")
        ->check(CLI::IsMember({"y", "z"}));
}

}  // namespace

void addStressCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    arguments->plan.runtime.strategy = "coh";
    CLI::App* command = app.add_subcommand(
        "stress", "Hard workloads against slow disks: hitches, missing detail, budgets");
    command->footer(kExamples);
    command->add_option("database", arguments->plan.database, "The database")->required();
    addPlanOptions(*command, *arguments);
    command->add_option("--json", arguments->json, "Write all numbers as JSON");
    command->add_option("--csv", arguments->csv, "Write one line a cell as CSV");
    command->add_option("--html", arguments->html,
                        "Write a report with tables and figures (drawn by gnuplot) as one file");
    addRuntimeOptions(*command, arguments->plan.runtime);
    command->remove_option(command->get_option("--disk"));
    command->add_option("--disk", arguments->disks,
                        "A simulated disk, once for each: as-is, or parts such as "
                        "100MB/s,10ms,fail=1%,short=5% (default: six of them)");
    command->callback([arguments, command, &session] {
        arguments->plan.command = commandText(*command, {});
        arguments->plan.runtime.tauPx = arguments->plan.runtime.effectiveTauPx();
        stress(*arguments, session);
    });
}

}  // namespace pagoda::tools
