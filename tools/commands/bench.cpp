#include "tools/bench/bench.h"
#include "hlod/view/camera_path.h"
#include "ooc/base/error.h"
#include "ooc/base/file.h"
#include "ooc/store/database.h"
#include "tools/bench/plots.h"
#include "tools/bench/report_file.h"
#include "tools/bench/report_html.h"
#include "tools/session.h"
#include "viewer/gl_context.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda path plant.pagoda --kind walk --frames 200 -o walk.json
  pagoda bench plant.pagoda --path walk.json --strategy frustum,bool,coh --json r.json --csv r.csv
  pagoda bench plant.pagoda --path walk.json --tau 1,2,4 --html report.html
  pagoda bench plant.pagoda --path walk.json --strategy coh,hzb --tau 1,2,4 --size 640x480,1024x768
  pagoda bench plant.pagoda --path walk.json --strategy coh --query-latency 0,1,2 --repeats 1
  pagoda bench plant.pagoda --path walk.json --reference-every 20 --still-every 20 --repeats 0

Strategies take turns at every frame of the path. Each passes it settled from cold (bytes), live
with its pixels held against the same cut without culling (wrong pixels, PSNR against the cut at
tau), and live and timed. Times are wall milliseconds of a frame and CPU milliseconds of all
threads; ratios of CPU time come with a 95% interval. docs/bench.md says what each number means.)";

struct Arguments {
    std::string database, up;
    std::vector<std::string> paths, strategies{"frustum", "bool", "coh"}, sizes{"640x480"};
    std::vector<double> taus{1.0};
    std::vector<uint32_t> latencies{0};
    size_t frames = 0;
    std::string json, csv, html;
    BenchPlan plan;
};

