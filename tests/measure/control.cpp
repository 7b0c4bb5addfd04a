// The loops that hold streaming steady, against steps: tau against GPU memory, tau against a frame
// time, uploads against bytes a frame. On plants whose answers are known, and on a database drawn
// by the software device on a clock that only the program moves: the same numbers on every run.
//
//   pagoda_control [DB.pagoda PATH.json [FOLDER]]
//
// Prints a table in Markdown; with a folder, writes control-*.svg there (by gnuplot).
#include "cache/clock.h"
#include "cache/disk_loads.h"
#include "cache/thread_loads.h"
#include "hlod/raster/software_device.h"
#include "hlod/strategies/strategies.h"
#include "hlod/view/camera_path.h"
#include "hlod/view/frame_rate_control.h"
#include "hlod/view/frame_runner.h"
#include "hlod/view/tau_control.h"
#include "ooc/base/error.h"
#include "ooc/base/file.h"
#include "tools/bench/gnuplot.h"
#include "tools/bench/plot_legend.h"
#include "tools/bench/report_file.h"
#include "tools/stress/metered_loads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace pagoda::tools {
namespace {

constexpr int kPhaseFrames = 120;  // between steps
constexpr uint64_t kBudget = 1'000'000;
constexpr double kTargetMs = 16.0, kFrameS = 1.0 / 60.0;

struct Trace {
    std::string name;
    std::vector<double> taus;
    std::vector<double> loads;  // bytes over budget, or ms over target
    bool hasSteps = true;
};

// ---- What came of a step

struct Answer {
    double overshoot = 0;    // of tau, past where it came to rest, as a share
    int settlingFrames = 0;  // until the load stays within 10% of where it came to rest
    double oscillation = 0;  // of tau at rest: (most - least) / mean over the last 30 frames
    double restLoad = 0;
};

Answer answerOf(const Trace& trace, size_t begin) {
    const size_t end = begin + kPhaseFrames;
    const auto taus = std::span(trace.taus).subspan(begin, kPhaseFrames);
    const auto rest = taus.last(30);
    const auto [least, most] = std::minmax_element(rest.begin(), rest.end());
    double mean = 0;
    for (const double tau : rest) mean += tau / 30;
    Answer answer;
    answer.oscillation = (*most - *least) / mean;
    answer.restLoad = trace.loads[end - 1];
    const bool isUp = mean > taus.front();
    const double far = isUp ? *std::max_element(taus.begin(), taus.end())
                            : *std::min_element(taus.begin(), taus.end());
    answer.overshoot = std::max(0.0, isUp ? far / *most - 1 : *least / far - 1);
    size_t settled = end;
    while (settled > begin && std::abs(trace.loads[settled - 1] / answer.restLoad - 1) <= 0.1) {
        --settled;
    }
    answer.settlingFrames = static_cast<int>(settled - begin);
    return answer;
}

void printRow(const std::string& loop, const Trace& trace) {
    if (!trace.hasSteps) {
        const auto over = std::count_if(trace.loads.begin(), trace.loads.end(),
                                        [](double load) { return load > 1.0; });
        const auto [least, most] = std::minmax_element(trace.taus.begin(), trace.taus.end());
        fmt::print(
            "| {} | {} | | tau {:.3g} to {:.3g} px; above its bound in {:.0f}% of frames | | |\n",
            loop, trace.name, *least, *most,
            100.0 * static_cast<double>(over) / static_cast<double>(trace.loads.size()));
        return;
    }
    for (size_t begin = kPhaseFrames; begin < trace.taus.size(); begin += kPhaseFrames) {
        const Answer answer = answerOf(trace, begin);
        fmt::print("| {} | {} | {} | {:.0f}% | {} | {:.1f}% | {:.2f} |\n", loop, trace.name,
                   begin == kPhaseFrames ? "x4" : "/4", 100 * answer.overshoot,
                   answer.settlingFrames, 100 * answer.oscillation, answer.restLoad);
    }
}

// ---- Plants

struct Plant {
    std::string name;
    double steepness = 2.0;
    size_t latencyFrames = 0;
    bool hasLevels = false;
    double noise = 0;  // standard deviation
    bool isTeleporting = false;
    double least = 0;  // load of the coarsest cut: one node
};

constexpr int kPhases = 3;  // at rest, x4, /4

// Load at tau 1 in each frame.
double costAt(const Plant& plant, int frame, std::mt19937_64& random) {
    constexpr double kCost = 3.0;
    if (plant.isTeleporting) {
        return kCost * std::exp2(std::uniform_real_distribution<double>(-2.0, 2.0)(random));
    }
    return kCost * (frame / kPhaseFrames == 1 ? 4.0 : 1.0);
}

double loadOf(const Plant& plant, double cost, double tauPx, std::mt19937_64& random) {
    // Levels an eighth of a power of two apart: a cut of many nodes does not jump further.
    const double tau = plant.hasLevels ? std::exp2(std::floor(8 * std::log2(tauPx)) / 8) : tauPx;
    const double noise =
        plant.noise > 0 ? std::normal_distribution<double>(1.0, plant.noise)(random) : 1.0;
    return std::max(plant.least, cost / std::pow(tau, plant.steepness)) * std::max(0.3, noise);
}

// `next(load that is known, tau)` gives the tau of the next frame.
Trace play(const Plant& plant, const std::function<double(double, double)>& next) {
    std::mt19937_64 random(1);
    Trace trace{plant.name, {}, {}, !plant.isTeleporting && plant.least <= 0};
    double tau = 1.0;
    for (int frame = 0; frame < kPhases * kPhaseFrames; ++frame) {
        const double cost = costAt(plant, frame, random);
        trace.taus.push_back(tau);
        trace.loads.push_back(loadOf(plant, cost, tau, random));
        const size_t known = trace.loads.size() - 1;
        tau = next(trace.loads[known - std::min(known, plant.latencyFrames)], tau);
    }
    return trace;
}

Trace playMemory(const Plant& plant) {
    hlod::TauControl control;
    return play(plant, [&](double load, double) {
        control.update({.tauPx = 1.0,
                        .demandBytes = static_cast<uint64_t>(load * kBudget),
                        .budgetBytes = kBudget,
                        .isSameView = !plant.isTeleporting});
        return control.effectiveTauPx(1.0);
    });
}

Trace playFrameRate(const Plant& plant) {
    hlod::FrameRateControl control(
        {.targetMs = kTargetMs, .latencyFrames = static_cast<uint32_t>(plant.latencyFrames)});
    return play(plant, [&](double load, double tau) {
        control.update({.tauPx = 1.0,
                        .effectiveTauPx = tau,
                        .measuredMs = load * kTargetMs,
                        .isSameView = !plant.isTeleporting});
        return control.tauPx(1.0);
    });
}

const std::vector<Plant>& plants() {
    static const std::vector<Plant> kPlants{
        {.name = "falls with tau squared"},
        {.name = "falls with tau^0.7", .steepness = 0.7},
        {.name = "8 frames late", .latencyFrames = 8},
        {.name = "8 frames late, falls with tau", .steepness = 1.0, .latencyFrames = 8},
        {.name = "in levels", .hasLevels = true},
        {.name = "noise of 5%", .noise = 0.05},
        {.name = "a teleport every frame", .isTeleporting = true},
        {.name = "one node: nothing gets smaller", .least = 0.9},
    };
    return kPlants;
}

// ---- A database

struct Scene {
    ooc::Database database;
    cache::DatabaseSource source;
    hlod::CameraPath path;

