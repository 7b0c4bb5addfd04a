// bench.h: strategies side by side on one database: what each draws, reads and costs along a path,
// and how far its pictures are from the truth. Strategies take turns at every frame, so that what
// else the machine does weighs on all alike.
//
// Each strategy has a renderer of its own and passes the path three times over:
//   settled  from cold: every frame waits until nothing is missing. Gives bytes_read, and
//            bytes_exact from the nodes whose pixels are seen.
//   truth    live, all resident: pictures against the same cut without culling, and against the
//            cut at tau (what `bool` draws); on demand also against the leaves.
//   timed    live, all resident, `repeats` times: counters and times. No picture is read.
// Two more are on demand, each on a renderer of its own:
//   still    live, all resident: at every so many frames the camera stops, and pixels whose node
//            gets coarser are counted.
//   live     with a simulated disk, from cold caches, on a virtual clock, so that what is not there
//            in time shows (fallback pixels; on demand also holes, against the leaves).
#pragma once

#include "hlod/view/camera_path.h"
#include "tools/bench/statistics.h"
#include "tools/bench/truth.h"
#include "tools/runtime_options.h"

#include <functional>
#include <string>
#include <vector>

namespace pagoda {
class Progress;
}

namespace pagoda::tools {

struct BenchConfiguration {
    std::string pathName;
    hlod::CameraPath path;
    double tauPx = 1;
    int widthPx = 640, heightPx = 480;
    uint32_t queryLatencyFrames = 0;

    [[nodiscard]] hlod::Camera camera(size_t frame) const;
};

struct BenchPlan {
    std::string database;
    std::vector<std::string> strategies;
    std::vector<BenchConfiguration> configurations;
    RuntimeOptions runtime;
    int repeats = 3;
    int truthEvery = 1;  // frames between those whose pixels are compared; 0: none
    // Of these, and of the live pass's, frames between those held against the leaves; 0: none.
    int referenceEvery = 0;
    int stillEvery = 0;  // frames between those at which the camera stops; 0: no still pass
    bool doesSettle = true;
    Vec3f worldUp{0, 0, 1};
    // For reports only.
    uint64_t modelTriangles = 0, modelNodes = 0, modelBytes = 0;
    double speed = 1;     // that the paths were taken at
    std::string command;  // that asked for all this, without folders
};

// A path seen live, from a simulated disk (live.h). Sums over its frames.
struct LivePass {
    size_t frames = 0;
    uint64_t coveredPixels = 0, fallbackPixels = 0;
    uint64_t fallbackFrames = 0;    // with any fallback pixel
    double worstFallbackShare = 0;  // of a frame's covered pixels
    uint64_t missingPages = 0;
    uint64_t pageBytesRead = 0;
    cache::PrefetchCounts prefetch{};       // pages, by hlod::PrefetchReason
    cache::PrefetchCount prefetchedBlocks;  // index blocks
    std::vector<double> fallbackShareSeries;
    size_t referenceFrames = 0;  // held against the leaves
    uint64_t holes = 0, holeFrames = 0;
    std::vector<std::string> referenceFaults;  // leaves that could not be read
};

// Frames of a camera that stands still (still.h). Sums over them.
struct StillPass {
    size_t frames = 0;  // each held against the one before
    uint64_t coveredPixels = 0;
    CoarserPixels coarser;
    uint64_t coarserFrames = 0;       // with any without an allowed cause
    std::vector<std::string> faults;  // what could not be read
};

// Means over the frames that were looked at.
struct BenchRun {
    std::string strategy, pathName;
    double tauPx = 1;
    int widthPx = 0, heightPx = 0;
    uint32_t queryLatencyFrames = 0;
    size_t frames = 0;
    int repeats = 0;
    // From the timed pass, a frame.
    double drawnNodes = 0, drawnTriangles = 0, queries = 0, rarn = 0, delayed = 0, waits = 0;
    double risen = 0;
    double visitedNodes = 0, hiddenNodes = 0, missingPages = 0, effectiveTauPx = 0;
    double stopHidden = 0, delayHidden = 0, stallMs = 0;
    Spread frameMs, cpuMs, traverseMs, queryMs, drawMs, streamMs;
    std::vector<double> frameMsSeries, cpuMsSeries;  // of all repeats, in order
    std::vector<double> drawnNodesSeries;            // of the last repeat
    // From the truth pass: totals a frame.
    size_t truthFrames = 0;
    double wrongPixels = 0, tiedPixels = 0, overdrawnPixels = 0, coveredPixels = 0;
    double truthMissingPages = 0;  // wanted and not there: should be 0
    std::vector<double> psnrLumaSeries;
    double psnrLuma = 0, psnrCb = 0, psnrCr = 0, worstPsnrLuma = 0;
    // Against the leaves, where asked for.
    size_t referenceFrames = 0;
    double referenceIdDifferences = 0, psnrLumaReference = 0;
    uint64_t holes = 0, holeFrames = 0;  // totals; frames with any
    // From the settled pass.
    uint64_t bytesRead = 0;      // with what joined reads bring along
    uint64_t pageBytesRead = 0;  // without
    uint64_t bytesExact = 0;     // pages with a pixel, and their ancestors
    uint64_t bytesDrawn = 0;     // pages drawn in a settled frame, and their ancestors
    uint64_t unsettledFrames = 0;
    uint64_t gpuBytesPeak = 0, hostBytesPeak = 0;
    LivePass live;    // without frames when the disk is as it is
    StillPass still;  // without frames where not asked for
    std::vector<std::string> faults;
};

// Runs of one configuration, in the order of plan.strategies.
[[nodiscard]] std::vector<BenchRun> runBench(const BenchPlan& plan,
                                             const BenchConfiguration& configuration,
                                             Progress& progress);

// {"database":, "command":, "machine":, "settings":, "runs": [...], "ratios": [...]}; keys are a
// contract (docs/bench.md).
[[nodiscard]] std::string benchToJson(const BenchPlan& plan, const std::vector<BenchRun>& runs,
                                      const std::string& device);
// One line a run.
[[nodiscard]] std::string benchToCsv(const std::vector<BenchRun>& runs);

}  // namespace pagoda::tools
