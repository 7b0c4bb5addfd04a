#include "ooc/base/thread_pool.h"

#include <utility>

namespace pagoda {

ThreadPool::ThreadPool(size_t threadCount) {
    workers_.reserve(threadCount);
    for (size_t i = 0; i < threadCount; ++i) workers_.emplace_back([this] { work(); });
}

ThreadPool::~ThreadPool() {
    {
        const std::scoped_lock lock(queueMutex_);
        stopping_ = true;
        queue_.clear();
    }
    changed_.notify_all();
    for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::add(std::function<void()> task) {
    {
        const std::scoped_lock lock(queueMutex_);
        if (failure_) return;
        queue_.push_back(std::move(task));
    }
    changed_.notify_all();
}

void ThreadPool::wait() {
    std::unique_lock lock(queueMutex_);
    changed_.wait(lock, [this] { return queue_.empty() && running_ == 0; });
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadPool::work() {
    std::unique_lock lock(queueMutex_);
    for (;;) {
        changed_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
        if (stopping_) return;
        std::function<void()> task = std::move(queue_.front());
        queue_.pop_front();
        ++running_;
        lock.unlock();
        std::exception_ptr failure;
        try {
            task();
        } catch (...) {
            failure = std::current_exception();
        }
        task = nullptr;
        lock.lock();
        --running_;
        if (failure && !failure_) {
            failure_ = failure;
            queue_.clear();
        }
        changed_.notify_all();
    }
}

}  // namespace pagoda
