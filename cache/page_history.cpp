#include "cache/page_history.h"

namespace pagoda::cache {

PageStory& PageHistory::storyOf(PageId page) {
    const auto [found, isNew] = stories_.try_emplace(page);
    if (!isNew) return found->second;
    byAge_.push_back(page);
    if (byAge_.size() > kMaxPages) {
        stories_.erase(byAge_.front());
        byAge_.pop_front();
    }
    return found->second;  // the newest is never the one that goes
}

void PageHistory::noteRead(PageId page, uint64_t frameIndex, double nowS) {
    PageStory& story = storyOf(page);
    ++story.reads;
    story.readFrame = frameIndex;
    story.readS = nowS;
}

void PageHistory::noteUploaded(PageId page, uint64_t frameIndex) {
    storyOf(page).uploadedFrame = frameIndex;
}

void PageHistory::noteEvicted(PageId page, PageId evictedFor, uint64_t frameIndex) {
    PageStory& story = storyOf(page);
    story.evictedFrame = frameIndex;
    story.evictedFor = evictedFor;
}

const PageStory* PageHistory::find(PageId page) const {
    const auto found = stories_.find(page);
    return found == stories_.end() ? nullptr : &found->second;
}

}  // namespace pagoda::cache
