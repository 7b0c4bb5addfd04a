#include "hlod/build/resources.h"

#include <algorithm>
#include <cstdio>
#include <ctime>

namespace pagoda::hlod {
namespace {

double processCpuSeconds() {
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

uint64_t privateBytes() {
    std::FILE* status = std::fopen("/proc/self/status", "re");
    if (status == nullptr) return 0;
    char line[256];
    uint64_t kilobytes = 0;
    while (std::fgets(line, sizeof line, status) != nullptr) {
        unsigned long long value = 0;
        if (std::sscanf(line, "RssAnon: %llu", &value) == 1 ||
            std::sscanf(line, "RssShmem: %llu", &value) == 1) {
            kilobytes += value;
        }
    }
    std::fclose(status);
    return kilobytes * 1024;
}

}  // namespace

StageClock::StageClock()
    : wall_(std::chrono::steady_clock::now()), cpuSeconds_(processCpuSeconds()) {
}

void StageClock::mark(const std::string& name) {
    const auto wall = std::chrono::steady_clock::now();
    const double cpu = processCpuSeconds();
    stages_.push_back({.name = name,
                       .wallSeconds = std::chrono::duration<double>(wall - wall_).count(),
                       .cpuSeconds = cpu - cpuSeconds_});
    wall_ = wall;
    cpuSeconds_ = cpu;
}

PrivatePeak::PrivatePeak() {
    sampler_ = std::thread([this] {
        while (!stop_) {
            peak_ = std::max(peak_.load(), privateBytes());
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    });
}

PrivatePeak::~PrivatePeak() {
    stop_ = true;
    sampler_.join();
}

}  // namespace pagoda::hlod
