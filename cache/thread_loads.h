// thread_loads.h: a small pool of threads that read (pread) and decode. Reads begin in the order
// they were sent; items arrive as they are decoded. When a joined read fails, each of its items is
// read alone, so that a fault costs only what it covers. Each thread keeps a buffer as long as the
// longest read it has done.
#pragma once

#include "cache/load_queue.h"

#include <condition_variable>
#include <deque>
#include <mutex>
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

    std::vector<const PageSource*> sources_;
    mutable std::mutex queueMutex_;  // guards the members below but the threads
    std::condition_variable hasWork_, hasArrivals_;
    std::deque<std::vector<LoadItem>> queue_;
    std::vector<LoadResult> arrived_;
    size_t reading_ = 0;
    bool isStopping_ = false;
    std::vector<std::thread> threads_;
};

// Decodes one item from the bytes of its range.
[[nodiscard]] LoadResult decodeItem(const PageSource& source, const LoadItem& item,
                                    std::span<const std::byte> bytes);

}  // namespace pagoda::cache
