// thread_pool.h: a fixed number of workers and one queue. Tasks may add tasks. What a task throws
// is kept (the first one) and thrown again by wait() on the waiting thread; later tasks are
// dropped.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace pagoda {

class ThreadPool {
public:
    explicit ThreadPool(size_t threadCount);  // >= 1
    ~ThreadPool();                            // drops what has not begun, waits for what has
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    void add(std::function<void()> task);
    // Until the queue is empty and every worker idle. Rethrows the first failure.
    void wait();
    [[nodiscard]] size_t threadCount() const noexcept { return workers_.size(); }

private:
    void work();

    std::mutex queueMutex_;  // guards all below but workers_
    std::condition_variable changed_;
    std::deque<std::function<void()>> queue_;
    std::exception_ptr failure_;
    size_t running_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> workers_;
};

}  // namespace pagoda
