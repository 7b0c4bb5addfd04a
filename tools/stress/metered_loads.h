// metered_loads.h: notes what a simulated disk in front of it really reads, and waits, between
// frames, until all of it is decoded: so that no frame on a clock that stands still pays for
// decoding, which real time would have done meanwhile. Render thread only.
#pragma once

#include "cache/load_queue.h"

#include <memory>
#include <unordered_map>

namespace pagoda::tools {

struct NodeHash {
    size_t operator()(ooc::NodeId node) const {
        return static_cast<size_t>(node.value * 0x9E3779B97F4A7C15ull);
    }
};

class MeteredLoads final : public cache::LoadQueue {
public:
    struct Page {
        uint64_t bytes = 0;  // encoded
        uint32_t times = 0;  // read
    };
    struct Totals {
        uint64_t bytes = 0;  // pages, index blocks and gaps of joined reads
        uint64_t pageBytes = 0, blockBytes = 0;
        [[nodiscard]] uint64_t gapBytes() const { return bytes - pageBytes - blockBytes; }
    };

    explicit MeteredLoads(std::unique_ptr<cache::LoadQueue> inner) : inner_(std::move(inner)) {}

    void send(std::vector<cache::LoadItem> items) override;
    void collect(std::vector<cache::LoadResult>& arrived) override;
    [[nodiscard]] bool waitForArrival() override;
    [[nodiscard]] size_t readsInFlight() const override { return inner_->readsInFlight(); }

    // Returns when all that was sent is decoded.
    void finishDecoding();

    [[nodiscard]] const Totals& totals() const noexcept { return totals_; }
    [[nodiscard]] const std::unordered_map<ooc::NodeId, Page, NodeHash>& pages() const noexcept {
        return pages_;
    }
    // Levels of the tree that pages were read of since forgetLevels(); 0: none was read.
    [[nodiscard]] int levelsRead() const noexcept { return greatestDepth_ - leastDepth_ + 1; }
    void forgetLevels() {
        leastDepth_ = 1;
        greatestDepth_ = 0;
    }

private:
    std::unique_ptr<cache::LoadQueue> inner_;
    std::vector<cache::LoadResult> ready_;
    size_t decoding_ = 0;  // items sent and not in ready_ yet
    Totals totals_;
    std::unordered_map<ooc::NodeId, Page, NodeHash> pages_;
    int leastDepth_ = 1, greatestDepth_ = 0;
};

}  // namespace pagoda::tools
