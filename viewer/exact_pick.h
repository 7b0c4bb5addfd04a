// exact_pick.h: rays over the leaves on a thread of its own: a click is answered at full resolution
// without the window waiting for a disk. The last ray asked for is the one that is answered. All
// calls come from one thread.
#pragma once

#include "hlod/view/leaf_ray.h"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace pagoda::viewer {

class ExactPick {
public:
    // `source` outlives it; `wake` is called from its thread when there is an answer.
    ExactPick(const cache::PageSource& source, const ooc::Lattice& lattice,
              std::function<void()> wake);
    ~ExactPick();
    ExactPick(const ExactPick&) = delete;
    ExactPick& operator=(const ExactPick&) = delete;

    // Drops the ray before.
    void ask(const hlod::LeafRay& ray);
    void cancel();
    // The answer, once.
    [[nodiscard]] std::optional<hlod::LeafRayResult> take();

private:
    void work();
    [[nodiscard]] hlod::LeafRayResult castSafely(const hlod::LeafRay& ray,
                                                 const std::function<bool()>& isCancelled) const;

    const cache::PageSource& source_;
    ooc::Lattice lattice_;
    std::function<void()> wake_;

    std::mutex rayMutex_;  // guards the members below but the thread
    std::condition_variable hasRay_;
    std::optional<hlod::LeafRay> ray_;
    std::optional<hlod::LeafRayResult> answer_;
    uint64_t number_ = 0;  // of the last ray, or cancellation
    bool isStopping_ = false;
    std::thread thread_;
};

}  // namespace pagoda::viewer
