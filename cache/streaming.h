// streaming.h: the cache as a frame sees it: one request queue that the pages and the index blocks
// of every database of the scene share, and the order in which they are served. Render thread only.
// Its place in a frame: docs/frame.md.
#pragma once

#include "cache/index_cache.h"
#include "cache/residency.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace pagoda::cache {

// What is drawn from: one database of the scene.
struct SceneDatabase {
    ooc::Lattice lattice;
    const PageSource* source = nullptr;  // outlives the Streaming
};

class Streaming {
public:
    struct Options {
        uint64_t hostBytes = uint64_t{256} << 20;  // an eighth of it holds index blocks
        uint64_t gpuBytes = uint64_t{1} << 30;
        uint64_t uploadBytesPerFrame = 0;  // 0: no bound
        RequestQueue::Limits limits{};
    };

    // `loads` (of the same databases), `gpu` and `clock` outlive it.
    Streaming(std::span<const SceneDatabase> databases, LoadQueue& loads, GpuPages& gpu,
              Clock& clock, const Options& options);

    // What has arrived is taken and, within the frame's bound, uploaded.
    void beginFrame();
    // Requests of this frame are ranked and sent. With `isHeld` none but a root's page is: the
    // cut will not fit, and reading for it would be in vain.
    void endFrame(bool isHeld = false);
    // Blocks until something has arrived; takes and uploads it. False when nothing is on its way:
    // what is missing cannot come (no room, or faults).
    [[nodiscard]] bool waitForArrival();

    // Empties GPU memory; host memory keeps what it holds.
    void dropAll() { residency_.dropAll(); }

    [[nodiscard]] Residency& residency() noexcept { return residency_; }
    [[nodiscard]] const Residency& residency() const noexcept { return residency_; }
    [[nodiscard]] IndexCache& index(uint32_t database = 0) { return *indexes_[database]; }
    [[nodiscard]] const RequestQueue& requests() const noexcept { return requests_; }
    [[nodiscard]] const Clock& clock() const noexcept { return clock_; }
    [[nodiscard]] uint64_t frameIndex() const noexcept { return frameIndex_; }
    // Pages and blocks that the last frame wanted and did not have.
    [[nodiscard]] uint64_t missing() const;
    [[nodiscard]] uint64_t indexBytes() const;
    // Index blocks read ahead, of all databases.
    [[nodiscard]] PrefetchCount prefetchedBlocks() const;
    [[nodiscard]] uint64_t hostBytes() const { return residency_.hostUsedBytes() + indexBytes(); }

private:
    void take();

    Clock& clock_;
    RequestQueue requests_;
    Residency residency_;
    std::vector<std::unique_ptr<IndexCache>> indexes_;
    std::vector<RequestQueue::Arrival> arrivals_;
    uint64_t frameIndex_ = 0;
};

}  // namespace pagoda::cache
