// late_visibility.h: answers that come F frames late, as a GPU's do, on a device whose answers come
// at once: an answer is pending until F later frames have begun. wait() returns it, and adds F
// frame times to the simulated stall. Repeatable: what latency costs can be studied on a machine
// without a GPU.
#pragma once

#include "hlod/view/visibility.h"

#include <cstdint>
#include <unordered_map>

namespace pagoda::hlod {

class LateVisibility final : public CountingVisibility {
public:
    explicit LateVisibility(uint32_t latencyFrames) : latencyFrames_(latencyFrames) {}

    // `inner` is asked until the next call; null: there is none to ask.
    void beginFrame(CountingVisibility* inner);

    [[nodiscard]] QueryTicket query(const QueryShape& shape) override;
    [[nodiscard]] std::optional<uint64_t> poll(QueryTicket ticket) override;
    [[nodiscard]] uint64_t wait(QueryTicket ticket) override;

    void abandonAll() override;
    [[nodiscard]] bool isPollFree() const override {
        return inner_ != nullptr && inner_->isPollFree();
    }

    [[nodiscard]] uint64_t queriesThisFrame() const noexcept { return queries_; }
    // Frames that answers which were waited for in this frame had still to come: waiting for one
    // passes the time for all that were asked before it.
    [[nodiscard]] uint32_t latencyFrames() const noexcept { return latencyFrames_; }
    [[nodiscard]] uint64_t stalledFrames() const noexcept { return stalledFrames_; }

private:
    struct Asked {
        uint64_t frame;
    };
    CountingVisibility* inner_ = nullptr;
    uint32_t latencyFrames_;
    uint64_t frame_ = 0, queries_ = 0, stalledFrames_ = 0;
    std::unordered_map<uint64_t, Asked> asked_;
};

}  // namespace pagoda::hlod
