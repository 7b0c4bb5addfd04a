// plot_scripts.h: gnuplot commands of the figures, for drawings Gnuplot::svg() makes. Pure
// functions of the runs: nothing is drawn here.
#pragma once

#include "tools/bench/bench.h"

#include <functional>
#include <string>
#include <vector>

namespace pagoda::tools {

// 19 cm at 96 pixels an inch: a page between its margins.
inline constexpr int kFigureWidthPx = 720;

using RunGroup = std::vector<const BenchRun*>;
// Runs of which `isSame` holds with the first of their group; groups and runs stay in order.
[[nodiscard]] std::vector<RunGroup> grouped(
    const RunGroup& runs, const std::function<bool(const BenchRun&, const BenchRun&)>& isSame);
// Each once, least first.
[[nodiscard]] std::vector<double> tausOf(const RunGroup& runs);

// Two panels: PSNR of luma, and wrong pixels, against CPU time; one mark a run, larger ones for a
// larger tau.
[[nodiscard]] std::string errorScript(const RunGroup& runs);

struct PathLine {
    std::string strategy;
    std::vector<double> values;  // one a frame
};
// Lines over the frames of a path, each point the mean of `stride` > 0 frames.
[[nodiscard]] std::string linesScript(const std::vector<PathLine>& lines, size_t stride,
                                      const char* unit);

// One stack a run: medians of the parts of a frame, wall ms.
[[nodiscard]] std::string partsScript(const RunGroup& runs);
// Three bars a run: bytes needed, of pages read, and read.
[[nodiscard]] std::string bytesScript(const RunGroup& runs);

}  // namespace pagoda::tools