std::string readText(const std::string& path) {
    const std::vector<std::byte> bytes = readWholeFile(path, hlod::kMaxPathBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

hlod::CameraPath readPath(const Arguments& arguments, const std::string& file) {
    hlod::CameraPath path = hlod::parseCameraPath(readText(file), {}, file);
    if (arguments.plan.speed != 1) path = hlod::atSpeed(path, arguments.plan.speed);
    if (arguments.frames > 0 && path.frames.size() > arguments.frames) {
        path.frames.resize(arguments.frames);
    }
    return path;
}

void addConfigurations(Arguments& arguments) {
    const bool isFull = arguments.plan.runtime.detail == "full";
    const std::vector<double> taus = isFull ? std::vector{0.0} : arguments.taus;
    for (const std::string& file : arguments.paths) {
        const hlod::CameraPath path = readPath(arguments, file);
        for (const std::string& size : arguments.sizes) {
            for (const double tauPx : taus) {
                for (const uint32_t latency : arguments.latencies) {
                    BenchConfiguration configuration;
                    configuration.pathName = std::filesystem::path(file).stem().string();
                    configuration.path = path;
                    configuration.tauPx = tauPx;
                    configuration.queryLatencyFrames = latency;
                    const PictureSize picture = parsePictureSize(size);
                    configuration.widthPx = picture.widthPx;
                    configuration.heightPx = picture.heightPx;
                    arguments.plan.configurations.push_back(std::move(configuration));
                }
            }
        }
    }
}

void writeReports(const Arguments& arguments, const std::vector<BenchRun>& runs,
                  const std::string& device, Progress& progress) {
    const BenchPlan& plan = arguments.plan;
    if (!arguments.json.empty()) writeReportFile(arguments.json, benchToJson(plan, runs, device));
    if (!arguments.csv.empty()) writeReportFile(arguments.csv, benchToCsv(runs));
    if (arguments.html.empty()) return;
    const Figures figures = drawFigures(runs);
    writeReportFile(arguments.html, benchToHtml(plan, runs, device, figures));
    if (!figures.problem.empty()) {
        progress.warn(fmt::format("{}: without figures: {}", arguments.html, figures.problem));
    }
}

void printLive(const BenchRun& run) {
    const LivePass& live = run.live;
    const cache::PrefetchCount ahead = sumOf(live.prefetch);
    const auto percent = [](uint64_t part, uint64_t whole) {
        return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0;
    };
    fmt::print(
        "{:<8} {:<12} live: fallback {:.3f}% of covered pixels, worst frame {:.1f}%; {:.1f} MB "
        "read, {:.1f} MB ahead, {:.0f}% of it used\n",
        run.strategy, run.pathName, percent(live.fallbackPixels, live.coveredPixels),
        100.0 * live.worstFallbackShare, static_cast<double>(live.pageBytesRead) * 1e-6,
        static_cast<double>(ahead.bytes) * 1e-6, percent(ahead.usedBytes, ahead.bytes));
}

void printHoles(const BenchRun& run, const char* pass, size_t frames, uint64_t holes,
                uint64_t holeFrames) {
    if (frames == 0) return;
    fmt::print("{:<8} {:<12} {}: {} holes in {} of {} frames held against the leaves\n",
               run.strategy, run.pathName, pass, holes, holeFrames, frames);
}

void printStill(const BenchRun& run) {
    const StillPass& still = run.still;
    if (still.frames == 0) return;
    fmt::print(
        "{:<8} {:<12} still: {} pixels got coarser in {} of {} frames ({} by another surface); {} "
        "more by stand-ins, {} by tau\n",
        run.strategy, run.pathName, still.coarser.coarser(), still.coarserFrames, still.frames,
        still.coarser.byOthers, still.coarser.byStandIns, still.coarser.byTau);
}

void printTable(const std::vector<BenchRun>& runs) {
    fmt::print(
        "{:<8} {:<12} {:>5} {:>9} {:>3} {:>8} {:>9} {:>8} {:>6} {:>7} {:>8} {:>7} {:>9} {:>8}\n",
        "strategy", "path", "tau", "size", "lat", "nodes", "k tri", "queries", "rarn", "delayed",
        "wrong px", "PSNR Y", "frame ms", "cpu ms");
    for (const BenchRun& run : runs) {
        fmt::print(
            "{:<8} {:<12} {:>5g} {:>9} {:>3} {:>8.1f} {:>9.1f} {:>8.1f} {:>6.2f} {:>7.2f} {:>8.2f} "
            "{:>7.1f} {:>9.2f} {:>8.2f}\n",
            run.strategy, run.pathName, run.tauPx, fmt::format("{}x{}", run.widthPx, run.heightPx),
            run.queryLatencyFrames, run.drawnNodes, run.drawnTriangles * 1e-3, run.queries,
            run.rarn, run.delayed, run.wrongPixels, run.psnrLuma, run.frameMs.median,
            run.cpuMs.median);
    }
    for (const BenchRun& run : runs) {
        if (run.live.frames > 0) printLive(run);
        printHoles(run, "all resident", run.referenceFrames, run.holes, run.holeFrames);
        printHoles(run, "live", run.live.referenceFrames, run.live.holes, run.live.holeFrames);
        printStill(run);
    }
}

void bench(Arguments& arguments, Session& session) {
    for (const std::string* file : {&arguments.json, &arguments.csv, &arguments.html}) {
        checkReportFile(*file);
    }
    arguments.plan.runtime.checkStrategies(arguments.strategies);
    addConfigurations(arguments);
    BenchPlan& plan = arguments.plan;
    plan.database = arguments.database;
    plan.strategies = arguments.strategies;
    const ooc::Database database = ooc::Database::open(arguments.database);
    plan.modelTriangles = database.header().triangleCount;
    plan.modelNodes = database.header().nodeCount;
    plan.modelBytes = database.header().fileBytes;
    plan.worldUp = Vec3f(hlod::upVector(hlod::upAxisOf(database.metadataJson())));
    const viewer::GlContext context = viewer::GlContext::headless();
    std::vector<BenchRun> runs;
    for (const BenchConfiguration& configuration : plan.configurations) {
        for (BenchRun& run : runBench(plan, configuration, *session.progress)) {
            if (!run.faults.empty()) session.exitCode = 1;
            for (const std::string& fault : run.faults) {
                std::cerr << "pagoda: " << arguments.database << ": " << fault << '\n';
            }
            runs.push_back(std::move(run));
        }
    }
    printTable(runs);
    writeReports(arguments, runs, context.rendererName(), *session.progress);
}

}  // namespace

void addBenchCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand(
        "bench", "Hold strategies against each other: error against run time along a path");
    command->footer(kExamples);
    command->add_option("database", arguments->database, "The database (NAME.pagoda)")->required();
    command->add_option("--path", arguments->paths, "Camera paths (`pagoda path`)")
        ->required()
        ->delimiter(',');
    command->add_option("--strategy", arguments->strategies, "Strategies to compare")
        ->delimiter(',')
        ->check(CLI::IsMember(strategyNames()))
        ->capture_default_str();
    command->add_option("--tau", arguments->taus, "Errors allowed on the screen, pixels")
        ->delimiter(',')
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    addDetailOption(*command, arguments->plan.runtime);
    command->add_option("--size", arguments->sizes, "Pictures in pixels, WxH")
        ->delimiter(',')
        ->capture_default_str();
    command->add_option("--speed", arguments->plan.speed, "Go along the path so many times as fast")
        ->check(CLI::Range(1.0, 1000.0))
        ->capture_default_str();
    command->add_option("--frames", arguments->frames, "The path's first frames only");
    command->add_option("--repeats", arguments->plan.repeats, "Timed passes; 0: none")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    command->add_flag("!--no-settled", arguments->plan.doesSettle,
                      "Leave the settled pass out, and with it the bytes");
    command
        ->add_option("--truth-every", arguments->plan.truthEvery,
                     "Compare the pixels of every N-th frame; 0: of none")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
    command
        ->add_option("--reference-every", arguments->plan.referenceEvery,
                     "Hold every N-th of these frames against the leaves too, and of those live "
                     "from a simulated disk; 0: none")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
    command
        ->add_option("--still-every", arguments->plan.stillEvery,
                     "Stop at every N-th frame and count pixels that get coarser; 0: nowhere")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
    command->add_option("--json", arguments->json, "Write all numbers as JSON");
    command->add_option("--csv", arguments->csv, "Write one line a run as CSV");
    command->add_option("--html", arguments->html,
                        "Write a report with tables and figures (drawn by gnuplot) as one file");
    addRuntimeOptions(*command, arguments->plan.runtime);
    auto* latency = command->get_option("--query-latency");
    command->remove_option(latency);
    command
        ->add_option("--query-latency", arguments->latencies,
                     "Frames that answers of occlusion queries are late, simulated")
        ->delimiter(',')
        ->check(CLI::Range(0u, 64u))
        ->capture_default_str();
    command->callback([arguments, command, &session] {
        arguments->plan.command = commandText(*command, {"--path"});
        bench(*arguments, session);
    });
}

}  // namespace pagoda::tools
