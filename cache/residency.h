// residency.h: which pages are decoded, which are in GPU memory, and what happens when one is
// wanted. want() loads at once for now: the streaming run time replaces its inside (requests ranked
// by priority, workers, retries) and then answers Absent where this one blocks. Callers treat
// Absent and Failed alike: an ancestor stands in. Two budgets, never exceeded: decoded pages in
// host memory, uploaded ones in GPU memory, both LRU. Pages that a frame wanted are pinned until
// the next beginFrame() or unpinAll(). One thread (the render thread). Its place in a frame:
// docs/frame.md, step 3.
#pragma once

#include "cache/gpu_pages.h"
#include "cache/lru_pages.h"
#include "cache/page_source.h"

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace pagoda::cache {

enum class PageState {
    Resident,  // uploaded and pinned for this frame
    Absent,    // asked for, on its way
    Failed,    // cannot be had: listed in faults()
    NoRoom,    // pinned pages fill the GPU budget: draw a coarser cut, or what is pinned first
};

struct PageRequest {
    PageId id;
    const ooc::NodeRecord& node;
    double priority = 0;  // greater is sooner; unused while loading is synchronous
};

struct PageFault {
    PageId id;
    std::string what;
};

class Residency {
public:
    struct Budgets {
        uint64_t hostBytes = 0;  // decoded pages kept for a second upload; 0 keeps none
        uint64_t gpuBytes = 0;
    };
    struct Counters {
        uint64_t loadedPages = 0, bytesRead = 0;
        uint64_t uploadedPages = 0, bytesUploaded = 0;
        uint64_t evictedPages = 0;  // from GPU memory
        uint64_t failedPages = 0;
    };

    // `source` and `gpu` outlive it.
    Residency(Budgets budgets, PageSource& source, GpuPages& gpu);
    ~Residency();  // drops what is uploaded
    Residency(const Residency&) = delete;
    Residency& operator=(const Residency&) = delete;

    void beginFrame(uint64_t frameIndex);
    // Loads and uploads the page if need be, and pins it. A page that failed once is not tried
    // again.
    [[nodiscard]] PageState want(const PageRequest& request);
    [[nodiscard]] bool isResident(PageId page) const { return gpuLru_.contains(page); }
    void unpinAll() { gpuLru_.unpinAll(); }

    [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
    [[nodiscard]] const std::vector<PageFault>& faults() const noexcept { return faults_; }
    [[nodiscard]] uint64_t gpuUsedBytes() const noexcept { return gpuLru_.usedBytes(); }
    [[nodiscard]] uint64_t hostUsedBytes() const noexcept { return hostLru_.usedBytes(); }

private:
    [[nodiscard]] const ooc::Page* decoded(const PageRequest& request, ooc::Page& loaded);
    [[nodiscard]] bool load(const PageRequest& request, ooc::Page& loaded);
    [[nodiscard]] PageState upload(PageId id, const ooc::Page& page);
    PageState fail(PageId id, std::string what);
    void dropEvicted(std::vector<PageId>& evicted);

    PageSource& source_;
    GpuPages& gpu_;
    LruPages hostLru_, gpuLru_;
    std::unordered_map<PageId, ooc::Page, PageIdHash> decoded_;
    // A page that found no room while hostLru_ is too small for it: read once, not at each try.
    std::optional<std::pair<PageId, ooc::Page>> turnedAway_;
    std::unordered_set<PageId, PageIdHash> failed_;
    std::vector<PageFault> faults_;
    Counters counters_;
    uint64_t frameIndex_ = 0;
};

// Bytes of a decoded page in host memory.
[[nodiscard]] uint64_t decodedBytes(const ooc::Page& page);

}  // namespace pagoda::cache
