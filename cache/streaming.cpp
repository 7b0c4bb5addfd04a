#include "cache/streaming.h"

#include <algorithm>

namespace pagoda::cache {
namespace {

constexpr uint64_t kIndexShare = 8;  // of the host budget, for index blocks: one part in ...

uint64_t indexBudget(const Streaming::Options& options) {
    return options.hostBytes / kIndexShare;
}

}  // namespace

Streaming::Streaming(std::span<const SceneDatabase> databases, LoadQueue& loads, GpuPages& gpu,
                     Clock& clock, const Options& options)
    : clock_(clock),
      requests_(loads, clock, options.limits),
      residency_(
          {options.hostBytes - indexBudget(options), options.gpuBytes, options.uploadBytesPerFrame},
          requests_, gpu) {
    for (const SceneDatabase& database : databases) {
        const auto number = static_cast<uint32_t>(indexes_.size());
        indexes_.push_back(
            std::make_unique<IndexCache>(database.lattice, *database.source, requests_,
                                         indexBudget(options) / databases.size(), number));
    }
}

void Streaming::take() {
    arrivals_.clear();
    requests_.collect(arrivals_);
    for (RequestQueue::Arrival& arrival : arrivals_) {
        const RequestKey key = arrival.request.key;
        if (key.isBlock) {
            indexes_[key.database]->arrive(arrival);
        } else {
            residency_.arrive(arrival);
        }
    }
}

void Streaming::beginFrame() {
    ++frameIndex_;
    take();
    requests_.beginFrame();
    residency_.beginFrame(frameIndex_, clock_.nowS());
    for (const auto& index : indexes_) index->beginFrame(frameIndex_);
}

void Streaming::endFrame(bool isHeld) {
    requests_.send([&](const Request& request) {
        if (request.key.isBlock) return indexes_[request.key.database]->admit(request);
        const bool isRoot = request.key.id == ooc::NodeId::root().value;
        return (isRoot || !isHeld) && residency_.admit(request);
    });
}

bool Streaming::waitForArrival() {
    if (!requests_.waitForArrival()) return false;
    take();
    residency_.uploadArrived();
    return true;
}

uint64_t Streaming::missing() const {
    uint64_t count = residency_.missingPages();
    for (const auto& index : indexes_) count += index->missingBlocks();
    return count;
}

PrefetchCount Streaming::prefetchedBlocks() const {
    PrefetchCount count;
    for (const auto& index : indexes_) count += index->prefetched();
    return count;
}

uint64_t Streaming::indexBytes() const {
    uint64_t bytes = 0;
    for (const auto& index : indexes_) bytes += index->usedBytes();
    return bytes;
}

}  // namespace pagoda::cache
