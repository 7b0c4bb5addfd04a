// cell_runner.h: one cell of a stress run: a renderer of its own behind a simulated disk on a
// virtual clock, or with all it needs in memory, and what is counted of each of its frames. Render
// thread only, context current.
#pragma once

#include "cache/clock.h"
#include "cache/disk_loads.h"
#include "tools/bench/drawn_picture.h"
#include "tools/stress/metered_loads.h"
#include "tools/stress/stress.h"
#include "viewer/renderer.h"

#include <memory>
#include <optional>
#include <unordered_set>
#include <vector>

namespace pagoda::tools {

// All outlive the runners.
struct CellSetting {
    const StressPlan& plan;
    const std::string& workload;
    const std::string& madeOf;
    const ooc::Database& database;
    const cache::PageSource& source;
};

class CellRunner {
public:
    // Without a disk: all it needs, in memory. `gpuBytes` 0: the plan's budget.
    CellRunner(const CellSetting& setting, const std::optional<StressDisk>& disk,
               uint64_t gpuBytes);

    // Reads all down to the cut at tau, culled or not; not counted. GPU bytes that the strategy's
    // own cut needs.
    uint64_t preload(const hlod::Camera& camera);
    // The next frame of the path.
    void run(const hlod::Camera& camera);
    // Once, at the end.
    [[nodiscard]] StressCell finish();

private:
    [[nodiscard]] viewer::RendererOptions rendererOptions(uint64_t gpuBytes);
    hlod::FrameRecord draw(const hlod::Camera& camera);
    void count(const hlod::FrameRecord& record);
    void countBudgets(const hlod::FrameRecord& record, uint64_t uploadedPages);
    void countPixels(const hlod::FrameRecord& record, DrawnPicture drawn, bool isStill);
    void beginJump();
    void endJump();
    void countBytes();
    void integratePixels();

    const CellSetting& setting_;
    double frameS_;
    cache::DiskProfile profile_;
    cache::ManualClock clock_;
    MeteredLoads* meter_ = nullptr;  // behind disk_
    std::unique_ptr<cache::DiskLoads> disk_;
    viewer::RenderOptions renderOptions_;
    std::unique_ptr<viewer::Renderer> renderer_;
    std::unique_ptr<hlod::Strategy> strategy_;
    StressCell cell_;

    std::optional<hlod::Camera> lastCamera_;
    DrawnPicture last_;
    std::unordered_set<ooc::NodeId, NodeHash> drawn_;
    std::vector<double> coveredPx_, missingPx_;  // of each frame
    std::vector<bool> isEmpty_;
    size_t frame_ = 0;
    size_t sharpFrame_ = 0;     // since the last jump: from here on nothing was missing
    uint64_t bytesBefore_ = 0;  // that jump
};

}  // namespace pagoda::tools
