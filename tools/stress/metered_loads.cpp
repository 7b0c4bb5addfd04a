#include "tools/stress/metered_loads.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace pagoda::tools {

void MeteredLoads::send(std::vector<cache::LoadItem> items) {
    totals_.bytes += items.back().range.end() - items.front().range.offset;
    for (const cache::LoadItem& item : items) {
        if (item.isBlock) {
            totals_.blockBytes += item.range.bytes;
            continue;
        }
        totals_.pageBytes += item.range.bytes;
        Page& page = pages_[item.node.id];
        page.bytes = item.range.bytes;
        ++page.times;
        const int depth = item.node.id.depth() + (item.node.id.slot() != 0 ? 1 : 0);
        const bool isFirst = greatestDepth_ < leastDepth_;
        leastDepth_ = isFirst ? depth : std::min(leastDepth_, depth);
        greatestDepth_ = isFirst ? depth : std::max(greatestDepth_, depth);
    }
    decoding_ += items.size();
    inner_->send(std::move(items));
}

void MeteredLoads::finishDecoding() {
    while (decoding_ > 0 && inner_->waitForArrival()) {
        const size_t before = ready_.size();
        inner_->collect(ready_);
        decoding_ -= ready_.size() - before;
    }
}

void MeteredLoads::collect(std::vector<cache::LoadResult>& arrived) {
    const size_t before = ready_.size();
    inner_->collect(ready_);
    decoding_ -= ready_.size() - before;
    std::move(ready_.begin(), ready_.end(), std::back_inserter(arrived));
    ready_.clear();
}

bool MeteredLoads::waitForArrival() {
    return !ready_.empty() || inner_->waitForArrival();
}

}  // namespace pagoda::tools