    Scene(const std::string& file, const std::string& pathFile)
        : database(ooc::Database::open(file)), source(database) {
        const std::vector<std::byte> bytes = readWholeFile(pathFile, hlod::kMaxPathBytes);
        path = hlod::parseCameraPath({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                     {}, pathFile);
    }
};

struct Setting {
    uint64_t gpuBytes = uint64_t{1} << 30;
    uint64_t uploadBytesPerFrame = 0;
    uint32_t queryLatencyFrames = 0;
};

class World {
public:
    World(const Scene& scene, const Setting& setting)
        : setting_(setting),
          device_(scene.database.header().lattice, setting.gpuBytes),
          meter_(new MeteredLoads(std::make_unique<cache::ThreadLoads>(
              std::vector<const cache::PageSource*>{&scene.source}, 2))),
          disk_(std::unique_ptr<cache::LoadQueue>(meter_), cache::parseDiskProfile("100MB/s,10ms"),
                clock_),
          scene_{scene.database.header().lattice, &scene.source},
          streaming_(std::span(&scene_, 1), disk_, device_.pages(), clock_,
                     {.hostBytes = uint64_t{256} << 20,
                      .gpuBytes = setting.gpuBytes,
                      .uploadBytesPerFrame = setting.uploadBytesPerFrame}),
          tree_(scene_.lattice, streaming_.index()),
          runner_(streaming_, tree_, device_, setting.queryLatencyFrames),
          strategy_(hlod::makeStrategy("coh")) {}

