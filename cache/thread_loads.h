// thread_loads.h: a small pool of threads that read (pread) and decode. Reads begin in the order
// they were sent; items arrive as they are decoded, but who sleeps in waitForArrival() while reads
// are queued is woken for several at once: waking for each page was three quarters of the CPU time
// that this costs above plain preads (docs/decisions.md). When a joined read fails, each of its
// items is read alone, so that a fault costs only what it covers. Each thread keeps a buffer as
// long as the longest read it has done.
#pragma once

#include "cache/load_queue.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace pagoda::cache {

class ThreadLoads final : public LoadQueue {
public:
    // Sources (one a database of the scene) outlive it. `threadCount` >= 1.
    ThreadLoads(std::vector<const PageSource*> sources, size_t threadCount);
    ~ThreadLoads() override;  // drops what has not begun
    ThreadLoads(const ThreadLoads&) = delete;
    ThreadLoads& operator=(const ThreadLoads&) = delete;

    void send(std::vector<LoadItem> items) override;
    void collect(std::vector<LoadResult>& arrived) override;
    [[nodiscard]] bool waitForArrival() override;
    [[nodiscard]] size_t readsInFlight() const override;

private:
    void work();
    void load(const std::vector<LoadItem>& items, std::vector<std::byte>& buffer);
    [[nodiscard]] bool isWorthWaking() const;

    using Time = std::chrono::steady_clock;
    std::vector<const PageSource*> sources_;
    size_t threadCount_;
    mutable std::mutex queueMutex_;  // guards the members below but the threads
    std::condition_variable hasWork_, hasArrivals_;
    std::deque<std::vector<LoadItem>> queue_;
    std::vector<LoadResult> arrived_;
    std::optional<Time::time_point> waitingSince_;  // of who sleeps in waitForArrival()
    size_t reading_ = 0;
    bool isStopping_ = false;
    std::vector<std::thread> threads_;
};

// Decodes one item from the bytes of its range.
[[nodiscard]] LoadResult decodeItem(const PageSource& source, const LoadItem& item,
                                    std::span<const std::byte> bytes);

}  // namespace pagoda::cache
