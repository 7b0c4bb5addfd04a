// page_history.h: when a page was read and uploaded, and what it last went for: for who asks why a
// page is there or not. Keeps the last kMaxPages pages that anything was noted of; notes cost a
// look-up each. Frames count from 1; 0 means never. One thread (the render thread).
#pragma once

#include "cache/page_id.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>

namespace pagoda::cache {

struct PageStory {
    uint32_t reads = 0;
    uint64_t readFrame = 0;      // the last frame that had begun when it last arrived,
    double readS = 0;            // and the clock of the run time then
    uint64_t uploadedFrame = 0;  // to GPU memory
    uint64_t evictedFrame = 0;   // from there, to make room for `evictedFor`
    PageId evictedFor{};
};

class PageHistory {
public:
    static constexpr size_t kMaxPages = 8192;

    void noteRead(PageId page, uint64_t frameIndex, double nowS);
    void noteUploaded(PageId page, uint64_t frameIndex);
    void noteEvicted(PageId page, PageId evictedFor, uint64_t frameIndex);
    // Null when nothing was noted of it, or too long ago.
    [[nodiscard]] const PageStory* find(PageId page) const;

private:
    PageStory& storyOf(PageId page);

    std::unordered_map<PageId, PageStory, PageIdHash> stories_;
    std::deque<PageId> byAge_;  // by their first note, oldest first
};

}  // namespace pagoda::cache