    hlod::FrameRecord run(const hlod::Camera& camera, double tauPx) {
        hlod::FrameRecord record = runner_.run(camera, *strategy_, {tauPx});
        meter_->finishDecoding();
        clock_.advance(kFrameS);
        return record;
    }
    uint64_t rootBytes() { return device_.pages().sizeBytes(*runner_.root().record); }

private:
    Setting setting_;
    cache::ManualClock clock_;
    hlod::SoftwareDevice device_;
    MeteredLoads* meter_;  // behind disk_
    cache::DiskLoads disk_;
    cache::SceneDatabase scene_;
    cache::Streaming streaming_;
    hlod::NodeTree tree_;
    hlod::FrameRunner runner_;
    std::unique_ptr<hlod::Strategy> strategy_;
};

// Twice as wide and high: four times the cost, from one frame to the next.
hlod::Camera steppedCamera(const Scene& scene, int frame) {
    hlod::Camera camera = scene.path.frames.front();
    const bool isLarge = frame / kPhaseFrames == 1;
    camera.widthPx = isLarge ? 160 : 80;
    camera.heightPx = isLarge ? 120 : 60;
    return camera;
}

hlod::Camera jumpingCamera(const Scene& scene, int frame) {
    hlod::Camera camera =
        scene.path.frames[static_cast<size_t>(frame) * 37 % scene.path.frames.size()];
    camera.widthPx = 80;
    camera.heightPx = 60;
    return camera;
}

Trace playMemory(const Scene& scene, const std::string& name, Setting setting,
                 const std::function<hlod::Camera(int)>& cameraAt, bool hasSteps) {
    World world(scene, setting);
    Trace trace{name, {}, {}, hasSteps};
    for (int frame = 0; frame < kPhases * kPhaseFrames; ++frame) {
        const hlod::FrameRecord record = world.run(cameraAt(frame), 1.0);
        trace.taus.push_back(record.effectiveTauPx);
        trace.loads.push_back(static_cast<double>(record.demandBytes) /
                              static_cast<double>(setting.gpuBytes));
    }
    return trace;
}

// What a frame costs is reckoned from what it draws, so that the run can be repeated.
double reckonedMs(const hlod::FrameRecord& record) {
    return 1.0 + 0.02 * static_cast<double>(record.drawnNodes) +
           0.1 * static_cast<double>(record.drawnTriangles) * 1e-3;
}

Trace playFrameRate(const Scene& scene, const std::string& name, double targetMs,
                    uint32_t latencyFrames, const std::function<hlod::Camera(int)>& cameraAt,
                    bool hasSteps) {
    World world(scene, {});
    hlod::FrameRateControl control({.targetMs = targetMs, .latencyFrames = latencyFrames});
    Trace trace{name, {}, {}, hasSteps};
    hlod::Camera last;
    for (int frame = 0; frame < kPhases * kPhaseFrames; ++frame) {
        const hlod::Camera camera = cameraAt(frame);
        const hlod::FrameRecord record = world.run(camera, control.tauPx(1.0));
        trace.taus.push_back(record.effectiveTauPx);
        trace.loads.push_back(reckonedMs(record) / targetMs);
        const size_t known = trace.loads.size() - 1;
        control.update(
            {.tauPx = 1.0,
             .effectiveTauPx = record.effectiveTauPx,
             .measuredMs = targetMs * trace.loads[known - std::min<size_t>(known, latencyFrames)],
             .isSameView = camera == last});
        last = camera;
    }
    return trace;
}

// What the view at a size needs and costs once it is all there.
hlod::FrameRecord restOf(const Scene& scene) {
    World world(scene, {});
    hlod::FrameRecord record;
    for (int frame = 0; frame < 60; ++frame) record = world.run(steppedCamera(scene, 0), 1.0);
    return record;
}

// Bytes uploaded in each frame from a cold start, and until when something is missing.
void printUploads(const Scene& scene) {
    fmt::print(
        "\n| upload budget, kB a frame | uploaded, kB | most in a frame, kB | frames until "
        "sharp | bytes / budget, frames |\n|---|---|---|---|---|\n");
    for (const uint64_t budget :
         {uint64_t{0}, uint64_t{1} << 20, uint64_t{1} << 18, uint64_t{1} << 16}) {
        World world(scene, {.uploadBytesPerFrame = budget});
        uint64_t uploaded = 0, most = 0;
        int sharp = 0;
        for (int frame = 0; frame < 150; ++frame) {
            const hlod::FrameRecord record = world.run(steppedCamera(scene, kPhaseFrames), 1.0);
            uploaded += record.bytesUploaded;
            most = std::max(most, record.bytesUploaded);
            if (record.missingPages > 0 || record.standIns > 0 || record.drawnNodes == 0) {
                sharp = frame + 1;
            }
        }
        fmt::print(
            "| {} | {:.0f} | {:.0f} | {} | {} |\n",
            budget == 0 ? "no bound" : fmt::format("{:.0f}", static_cast<double>(budget) * 1e-3),
            static_cast<double>(uploaded) * 1e-3, static_cast<double>(most) * 1e-3, sharp,
            budget == 0 ? ""
                        : fmt::format("{:.1f}",
                                      static_cast<double>(uploaded) / static_cast<double>(budget)));
    }
}

// ---- Pictures

constexpr const char* kColours[] = {"#000000", "#e69f00", "#56b4e9", "#009e73",
                                    "#d55e00", "#cc79a7", "#0072b2", "#888888"};
constexpr int kWidthPx = 720, kHeightPx = 460;

void draw(Gnuplot& gnuplot, const std::string& file, const std::vector<Trace>& traces,
          const char* loadName) {
    std::string data, upper, lower;
    std::vector<LegendEntry> entries;
    double most = 1;
    for (size_t i = 0; i < traces.size(); ++i) {
        data += fmt::format("$t{} << EOD\n", i);
        for (size_t frame = 0; frame < traces[i].taus.size(); ++frame) {
            data += fmt::format("{} {:.5g} {:.5g}\n", frame, traces[i].taus[frame],
                                traces[i].loads[frame]);
            most = std::max(most, traces[i].loads[frame]);
        }
        data += "EOD\n";
        for (const int column : {2, 3}) {
            (column == 2 ? upper : lower) +=
                fmt::format("{}$t{} using 1:{} with lines lw 1.4 lc rgb '{}'",
                            i == 0 ? "plot " : ", ", i, column, kColours[i % 8]);
        }
        entries.push_back({traces[i].name, kColours[i % 8], LegendEntry::Mark::Line, 1});
    }
    const std::string svg = gnuplot.svg(
        fmt::format(
            "{}set border 3 lc rgb '#333333'\nset tics nomirror out scale 0.6\n"
            "set grid ytics lc rgb '#dddddd' lt 1 lw 0.6\nset lmargin at screen 0.12\n"
            "set rmargin at screen 0.98\n{}set multiplot\nset xrange [0:{}]\nset logscale y\n"
            "set tmargin at screen 0.93\nset bmargin at screen 0.53\nset format x ''\n"
            "set ylabel 'effective tau, px'\n{}\n{}set tmargin at screen 0.48\n"
            "set bmargin at screen 0.14\nset format x '%g'\nset xlabel 'frame'\nset ylabel '{}'\n"
            "set arrow from graph 0, first 1 to graph 1, first 1 nohead dt 2 lc rgb '#333333'\n"
            "{}\nunset multiplot\n",
            data, legendCommands(entries, kWidthPx - 90), traces.front().taus.size(), upper,
            kUnsetLegend, loadName, lower),
        {kWidthPx, kHeightPx}, "c");
    if (!gnuplot.problem().empty()) throw Error(file, "", gnuplot.problem(), "");
    writeReportFile(file, svg + "\n");
}

// ---- All of it

struct Loops {
    std::vector<Trace> memory, frameRate;
};

Loops playDatabase(const Scene& scene) {
    const hlod::FrameRecord rest = restOf(scene);
    const auto stepped = [&](int frame) { return steppedCamera(scene, frame); };
    const auto jumping = [&](int frame) { return jumpingCamera(scene, frame); };
    const uint64_t tight = rest.demandBytes + rest.demandBytes / 3;
    const uint64_t oneNode = World(scene, {}).rootBytes() * 11 / 10;
    Loops loops;
    loops.memory.push_back(playMemory(scene, "budget 4/3 of what the smaller needs",
                                      {.gpuBytes = tight}, stepped, true));
    loops.memory.push_back(playMemory(scene, "8 frames late",
                                      {.gpuBytes = tight, .queryLatencyFrames = 8}, stepped, true));
    loops.memory.push_back(playMemory(scene, "one node", {.gpuBytes = oneNode}, stepped, false));
    loops.memory.push_back(
        playMemory(scene, "a teleport every frame", {.gpuBytes = tight}, jumping, false));
    const double targetMs = 1.2 * reckonedMs(rest);
    loops.frameRate.push_back(playFrameRate(scene, "at once", targetMs, 0, stepped, true));
    loops.frameRate.push_back(playFrameRate(scene, "8 frames late", targetMs, 8, stepped, true));
    loops.frameRate.push_back(
        playFrameRate(scene, "a teleport every frame", targetMs, 8, jumping, false));
    return loops;
}

int run(int count, char** arguments) {
    Loops planted;
    for (const Plant& plant : plants()) {
        planted.memory.push_back(playMemory(plant));
        planted.frameRate.push_back(playFrameRate(plant));
    }
    Loops real;
    std::unique_ptr<Scene> scene;
    if (count > 2) {
        scene = std::make_unique<Scene>(arguments[1], arguments[2]);
        real = playDatabase(*scene);
    }
    constexpr const char* kHead =
        "| loop | plant | step | overshoot of tau | settling, frames | oscillation at rest | load "
        "at "
        "rest |\n|---|---|---|---|---|---|---|\n";
    fmt::print(kHead);
    for (const Trace& trace : planted.memory) printRow("memory", trace);
    for (const Trace& trace : planted.frameRate) printRow("frame time", trace);
    for (const Trace& trace : real.memory) printRow("memory, database", trace);
    for (const Trace& trace : real.frameRate) printRow("frame time, database", trace);
    if (scene) printUploads(*scene);
    if (count > 3) {
        Gnuplot gnuplot;
        const std::string folder = std::string(arguments[3]) + "/control-";
        const std::vector<Trace> memory(planted.memory.begin(), planted.memory.begin() + 5);
        const std::vector<Trace> frameRate(planted.frameRate.begin(),
                                           planted.frameRate.begin() + 6);
        draw(gnuplot, folder + "memory.svg", {memory[0], memory[1], memory[2], memory[4]},
             "bytes / budget");
        draw(gnuplot, folder + "frame-time.svg",
             {frameRate[0], frameRate[2], frameRate[3], frameRate[5]}, "time / target");
        draw(gnuplot, folder + "database-memory.svg", real.memory, "bytes / budget");
        draw(gnuplot, folder + "database-frame-time.svg", real.frameRate, "time / target");
    }
    return 0;
}

}  // namespace
}  // namespace pagoda::tools

int main(int count, char** arguments) {
    try {
        return pagoda::tools::run(count, arguments);
    } catch (const std::exception& error) {
        fmt::print(stderr, "pagoda_control: {}\n", error.what());
        return 1;
    }
}
