// index_cache.h: the index blocks that have been looked at, within a byte budget, least recently
// used first out. A block that is absent is asked for; refinement stops there meanwhile. Each
// resident block owns a range of kSlotsPerBlock slots: a node's slot is a small number by which
// traversals keep what they know of it (another node may own it later). One a database. Render
// thread only. Pointers stay valid until the next beginFrame().
#pragma once

#include "cache/prefetch_counts.h"
#include "cache/request_queue.h"
#include "ooc/lattice.h"

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace pagoda::cache {

struct BlockFault {
    uint32_t block = 0;
    std::string what;
};

class IndexCache {
public:
    static constexpr uint32_t kSlotsPerBlock = 512;

    struct Block {
        ooc::IndexBlock index;
        std::vector<Box3d> boxesModel;  // of its nodes
        uint32_t firstSlot = 0;
    };
    enum class BlockState { Resident, Absent, Broken };

    // `source` and `requests` outlive it. Blocks used in the last two frames stay: when they fill
    // the budget, no new ones come. The root's block (0) comes whatever the budget; another one
    // that is longer than the whole budget is a fault.
    IndexCache(const ooc::Lattice& lattice, const PageSource& source, RequestQueue& requests,
               uint64_t budgetBytes, uint32_t database = 0);

    void beginFrame(uint64_t frameIndex);
    // Null when the block is absent (asked for) or broken (listed in faults() once).
    [[nodiscard]] const Block* block(uint32_t block, double priority = 0.0);
    // Null when it is not there; neither asks for it nor uses it, but prefetches leave it in place.
    [[nodiscard]] const Block* peek(uint32_t block);
    // Asks for an absent block that nothing on the screen needs yet: after everything that is
    // wanted. It takes only room that nobody used lately, and gives its own to the first want.
    void prefetch(uint32_t block, double priority);
    [[nodiscard]] BlockState state(uint32_t block) const;
    // Lists a fault that the content of a block that was read has shown.
    void reportFault(uint32_t block, std::string what);

    // For RequestQueue::send() and collect(), as in Residency: between frames.
    [[nodiscard]] bool admit(const Request& request);
    void arrive(RequestQueue::Arrival& arrival);

    [[nodiscard]] const std::vector<BlockFault>& faults() const noexcept { return faults_; }
    [[nodiscard]] uint64_t missingBlocks() const noexcept { return missingBlocks_; }  // this frame
    [[nodiscard]] size_t blockCount() const noexcept { return blocks_.size(); }
    [[nodiscard]] uint64_t loadedBlocks() const noexcept { return loadedBlocks_; }  // ever
    [[nodiscard]] const PrefetchCount& prefetched() const noexcept { return prefetched_; }
    [[nodiscard]] uint64_t usedBytes() const noexcept { return usedBytes_ + reservedBytes_; }
    // Slots are below this.
    [[nodiscard]] uint32_t slotCount() const noexcept { return slotCount_; }

private:
    struct Entry {
        Block block;
        uint64_t lastFrame = 0;
        uint64_t bytes = 0;
        uint64_t prefetchedBytes = 0;  // encoded; 0: it was wanted
    };
    [[nodiscard]] bool couldFit(uint32_t block);
    [[nodiscard]] bool makeRoom(uint64_t neededBytes, uint64_t beforeFrame);
    [[nodiscard]] uint32_t takeSlots(uint32_t count);

    ooc::Lattice lattice_;
    const PageSource& source_;
    RequestQueue& requests_;
    uint64_t budgetBytes_;
    uint32_t database_;
    std::unordered_map<uint32_t, std::unique_ptr<Entry>> blocks_;
    std::map<uint32_t, std::string> broken_;
    std::vector<uint32_t> freeSlots_;  // first slots of ranges, to be used again
    std::vector<BlockFault> faults_;
    PrefetchCount prefetched_;
    uint64_t usedBytes_ = 0, reservedBytes_ = 0;
    uint64_t missingBlocks_ = 0, loadedBlocks_ = 0;
    uint32_t slotCount_ = 0;
    uint64_t frameIndex_ = 0;
};

}  // namespace pagoda::cache
