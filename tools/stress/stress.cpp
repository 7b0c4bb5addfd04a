#include "tools/stress/stress.h"

#include "cache/thread_loads.h"
#include "hlod/view/camera_path.h"
#include "ooc/base/progress.h"
#include "tools/stress/cell_runner.h"
#include "tools/stress/workloads.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace pagoda::tools {
namespace {

const Workload& workloadOf(const std::string& name) {
    return *std::find_if(workloads().begin(), workloads().end(),
                         [&](const Workload& workload) { return workload.name == name; });
}

}  // namespace

const std::vector<StressDisk>& stressDisks() {
    static const std::vector<StressDisk> kDisks{
        {"as is", "as-is"},
        {"500 MB/s", "500MB/s"},
        {"100 MB/s, 10 ms", "100MB/s,10ms"},
        {"50 Mbit/s, 40 ms", "50Mbit/s,40ms"},
        {"1% of reads fail", "500MB/s,5ms,fail=1%"},
        {"short reads", "500MB/s,5ms,short=20%"},
    };
    return kDisks;
}

uint64_t hitchesOf(const std::vector<double>& framesMs) {
    const double bound = std::max(kHitchMs, kHitchOverMedian * spreadOf(framesMs).median);
    return static_cast<uint64_t>(std::count_if(framesMs.begin(), framesMs.end(),
                                               [&](double frameMs) { return frameMs > bound; }));
}

SharpTimes sharpTimesOf(const StressCell& cell) {
    SharpTimes times;
    std::vector<double> sharpS;
    for (const StressJump& jump : cell.jumps) {
        if (!jump.isSharp) continue;
        sharpS.push_back(jump.sharpS);
        if (jump.boundS > 0) {
            times.worstOverBound = std::max(times.worstOverBound, jump.sharpS / jump.boundS);
        }
    }
    const Spread spread = spreadOf(sharpS);
    times.count = sharpS.size();
    times.medianS = spread.median;
    times.maxS = spread.max;
    return times;
}

std::vector<StressCell> runStress(const StressPlan& plan, const std::string& workload,
                                  WorkloadPaths& paths, Progress& progress) {
    const Workload& row = workloadOf(workload);
    const WorkloadPath way = paths.make(workload);
    const ooc::Database database = ooc::Database::open(plan.database);
    const cache::DatabaseSource source(database);
    const CellSetting setting{plan, workload, way.madeOf, database, source};
    const bool needsResident = plan.hasResident || row.gpuShare > 0;

    const size_t frames = way.path.frames.size();
    const size_t cellCount = plan.disks.size() + (plan.hasResident ? 1 : 0);
    progress.beginStage(workload, frames * (cellCount + (needsResident ? 1 : 0)), "frames");
    const auto camera = [&](size_t frame) {
        hlod::Camera at = way.path.frames[frame];
        at.widthPx = plan.widthPx;
        at.heightPx = plan.heightPx;
        return at;
    };

    std::vector<std::unique_ptr<CellRunner>> runners;
    uint64_t neededGpuBytes = 0;
    if (needsResident) {
        auto resident = std::make_unique<CellRunner>(setting, std::nullopt, 0);
        for (size_t i = 0; i < frames; ++i) {
            progress.check();
            neededGpuBytes = std::max(neededGpuBytes, resident->preload(camera(i)));
            progress.advance(1);
        }
        if (plan.hasResident) runners.push_back(std::move(resident));
    }
    const auto gpuBytes = static_cast<uint64_t>(row.gpuShare * static_cast<double>(neededGpuBytes));
    for (const StressDisk& disk : plan.disks) {
        runners.push_back(std::make_unique<CellRunner>(setting, disk, gpuBytes));
    }
    for (size_t i = 0; i < frames; ++i) {
        // Who begins changes from frame to frame: what the one before left in caches is not always
        // the same one's.
        for (size_t k = 0; k < runners.size(); ++k) {
            progress.check();
            runners[(k + i) % runners.size()]->run(camera(i));
            progress.advance(1);
        }
    }
    std::vector<StressCell> cells;
    for (auto& runner : runners) {
        cells.push_back(runner->finish());
        StressCell& cell = cells.back();
        cell.neededGpuBytes = neededGpuBytes;
        if (!plan.hasResident) continue;
        cell.frameP99OverResident = cell.frameMs.p99 / std::max(cells[0].frameMs.p99, 1e-9);
        cell.cpuP99OverResident = cell.cpuMs.p99 / std::max(cells[0].cpuMs.p99, 1e-9);
    }
    return cells;
}

}  // namespace pagoda::tools
