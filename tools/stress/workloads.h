// workloads.h: what a stress run drives through a model: camera paths that are hard on streaming,
// each in its own way. The same database, frames and seed give the same cameras.
#pragma once

#include "hlod/view/camera_path.h"
#include "ooc/base/progress.h"
#include "ooc/store/database.h"

#include <span>
#include <string_view>

namespace pagoda::tools {

struct Workload {
    std::string_view name;
    std::string_view what;
    // Of the GPU bytes that its cuts need; 0: the budget that is asked for.
    double gpuShare = 0;
};

// In the order of a report.
[[nodiscard]] std::span<const Workload> workloads();

struct WorkloadPath {
    hlod::CameraPath path;
    std::string madeOf;  // the kind of path behind it: orbit, walk, fly or teleport
};

// Paths of workloads(), made when they are first asked for: several share one way through the
// model. Throws Error where a model has no extent. One thread.
class WorkloadPaths {
public:
    // Both outlive it.
    WorkloadPaths(const ooc::Database& database, hlod::UpAxis up, size_t frames, uint64_t seed,
                  Progress& progress)
        : database_(database), up_(up), frames_(frames), seed_(seed), progress_(progress) {}

    [[nodiscard]] WorkloadPath make(std::string_view workload);

private:
    const WorkloadPath& through();
    [[nodiscard]] WorkloadPath zigzag();

    const ooc::Database& database_;
    hlod::UpAxis up_;
    size_t frames_;
    uint64_t seed_;
    Progress& progress_;
    WorkloadPath through_;
};

}  // namespace pagoda::tools
