// residency.h: which pages are decoded in host memory and which are in GPU memory. Two byte
// budgets, never exceeded: host memory holds what is being read (reserved before it is sent) and
// decoded pages, GPU memory uploaded ones; both go least recently used first. What a frame wants is
// pinned until the next one begins; what was used in the last two frames is not evicted for
// something else, so that nothing on the screen gets coarser because something else loads. What was
// prefetched gives way to all that: it takes only room that nobody used or kept lately.
// Render thread only. Its place in a frame: docs/frame.md.
#pragma once

#include "cache/codec_statistics.h"
#include "cache/gpu_pages.h"
#include "cache/lru_pages.h"
#include "cache/page_history.h"
#include "cache/prefetch_counts.h"
#include "cache/request_queue.h"

#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace pagoda::cache {

enum class PageState {
    Resident,  // uploaded, and kept for this frame
    Absent,    // asked for; an ancestor stands in
    Failed,    // cannot be had, or is larger than a whole budget: listed in faults(); an ancestor
               // stands in
};

struct PageRequest {
    PageId id;
    const ooc::NodeRecord& node;
    double priority = 0;                // greater is sooner
    uint32_t slot = LruPages::kNoSlot;  // of its node (IndexCache): finds the page faster
};

struct PageFault {
    PageId id;
    std::string what;
};

class Residency {
public:
    struct Budgets {
        uint64_t hostBytes = 0;
        uint64_t gpuBytes = 0;
        uint64_t uploadBytesPerFrame = 0;  // 0: no bound; the first page of a frame always goes
    };
    struct Counters {
        uint64_t loadedPages = 0;
        uint64_t bytesRead = 0;  // encoded, of what arrived, without gaps of joined reads
        uint64_t uploadedPages = 0, bytesUploaded = 0;
        uint64_t evictedPages = 0;                      // from GPU memory, to make room
        uint64_t reloadedPages = 0, bytesReloaded = 0;  // read although read before
        uint64_t failedPages = 0;
        PrefetchCounts prefetch{};
    };

    // `requests` and `gpu` outlive it.
    Residency(Budgets budgets, RequestQueue& requests, GpuPages& gpu);
    ~Residency();  // drops what is uploaded
    Residency(const Residency&) = delete;
    Residency& operator=(const Residency&) = delete;

    // Unpins, then uploads what has arrived and was wanted lately, best first, within the budget.
    // `nowS` is for the history alone.
    void beginFrame(uint64_t frameIndex, double nowS = 0.0);
    // Uploads go on within this frame, without the frame's bound: for who waits anyway.
    void uploadArrived();
    // Resident: pins it. Absent: asks for it. A stand-in is drawn while something finer is on its
    // way: it does not count as demanded.
    [[nodiscard]] PageState want(const PageRequest& request, bool isStandIn = false);
    // A page that would stand in for what is drawn: goes after all that is older, but is neither
    // pinned nor demanded, so that it never keeps the cut itself out.
    void keep(PageId page, uint32_t slot = LruPages::kNoSlot);
    // Asks for what nothing on the screen needs yet: after everything that is wanted. `reason` (<
    // kPrefetchReasons, asserted) is what it is counted by.
    void prefetch(const PageRequest& request, uint8_t reason);
    [[nodiscard]] bool isResident(PageId page) const { return gpuLru_.contains(page); }
    [[nodiscard]] PageState state(PageId page, uint32_t slot = LruPages::kNoSlot) const {
        if (gpuLru_.contains(page, slot)) return PageState::Resident;
        return failed_.contains(page) ? PageState::Failed : PageState::Absent;
    }
    void unpinAll() { gpuLru_.unpinAll(); }

    void dropAll();  // from GPU memory

    // For RequestQueue::send() and collect(): is there room, and here it is. Between frames.
    [[nodiscard]] bool admit(const Request& request);
    void arrive(RequestQueue::Arrival& arrival);

    // GPU bytes of all that this frame wanted but stand-ins, present or not. Above gpuBudgetBytes()
    // the cut does not fit.
    [[nodiscard]] uint64_t demandBytes() const noexcept { return demandBytes_; }
    // Pages that this frame wanted and that are absent.
    [[nodiscard]] uint64_t missingPages() const noexcept { return missingPages_; }
    [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
    [[nodiscard]] const CodecStatistics& codecs() const noexcept { return codecs_; }
    [[nodiscard]] const PageHistory& history() const noexcept { return history_; }
    [[nodiscard]] const std::vector<PageFault>& faults() const noexcept { return faults_; }
    [[nodiscard]] uint64_t gpuUsedBytes() const noexcept { return gpuLru_.usedBytes(); }
    [[nodiscard]] uint64_t gpuBudgetBytes() const noexcept { return gpuLru_.budgetBytes(); }
    [[nodiscard]] uint64_t hostUsedBytes() const noexcept { return hostLru_.usedBytes(); }
    [[nodiscard]] uint64_t hostBudgetBytes() const noexcept { return hostLru_.budgetBytes(); }

private:
    struct Wanted {
        uint64_t frame = 0;
        double priority = 0;
    };
    struct Reservation {
        uint64_t hostBytes = 0, gpuBytes = 0;
        bool isPrefetch = false;
    };
    // GPU bytes of what is not there yet.
    struct Coming {
        uint64_t wantedBytes = 0, prefetchedBytes = 0;
        [[nodiscard]] uint64_t& of(bool isPrefetch) {
            return isPrefetch ? prefetchedBytes : wantedBytes;
        }
    };
    [[nodiscard]] bool couldFit(const PageRequest& request);
    void upload(uint64_t boundBytes);
    [[nodiscard]] bool uploadOne(PageId id, const ooc::Page& page);
    void demand(PageId id, uint64_t sizeBytes, bool isStandIn);
    void fail(PageId id, std::string what);
    void count(const Request& request, const LoadResult& result);
    void dropFromGpu(std::vector<PageId>& evicted);
    void dropFromHost(std::vector<PageId>& evicted);
    [[nodiscard]] uint64_t evictBeforeFrame(bool isPrefetch) const;

    RequestQueue& requests_;
    GpuPages& gpu_;
    uint64_t uploadBytesPerFrame_;
    LruPages hostLru_, gpuLru_;
    std::unordered_map<PageId, ooc::Page, PageIdHash> decoded_;
    std::unordered_map<PageId, Wanted, PageIdHash> waiting_;  // decoded, to be uploaded
    std::unordered_map<RequestKey, Reservation, RequestKeyHash> reserved_;  // sent for
    std::unordered_set<PageId, PageIdHash> failed_;
    std::unordered_set<PageId, PageIdHash> everLoaded_;
    struct Prefetched {
        uint64_t bytes = 0;  // encoded
        uint8_t reason = 0;
    };
    std::unordered_map<PageId, Prefetched, PageIdHash> prefetched_;  // in memory, not yet wanted
    std::vector<PageFault> faults_;
    Coming sent_;                                      // sent for
    Coming toUpload_;                                  // waiting to be uploaded
    std::unordered_set<PageId, PageIdHash> demanded_;  // in this frame, and absent
    uint64_t demandBytes_ = 0, missingPages_ = 0;
    Counters counters_;
    CodecStatistics codecs_{};
    PageHistory history_;
    uint64_t frameIndex_ = 0;
    double nowS_ = 0.0;
};

// Bytes of a decoded page in host memory, and their bound as far as the record tells.
[[nodiscard]] uint64_t decodedBytes(const ooc::Page& page);
[[nodiscard]] uint64_t decodedBytes(const ooc::NodeRecord& node);

}  // namespace pagoda::cache
