// stress.h: streaming under load: workloads (camera paths that are hard on it) x simulated disks.
// Each pair is a cell; the cells of a workload take turns at every frame, together with one that
// has all it needs in memory, so that what else the machine does weighs on all alike. Disks run on
// a virtual clock that a frame moves by a fixed time: what is read, drawn and missing is the same
// on every run and machine; how long frames take is measured beside it. What the numbers mean:
// docs/stress.md.
#pragma once

#include "hlod/view/camera.h"
#include "tools/bench/statistics.h"
#include "tools/runtime_options.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pagoda {
class Progress;
}

namespace pagoda::tools {

struct StressDisk {
    std::string name;     // for reports
    std::string profile;  // cache::parseDiskProfile()
};
// What `--disk` takes without a list of its own.
[[nodiscard]] const std::vector<StressDisk>& stressDisks();

struct StressPlan {
    std::string database;
    std::vector<std::string> workloads;
    std::vector<StressDisk> disks;
    RuntimeOptions runtime;  // its disk is not used
    size_t frames = 300;     // of each cell
    double framesPerSecond = 60;
    int widthPx = 640, heightPx = 480;
    uint64_t seed = 1;
    bool hasResident = true;  // beside the disks, a cell that has all it needs
    hlod::UpAxis up = hlod::UpAxis::Z;
    // For reports only.
    uint64_t modelTriangles = 0, modelNodes = 0, modelBytes = 0;
    std::string command;
};

// A place that the camera jumped to, and when its picture was as it should be.
struct StressJump {
    size_t frame = 0;
    bool isSharp = false;    // before the next jump
    double sharpS = 0;       // virtual time until then
    double boundS = 0;       // bytes / bandwidth + levels x (latency + 2 frames)
    uint64_t bytesRead = 0;  // until then
    int levels = 0;          // of the tree, that pages were read of
};

struct StressBytes {
    uint64_t read = 0;    // by the disk: the sum of those below
    uint64_t drawn = 0;   // pages that some frame drew
    uint64_t wasted = 0;  // pages that none drew
    uint64_t twice = 0;   // pages again
    uint64_t index = 0;
    uint64_t gaps = 0;  // what joined reads bring along
};

struct StressPeaks {
    uint64_t gpuBytes = 0, hostBytes = 0, uploadBytes = 0;  // the last: in a frame
    uint64_t uploadBytesOfOnePage = 0;  // the greatest that went alone, which it always may
    uint64_t framesOver = 0;            // any budget
};

struct StressCell {
    std::string workload, madeOf;  // madeOf: the kind of path
    StressDisk disk;
    bool isResident = false;
    size_t frames = 0;
    uint64_t gpuBudget = 0, hostBudget = 0, uploadBudget = 0;  // bytes; upload 0: no bound
    uint64_t neededGpuBytes = 0;  // of the largest cut, had it all it needs; 0: not known
    Spread frameMs, cpuMs;
    uint64_t hitches = 0, cpuHitches = 0;                     // kHitch...
    double frameP99OverResident = 0, cpuP99OverResident = 0;  // 0: there is none to compare
    double decodeCpuMs = 0;                                   // between frames, mean a frame
    // Pixels drawn by stand-ins, and all that show the model: integrated over virtual time.
    double missingPxS = 0, coveredPxS = 0, worstMissingShare = 0;
    uint64_t framesMissing = 0;  // with any such pixel
    uint64_t framesEmpty = 0;    // nothing to draw yet
    uint64_t coarserPixels = 0;  // of a still camera, without a cause that is allowed
    std::vector<StressJump> jumps;
    StressBytes bytes;
    uint64_t reads = 0, failedReads = 0, shortReads = 0, retries = 0, cancelled = 0;
    uint64_t evictedPages = 0;
    StressPeaks peaks;
    double leastTauPx = 0, meanTauPx = 0, greatestTauPx = 0;  // effective
    uint64_t missingPages = 0;  // summed over frames; of the resident cell should be 0
    std::vector<std::string> faults;
    std::vector<double> frameMsSeries, cpuMsSeries, missingShareSeries, tauSeries;

    [[nodiscard]] double missingShare() const {
        return coveredPxS > 0 ? missingPxS / coveredPxS : 0;
    }
};

// A frame is a hitch when it takes more than twice the median of its cell and more than a frame of
// a 60 Hz screen.
inline constexpr double kHitchOverMedian = 2, kHitchMs = 16;
[[nodiscard]] uint64_t hitchesOf(const std::vector<double>& framesMs);

// Of the jumps of a cell whose picture was sharp before the next one.
struct SharpTimes {
    size_t count = 0;
    double medianS = 0, maxS = 0;
    double worstOverBound = 0;  // of those that had to read anything; 0: none had
};
[[nodiscard]] SharpTimes sharpTimesOf(const StressCell& cell);

// Of one workload: the resident cell first, if there is one, then the disks in order.
class WorkloadPaths;
[[nodiscard]] std::vector<StressCell> runStress(const StressPlan& plan, const std::string& workload,
                                                WorkloadPaths& paths, Progress& progress);

// {"database":, "command":, "machine":, "settings":, "cells": [...]}; keys are a contract
// (docs/stress.md).
[[nodiscard]] std::string stressToJson(const StressPlan& plan, const std::vector<StressCell>& cells,
                                       const std::string& device);
// One line a cell.
[[nodiscard]] std::string stressToCsv(const std::vector<StressCell>& cells);

}  // namespace pagoda::tools
