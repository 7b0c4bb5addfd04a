#include "cache/index_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace pagoda::cache {
namespace {

constexpr uint64_t kKeptFrames = 2;
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
        found->second->lastFrame = frameIndex_;
        return &found->second->block;
    }
    if (broken_.contains(block)) return nullptr;
    if (block >= source_.blockCount()) {
        reportFault(block, "no such block");
        return nullptr;
    }
    const ByteRange range = source_.blockRange(block);
    if (boundBytes(range) > budgetBytes_ && block != kRootBlock) {
        reportFault(block, fmt::format("takes {} bytes, more than the whole budget of {}",
                                       boundBytes(range), budgetBytes_));
        return nullptr;
    }
    Request request{{database_, true, block}, range, priority, false, {}};
    if (requests_.ask(request)) ++missingBlocks_;
    return nullptr;
}

IndexCache::BlockState IndexCache::state(uint32_t block) const {
    if (blocks_.contains(block)) return BlockState::Resident;
    return broken_.contains(block) ? BlockState::Broken : BlockState::Absent;
}

void IndexCache::reportFault(uint32_t block, std::string what) {
    if (!broken_.emplace(block, what).second) return;
    faults_.push_back({block, std::move(what)});
}

void IndexCache::evictUntil(uint64_t freeBytes) {
    while (usedBytes() + freeBytes > budgetBytes_) {
        auto oldest = blocks_.end();
        for (auto entry = blocks_.begin(); entry != blocks_.end(); ++entry) {
            if (entry->second->lastFrame + kKeptFrames >= frameIndex_) continue;
            const bool isOlder =
                oldest == blocks_.end() || std::pair(entry->second->lastFrame, ~entry->first) <
                                               std::pair(oldest->second->lastFrame, ~oldest->first);
            if (isOlder) oldest = entry;
        }
        if (oldest == blocks_.end()) return;
        usedBytes_ -= oldest->second->bytes;
        freeSlots_.push_back(oldest->second->block.firstSlot);
        blocks_.erase(oldest);
    }
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
    evictUntil(bytes);
    // The root's block is needed for anything to be drawn at all.
    if (usedBytes() + bytes > budgetBytes_ && request.key.id != kRootBlock) return false;
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
    entry->block.firstSlot = takeSlots(static_cast<uint32_t>(nodes.size()));
    usedBytes_ += entry->bytes;
    ++loadedBlocks_;
    blocks_.emplace(number, std::move(entry));
}

}  // namespace pagoda::cache
