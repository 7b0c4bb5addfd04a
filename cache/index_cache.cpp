#include "cache/index_cache.h"

#include "cache/kept_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace pagoda::cache {
namespace {

constexpr uint32_t kRootBlock = 0;
constexpr uint64_t kNodeBytes = sizeof(ooc::NodeRecord) + sizeof(Box3d);
// A record on disk is never longer than in memory, so that a block's bytes on disk tell a bound.
constexpr uint64_t kMinRecordBytes = 96;

uint64_t boundBytes(const ByteRange& range) {
    return range.bytes + (range.bytes / kMinRecordBytes + 1) * kNodeBytes;
}

}  // namespace

IndexCache::IndexCache(const ooc::Lattice& lattice, const PageSource& source,
                       RequestQueue& requests, uint64_t budgetBytes, uint32_t database)
    : lattice_(lattice),
      source_(source),
      requests_(requests),
      budgetBytes_(budgetBytes),
      database_(database) {
}

void IndexCache::beginFrame(uint64_t frameIndex) {
    frameIndex_ = frameIndex;
    missingBlocks_ = 0;
}

const IndexCache::Block* IndexCache::block(uint32_t block, double priority) {
    if (const auto found = blocks_.find(block); found != blocks_.end()) {
        Entry& entry = *found->second;
        entry.lastFrame = frameIndex_;
        prefetched_.usedBytes += std::exchange(entry.prefetchedBytes, 0);
        return &entry.block;
    }
    if (!couldFit(block)) return nullptr;
    const Request request{{database_, true, block}, source_.blockRange(block), priority, false, {}};
    if (requests_.ask(request)) ++missingBlocks_;
    return nullptr;
}

const IndexCache::Block* IndexCache::peek(uint32_t block) {
    const auto found = blocks_.find(block);
    if (found == blocks_.end()) return nullptr;
    Entry& entry = *found->second;
    entry.lastFrame = std::max(entry.lastFrame, spareFrame(frameIndex_));
    return &entry.block;
}

void IndexCache::prefetch(uint32_t block, double priority) {
    if (blocks_.contains(block) || !couldFit(block)) return;
    requests_.ask({{database_, true, block}, source_.blockRange(block), priority, true, {}});
}

// Lists it as a fault when it never can.
bool IndexCache::couldFit(uint32_t block) {
    if (broken_.contains(block)) return false;
    if (block >= source_.blockCount()) {
        reportFault(block, "no such block");
        return false;
    }
    const uint64_t bytes = boundBytes(source_.blockRange(block));
    if (bytes <= budgetBytes_ || block == kRootBlock) return true;
    reportFault(block, fmt::format("takes {} bytes, more than the whole budget of {}", bytes,
                                   budgetBytes_));
    return false;
}

IndexCache::BlockState IndexCache::state(uint32_t block) const {
    if (blocks_.contains(block)) return BlockState::Resident;
    return broken_.contains(block) ? BlockState::Broken : BlockState::Absent;
}

void IndexCache::reportFault(uint32_t block, std::string what) {
    if (!broken_.emplace(block, what).second) return;
    faults_.push_back({block, std::move(what)});
}

// Blocks last used before that frame go, oldest first. False, and nothing changes, if they are not
// enough.
bool IndexCache::makeRoom(uint64_t neededBytes, uint64_t beforeFrame) {
    if (usedBytes() + neededBytes <= budgetBytes_) return true;
    struct Candidate {
        uint64_t lastFrame;
        uint32_t block;
    };
    std::vector<Candidate> candidates;
    uint64_t freeBytes = 0;
    for (const auto& [number, entry] : blocks_) {
        if (entry->lastFrame >= beforeFrame) continue;
        candidates.push_back({entry->lastFrame, number});
        freeBytes += entry->bytes;
    }
    if (usedBytes() + neededBytes - freeBytes > budgetBytes_) return false;
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return a.lastFrame != b.lastFrame ? a.lastFrame < b.lastFrame : a.block > b.block;
    });
    for (const Candidate& candidate : candidates) {
        if (usedBytes() + neededBytes <= budgetBytes_) break;
        const auto found = blocks_.find(candidate.block);
        usedBytes_ -= found->second->bytes;
        freeSlots_.push_back(found->second->block.firstSlot);
        blocks_.erase(found);
    }
    return true;
}

// Ranges of one unit are used again; longer ones (no database has them) are not.
uint32_t IndexCache::takeSlots(uint32_t count) {
    if (count <= kSlotsPerBlock && !freeSlots_.empty()) {
        const uint32_t first = freeSlots_.back();
        freeSlots_.pop_back();
        return first;
    }
    const uint32_t first = slotCount_;
    slotCount_ += (count + kSlotsPerBlock - 1) / kSlotsPerBlock * kSlotsPerBlock;
    return first;
}

bool IndexCache::admit(const Request& request) {
    const uint64_t bytes = boundBytes(request.range);
    const uint64_t before =
        request.isPrefetch ? spareFrame(frameIndex_) : keepSinceFrame(frameIndex_);
    // The root's block is needed for anything to be drawn at all.
    if (!makeRoom(bytes, before) && request.key.id != kRootBlock) return false;
    reservedBytes_ += bytes;
    return true;
}

void IndexCache::arrive(RequestQueue::Arrival& arrival) {
    const auto number = static_cast<uint32_t>(arrival.request.key.id);
    reservedBytes_ -= boundBytes(arrival.request.range);
    if (!arrival.result.block) {
        if (!arrival.result.fault.empty()) reportFault(number, std::move(arrival.result.fault));
        return;
    }
    auto entry = std::make_unique<Entry>();
    entry->block.index = std::move(*arrival.result.block);
    const std::vector<ooc::NodeRecord>& nodes = entry->block.index.nodes;
    entry->block.boxesModel.reserve(nodes.size());
    for (const ooc::NodeRecord& node : nodes) {
        entry->block.boxesModel.push_back(lattice_.toModel(node.box));
    }
    entry->bytes = nodes.size() * kNodeBytes;
    entry->lastFrame = frameIndex_;
    if (arrival.request.isPrefetch) {
        entry->lastFrame = spareFrame(frameIndex_);
        entry->prefetchedBytes = arrival.request.range.bytes;
        prefetched_.bytes += entry->prefetchedBytes;
    }
    entry->block.firstSlot = takeSlots(static_cast<uint32_t>(nodes.size()));
    usedBytes_ += entry->bytes;
    ++loadedBlocks_;
    blocks_.emplace(number, std::move(entry));
}

}  // namespace pagoda::cache
