#include "viewer/exact_pick.h"

#include <exception>
#include <utility>

namespace pagoda::viewer {

ExactPick::ExactPick(const cache::PageSource& source, const ooc::Lattice& lattice,
                     std::function<void()> wake)
    : source_(source), lattice_(lattice), wake_(std::move(wake)), thread_([this] { work(); }) {
}

ExactPick::~ExactPick() {
    {
        const std::lock_guard lock(rayMutex_);
        isStopping_ = true;
        ++number_;
    }
    hasRay_.notify_all();
    thread_.join();
}

void ExactPick::ask(const hlod::LeafRay& ray) {
    {
        const std::lock_guard lock(rayMutex_);
        ++number_;
        ray_ = ray;
        answer_.reset();
    }
    hasRay_.notify_one();
}

void ExactPick::cancel() {
    const std::lock_guard lock(rayMutex_);
    ++number_;
    ray_.reset();
    answer_.reset();
}

std::optional<hlod::LeafRayResult> ExactPick::take() {
    const std::lock_guard lock(rayMutex_);
    return std::exchange(answer_, std::nullopt);
}

// Nothing may be thrown out of the thread: memory may be short.
hlod::LeafRayResult ExactPick::castSafely(const hlod::LeafRay& ray,
                                          const std::function<bool()>& isCancelled) const {
    try {
        return hlod::castLeafRay(source_, lattice_, ray, isCancelled);
    } catch (const std::exception& error) {
        hlod::LeafRayResult result;
        result.faults.emplace_back(error.what());
        return result;
    }
}

void ExactPick::work() {
    std::unique_lock lock(rayMutex_);
    while (true) {
        hasRay_.wait(lock, [this] { return isStopping_ || ray_; });
        if (isStopping_) return;
        const hlod::LeafRay ray = *std::exchange(ray_, std::nullopt);
        const uint64_t number = number_;
        lock.unlock();
        hlod::LeafRayResult result = castSafely(ray, [&] {
            const std::lock_guard asking(rayMutex_);
            return number != number_;
        });
        lock.lock();
        if (result.isCancelled || number != number_) continue;
        answer_ = std::move(result);
        lock.unlock();
        wake_();
        lock.lock();
    }
}

}  // namespace pagoda::viewer
