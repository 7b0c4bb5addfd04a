// resources.h: what a run uses: stage times and peaks, for reports.
#pragma once

#include "hlod/build/build.h"

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace pagoda::hlod {

// Wall and CPU seconds (all threads) between marks.
class StageClock {
public:
    StageClock();
    // The stage since the last mark is over.
    void mark(const std::string& name);
    [[nodiscard]] const std::vector<StageReport>& stages() const noexcept { return stages_; }

private:
    std::chrono::steady_clock::time_point wall_;
    double cpuSeconds_ = 0;
    std::vector<StageReport> stages_;
};

// Samples the process's private memory (RssAnon + RssShmem) every 20 ms until destroyed.
class PrivatePeak {
public:
    PrivatePeak();
    ~PrivatePeak();
    PrivatePeak(const PrivatePeak&) = delete;
    PrivatePeak& operator=(const PrivatePeak&) = delete;
    [[nodiscard]] uint64_t bytes() const { return peak_.load(); }

private:
    std::atomic<uint64_t> peak_{0};
    std::atomic<bool> stop_{false};
    std::thread sampler_;
};

}  // namespace pagoda::hlod
