// runtime_options.h: the options of the run time, the same wherever a frame is drawn.
#pragma once

#include "cache/disk_loads.h"
#include "hlod/strategies/strategies.h"
#include "viewer/renderer.h"

#include <array>
#include <span>
#include <string>

namespace CLI {
class App;
}

namespace pagoda::tools {

struct RuntimeOptions {
    std::string strategy = "frustum";
    double tauPx = 1;
    std::string detail = "lod";
    std::string bias;  // "S,T" or a preset; empty: the default
    double caution = hlod::StrategyOptions{}.caution;
    uint32_t retestEvery = 1, hiddenBatch = 1;
    double hysteresis = 0;
    uint32_t queryLatencyFrames = 0;
    std::string hostBudget = "256MiB", gpuBudget = "1GiB", uploadBudget;
    std::string disk = "as-is";
    std::string prefetch = "on";
    std::string pyramid = "auto", pushOccluders = "off";
    std::string slabsGrid = "uniform";
    hlod::SlabsOptions slabs{};  // but for the grid's kind

    // All throw CLI::ValidationError or Error for what cannot be parsed.
    [[nodiscard]] hlod::StrategyOptions strategyOptions() const;
    // What --tau and --detail come to: 0 asks for the leaves.
    [[nodiscard]] double effectiveTauPx() const { return detail == "full" ? 0.0 : tauPx; }
    [[nodiscard]] viewer::RendererOptions rendererOptions() const;
    // Refuses what the options cannot do for one of these.
    void checkStrategies(std::span<const std::string> strategies) const;
};

// Names of the strategies, for --help and checks.
[[nodiscard]] std::vector<std::string> strategyNames();
// All but --strategy and --tau, which some commands take as lists.
void addRuntimeOptions(CLI::App& command, RuntimeOptions& options);
// --detail, beside the command's own --tau.
void addDetailOption(CLI::App& command, RuntimeOptions& options);

}  // namespace pagoda::tools
