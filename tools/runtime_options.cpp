#include "tools/runtime_options.h"

#include "tools/session.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>

namespace pagoda::tools {

hlod::StrategyOptions RuntimeOptions::strategyOptions() const {
    hlod::StrategyOptions options = bias == "paper" ? hlod::kPaperOptions : hlod::StrategyOptions{};
    options.slabs = slabs;
    options.slabs.isNested = slabsGrid == "nested";
    if (bias != "paper") options.caution = caution;
    options.retestEvery = retestEvery;
    options.hiddenBatch = hiddenBatch;
    options.hysteresis = hysteresis;
    if (bias.empty() || bias == "paper") return options;
    const auto isShare = [](double value) { return value >= 0.0 && value <= 1.0; };
    int read = 0;
    bool isWhole =
        std::sscanf(bias.c_str(), "%lf,%lf%n", &options.biasS, &options.biasT, &read) == 2;
    if (isWhole && bias[static_cast<size_t>(read)] != '\0') {
        char rest = 0;
        isWhole = std::sscanf(bias.c_str() + read, ",%lf%c", &options.biasFloor, &rest) == 1;
    }
    if (!isWhole || !isShare(options.biasS) || !isShare(options.biasT) ||
        !isShare(options.biasFloor)) {
        throw CLI::ValidationError(
            "--bias",
            "'" + bias + "' is no bias; write paper, or S,T[,FLOOR] in [0, 1] such as 0.5,0.5");
    }
    return options;
}

viewer::RendererOptions RuntimeOptions::rendererOptions() const {
    viewer::RendererOptions options;
    options.hostBytes = parseBytes(hostBudget);
    options.gpuBytes = parseBytes(gpuBudget);
    options.uploadBytesPerFrame = uploadBudget.empty() ? 0 : parseBytes(uploadBudget);
    options.queryLatencyFrames = queryLatencyFrames;
    options.prefetchReasons = *hlod::parsePrefetchReasons(prefetch);
    options.doesPrefetch = options.prefetchReasons.any();
    options.disk = cache::parseDiskProfile(disk);
    if (pyramid == "cpu") options.pyramid.place = viewer::PyramidPlace::Cpu;
    if (pyramid == "gpu") options.pyramid.place = viewer::PyramidPlace::Gpu;
    options.pyramid.pushesOccluders = pushOccluders == "on";
    return options;
}

void RuntimeOptions::checkStrategies(std::span<const std::string> strategies) const {
    if (pushOccluders != "on") return;
    std::string able;
    for (const hlod::StrategyRow& row : hlod::strategies()) {
        if (row.hidesByPyramid) able += (able.empty() ? "" : " or ") + std::string(row.name);
    }
    for (const std::string& name : strategies) {
        const auto rows = hlod::strategies();
        const auto row = std::find_if(rows.begin(), rows.end(),
                                      [&](const auto& each) { return each.name == name; });
        if (row == rows.end() || row->hidesByPyramid) continue;
        throw CLI::ValidationError("--push-occluders", "strategy " + name +
                                                           " has no depth pyramid whose depths "
                                                           "could be pushed; use --strategy " +
                                                           able);
    }
}

std::vector<std::string> strategyNames() {
    std::vector<std::string> names;
    for (const hlod::StrategyRow& row : hlod::strategies()) names.emplace_back(row.name);
    return names;
}

void addDetailOption(CLI::App& command, RuntimeOptions& options) {
    command
        .add_option("--detail", options.detail,
                    "lod: what --tau allows; full: the leaves, as --tau 0")
        ->check(CLI::IsMember({"lod", "full"}))
        ->capture_default_str();
}

namespace {

void addSlabsOptions(CLI::App& command, RuntimeOptions& options) {
    command.add_option("--slabs-grid", options.slabsGrid, "slabs: uniform or nested grid")
        ->check(CLI::IsMember({"uniform", "nested"}))
        ->capture_default_str();
    command
        .add_option("--slabs-resolution", options.slabs.resolution,
                    "slabs, uniform: cells along the scene's longest side")
        ->check(CLI::Range(1, 512))
        ->capture_default_str();
    command
        .add_option("--slabs-branching", options.slabs.branching,
                    "slabs, nested: cells of each grid along an axis")
        ->check(CLI::Range(2, 16))
        ->capture_default_str();
    command
        .add_option("--slabs-split", options.slabs.splitTriangles,
                    "slabs, nested: triangles above which a visible cell is cut")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command
        .add_option("--slabs-batch", options.slabs.batch,
                    "slabs: queries that go out before an answer is waited for")
        ->check(CLI::Range(size_t{1}, size_t{1'000'000}))
        ->capture_default_str();
    command
        .add_option("--slabs-threshold", options.slabs.queryTriangles,
                    "slabs: a cell that would draw fewer triangles is drawn unasked")
        ->capture_default_str();
}

}  // namespace

void addRuntimeOptions(CLI::App& command, RuntimeOptions& options) {
    const auto isPrefetch = [](const std::string& text) -> std::string {
        if (hlod::parsePrefetchReasons(text)) return {};
        return "'" + text +
               "' is no reason to read ahead; write on, off, or reasons such as near,refine";
    };
    command.add_option("--bias", options.bias,
                       "How much hidden parts lower the error of a node: S,T[,FLOOR] in [0, 1], or "
                       "paper (1,0.5,0 and nothing beyond the paper) (default: 1,1,0.015625)");
    command
        .add_option("--caution", options.caution,
                    "Wait for the answer where an error is foretold within this share of tau")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    command
        .add_option("--retest", options.retestEvery,
                    "Ask about what was seen in every N-th frame only while the camera moves")
        ->type_name("N")
        ->check(CLI::Range(1u, 1000u))
        ->capture_default_str();
    command
        .add_option("--batch-hidden", options.hiddenBatch,
                    "Ask about N boxes together that were hidden for some frames")
        ->type_name("N")
        ->check(CLI::Range(1u, 1000u))
        ->capture_default_str();
    command
        .add_option("--hysteresis", options.hysteresis,
                    "Draw a node in place of its children only when its error is less than tau by "
                    "this share")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    command
        .add_option("--query-latency", options.queryLatencyFrames,
                    "Frames that answers of occlusion queries are late, simulated")
        ->check(CLI::Range(0u, 64u))
        ->capture_default_str();
    command
        .add_option("--host-budget", options.hostBudget,
                    "Bytes for the index and pages in host memory (4MiB or more)")
        ->capture_default_str();
    command
        .add_option("--gpu-budget", options.gpuBudget, "Bytes for uploaded pages (1MiB or more)")
        ->capture_default_str();
    command.add_option("--upload-budget", options.uploadBudget,
                       "Bytes uploaded a frame at most (default: no bound)");
    command
        .add_option("--prefetch", options.prefetch,
                    "Read ahead what the camera's motion foretells, as far as that pays: on, off, "
                    "or some of near,refine,enter,uncover")
        ->check(isPrefetch)
        ->capture_default_str();
    command
        .add_option("--pyramid", options.pyramid,
                    "Where hzb and late test boxes against depths: cpu (which reads them back), "
                    "gpu, or auto (cpu on a software renderer)")
        ->check(CLI::IsMember({"cpu", "gpu", "auto"}))
        ->capture_default_str();
    command
        .add_option(
            "--push-occluders", options.pushOccluders,
            "Push what hides back by its node's error, so that the full model hides it too: "
            "on or off (hzb and late only)")
        ->check(CLI::IsMember({"on", "off"}))
        ->capture_default_str();
    command
        .add_option("--disk", options.disk,
                    "Simulated disk: as-is, or parts such as 100MB/s,10ms,fail=1%,short=5%")
        ->capture_default_str();
    addSlabsOptions(command, options);
}

}  // namespace pagoda::tools
