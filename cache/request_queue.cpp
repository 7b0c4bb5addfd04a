#include "cache/request_queue.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace pagoda::cache {

RequestQueue::RequestQueue(LoadQueue& loads, Clock& clock, Limits limits)
    : loads_(loads), clock_(clock), limits_(limits) {
}

bool RequestQueue::isSent(const RequestKey& key) const {
    const auto found = requests_.find(key);
    return found != requests_.end() && found->second.ticket != 0;
}

bool RequestQueue::ask(const Request& request) {
    const auto [found, isNew] = requests_.try_emplace(request.key);
    Entry& entry = found->second;
    if (isNew) ++counters_.asked;
    if (isNew || entry.frame != frame_ || (entry.request.isPrefetch && !request.isPrefetch)) {
        entry.request = request;
        entry.frame = frame_;
        return !request.isPrefetch;
    }
    if (entry.request.isPrefetch == request.isPrefetch) {
        entry.request.priority = std::max(entry.request.priority, request.priority);
    }
    return false;
}

void RequestQueue::forgetStale() {
    std::erase_if(requests_, [&](const auto& item) {
        const Entry& entry = item.second;
        const bool isStale = entry.ticket == 0 && entry.frame != frame_;
        // One that failed keeps its count of failures until its pause has ended.
        if (isStale && entry.notBeforeS > clock_.nowS()) return false;
        counters_.cancelled += isStale;
        return isStale;
    });
}

void RequestQueue::rank() {
    ranked_.clear();
    const double nowS = clock_.nowS();
    for (auto& [key, entry] : requests_) {
        if (entry.ticket == 0 && entry.frame == frame_ && entry.notBeforeS <= nowS) {
            ranked_.push_back(&entry);
        }
    }
    byOffset_ = ranked_;
    // Keys break ties: coarser nodes have smaller ids, and a replayed path asks in the same order.
    std::sort(ranked_.begin(), ranked_.end(), [](const Entry* a, const Entry* b) {
        const Request &p = a->request, &q = b->request;
        if (p.isPrefetch != q.isPrefetch) return q.isPrefetch;
        if (p.key.isBlock != q.key.isBlock) return p.key.isBlock;
        return p.priority != q.priority ? p.priority > q.priority : p.key < q.key;
    });
    std::sort(byOffset_.begin(), byOffset_.end(), [](const Entry* a, const Entry* b) {
        return std::tuple(a->request.key.database, a->request.range.offset, a->request.key) <
               std::tuple(b->request.key.database, b->request.range.offset, b->request.key);
    });
}

void RequestQueue::send(const std::function<bool(const Request&)>& admit) {
    forgetStale();
    rank();
    bool isFull[2] = {false, false};
    for (size_t i = 0; i < ranked_.size() && loads_.readsInFlight() < limits_.readsInFlight; ++i) {
        const Request& request = ranked_[i]->request;
        if (ranked_[i]->ticket != 0 || isFull[request.key.isBlock]) continue;  // joined already
        if (!admit(request)) {
            isFull[request.key.isBlock] = true;
            continue;
        }
        sendRead(i, admit);
    }
}

// ranked_[first] is admitted; neighbours on disk that are wanted too, and admitted, join its read.
void RequestQueue::sendRead(size_t first, const std::function<bool(const Request&)>& admit) {
    const Request& best = ranked_[first]->request;
    const auto place = static_cast<size_t>(
        std::find(byOffset_.begin(), byOffset_.end(), ranked_[first]) - byOffset_.begin());
    uint64_t begin = best.range.offset, end = best.range.end();
    const auto joins = [&](const Entry& entry) {
        const Request& other = entry.request;
        return entry.ticket == 0 && other.key.database == best.key.database &&
               other.key.isBlock == best.key.isBlock && other.isPrefetch == best.isPrefetch;
    };
    size_t low = place, high = place + 1;
    while (high < byOffset_.size() && joins(*byOffset_[high])) {
        const ByteRange& range = byOffset_[high]->request.range;
        if (range.offset < end || range.offset - end > limits_.joinGapBytes ||
            range.end() - begin > limits_.readBytes || !admit(byOffset_[high]->request)) {
            break;
        }
        end = range.end();
        ++high;
    }
    while (low > 0 && joins(*byOffset_[low - 1])) {
        const ByteRange& range = byOffset_[low - 1]->request.range;
        if (range.end() > begin || begin - range.end() > limits_.joinGapBytes ||
            end - range.offset > limits_.readBytes || !admit(byOffset_[low - 1]->request)) {
            break;
        }
        begin = range.offset;
        --low;
    }
    std::vector<LoadItem> items;
    for (size_t i = low; i < high; ++i) {
        Entry& entry = *byOffset_[i];
        const Request& request = entry.request;
        entry.ticket = nextTicket_++;
        tickets_.emplace(entry.ticket, request.key);
        counters_.bytesAsked += request.range.bytes;
        ++counters_.sent;
        items.push_back({entry.ticket, request.key.database, request.range, request.key.isBlock,
                         static_cast<uint32_t>(request.key.isBlock ? request.key.id : 0),
                         request.node});
    }
    ++counters_.reads;
    counters_.bytesRead += end - begin;
    loads_.send(std::move(items));
}

void RequestQueue::collect(std::vector<Arrival>& arrivals) {
    results_.clear();
    loads_.collect(results_);
    for (LoadResult& result : results_) {
        const auto ticket = tickets_.find(result.ticket);
        assert(ticket != tickets_.end());
        const auto found = requests_.find(ticket->second);
        tickets_.erase(ticket);
        Entry& entry = found->second;
        entry.ticket = 0;
        const bool isHere = result.page || result.block;
        if (!isHere && ++entry.failures < limits_.attempts) {
            entry.notBeforeS =
                clock_.nowS() + limits_.firstPauseS * std::exp2(entry.failures - 1.0);
            ++counters_.retried;
            // The room that was reserved is given back: the request is admitted anew.
            arrivals.push_back({entry.request, {result.ticket, {}, {}, {}}});
            continue;
        }
        counters_.failed += !isHere;
        arrivals.push_back({std::move(entry.request), std::move(result)});
        requests_.erase(found);
    }
}

bool RequestQueue::waitForArrival() {
    if (loads_.readsInFlight() > 0) return loads_.waitForArrival();
    double nextS = std::numeric_limits<double>::infinity();
    for (const auto& [key, entry] : requests_) {
        if (entry.frame == frame_ && entry.notBeforeS > clock_.nowS()) {
            nextS = std::min(nextS, entry.notBeforeS);
        }
    }
    if (!std::isfinite(nextS)) return false;
    clock_.waitUntil(nextS);
    return true;
}

}  // namespace pagoda::cache
