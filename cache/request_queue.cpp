#include "cache/request_queue.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

namespace pagoda::cache {
namespace {

// Reads that share the window: with fewer the line would stand still between them.
constexpr uint64_t kReadsAWindow = 4;

}  // namespace

RequestQueue::RequestQueue(LoadQueue& loads, Clock& clock, Limits limits)
    : loads_(loads), clock_(clock), limits_(limits) {
}

bool RequestQueue::isSent(const RequestKey& key) const {
    const auto found = requests_.find(key);
    return found != requests_.end() && found->second.ticket != 0;
}

bool RequestQueue::ask(const Request& request) {
    assert(!std::isnan(request.priority));
    const auto [found, isNew] = requests_.try_emplace(request.key);
    Entry& entry = found->second;
    if (isNew) ++counters_.asked;
    const bool isFirstWant = !request.isPrefetch && entry.wantedFrame != frame_;
    if (entry.frame != frame_ || isFirstWant) {
        entry.request = request;
    } else if (request.isPrefetch == entry.request.isPrefetch) {
        entry.request.priority = std::max(entry.request.priority, request.priority);
    }
    entry.frame = frame_;
    if (!request.isPrefetch) entry.wantedFrame = frame_;
    return isFirstWant;
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

// Keys break ties: coarser nodes have smaller ids, and a replayed path asks in the same order.
bool RequestQueue::Rank::isLater(const Rank& other) const {
    if (isPrefetch != other.isPrefetch) return isPrefetch;
    if (isBlock != other.isBlock) return other.isBlock;
    return priority != other.priority ? priority < other.priority : key > other.key;
}

bool RequestQueue::Place::operator<(const Place& other) const {
    return std::tie(database, offset, key) < std::tie(other.database, other.offset, other.key);
}

RequestQueue::Place RequestQueue::placeOf(Entry& entry) {
    const Request& request = entry.request;
    return {request.key.database, request.range.offset, request.key, &entry};
}

void RequestQueue::rank() {
    ranked_.clear();
    byOffset_.clear();
    const double nowS = clock_.nowS();
    for (auto& [key, entry] : requests_) {
        if (entry.ticket != 0 || entry.frame != frame_ || entry.notBeforeS > nowS) continue;
        const Request& request = entry.request;
        ranked_.push_back({request.isPrefetch, key.isBlock, request.priority, key, &entry});
        byOffset_.push_back(placeOf(entry));
    }
    // Few of many are sent: a heap finds them sooner than sorting would.
    std::make_heap(ranked_.begin(), ranked_.end(), std::mem_fn(&Rank::isLater));
    std::sort(byOffset_.begin(), byOffset_.end());
}

bool RequestQueue::isReadFree(bool isPrefetch) {
    const size_t limit = isPrefetch ? std::min(limits_.prefetchBelowReads, limits_.readsInFlight)
                                    : limits_.readsInFlight;
    return loads_.readsInFlight() < limit && (!limits_.isWindowed || line_.isFree(clock_.nowS()));
}

uint64_t RequestQueue::longestReadBytes() const {
    if (!limits_.isWindowed) return limits_.readBytes;
    return std::min(limits_.readBytes, line_.windowBytes() / kReadsAWindow);
}

void RequestQueue::send(const Admit& admit) {
    forgetStale();
    if (!isReadFree(false)) return;
    rank();
    while (!ranked_.empty()) {
        std::pop_heap(ranked_.begin(), ranked_.end(), std::mem_fn(&Rank::isLater));
        const Rank best = ranked_.back();
        ranked_.pop_back();
        if (best.entry->ticket != 0) continue;  // joined already
        if (!isReadFree(best.isPrefetch)) return;
        if (admit(best.entry->request)) {
            sendRead(*best.entry, admit);
            continue;
        }
        // All that is left is less urgent.
        std::erase_if(ranked_, [&](const Rank& other) { return other.isBlock == best.isBlock; });
        std::make_heap(ranked_.begin(), ranked_.end(), std::mem_fn(&Rank::isLater));
    }
    line_.starve();
}

// `best` is admitted; neighbours on disk that are wanted too, and admitted, join its read.
void RequestQueue::sendRead(Entry& best, const Admit& admit) {
    const auto found = std::lower_bound(byOffset_.begin(), byOffset_.end(), placeOf(best));
    const auto place = static_cast<size_t>(found - byOffset_.begin());
    uint64_t begin = best.request.range.offset, end = best.request.range.end();
    const auto joins = [&](const Entry& entry) {
        const Request& other = entry.request;
        return entry.ticket == 0 && other.key.database == best.request.key.database &&
               other.key.isBlock == best.request.key.isBlock &&
               other.isPrefetch == best.request.isPrefetch;
    };
    const uint64_t mostBytes = longestReadBytes();
    size_t low = place, high = place + 1;
    while (high < byOffset_.size() && joins(*byOffset_[high].entry)) {
        const Request& next = byOffset_[high].entry->request;
        if (next.range.offset < end || next.range.offset - end > limits_.joinGapBytes ||
            next.range.end() - begin > mostBytes || !admit(next)) {
            break;
        }
        end = next.range.end();
        ++high;
    }
    while (low > 0 && joins(*byOffset_[low - 1].entry)) {
        const Request& previous = byOffset_[low - 1].entry->request;
        if (previous.range.end() > begin || begin - previous.range.end() > limits_.joinGapBytes ||
            end - previous.range.offset > mostBytes || !admit(previous)) {
            break;
        }
        begin = previous.range.offset;
        --low;
    }
    ++counters_.reads;
    counters_.bytesRead += end - begin;
    if (best.request.key.isBlock) counters_.blockBytesRead += end - begin;
    sendItems(low, high);
}

// One read of byOffset_[low..high).
void RequestQueue::sendItems(size_t low, size_t high) {
    std::vector<LoadItem> items;
    const double nowS = clock_.nowS();
    const uint64_t readBytes =
        byOffset_[high - 1].entry->request.range.end() - byOffset_[low].entry->request.range.offset;
    for (size_t i = low; i < high; ++i) {
        Entry& entry = *byOffset_[i].entry;
        const Request& request = entry.request;
        entry.ticket = nextTicket_++;
        // With the gap behind it.
        const uint64_t end =
            i + 1 < high ? byOffset_[i + 1].entry->request.range.offset : request.range.end();
        tickets_.emplace(entry.ticket, Sent{request.key, line_.send(end - request.range.offset,
                                                                    readBytes, nowS)});
        counters_.bytesAsked += request.range.bytes;
        ++counters_.sent;
        items.push_back({entry.ticket, request.key.database, request.range, request.key.isBlock,
                         static_cast<uint32_t>(request.key.isBlock ? request.key.id : 0),
                         request.node});
    }
    loads_.send(std::move(items));
}

void RequestQueue::collect(std::vector<Arrival>& arrivals) {
    results_.clear();
    loads_.collect(results_);
    const double nowS = clock_.nowS();
    for (LoadResult& result : results_) {
        const auto ticket = tickets_.find(result.ticket);
        assert(ticket != tickets_.end());
        const auto found = requests_.find(ticket->second.key);
        const bool isHere = result.page || result.block;
        line_.arrive(ticket->second.mark, isHere, nowS);
        tickets_.erase(ticket);
        Entry& entry = found->second;
        entry.ticket = 0;
        Request request = entry.request;
        request.isPrefetch = entry.wantedFrame == 0;
        const uint64_t framesSinceAsked = frame_ - entry.frame;
        if (!isHere && ++entry.failures < limits_.attempts) {
            entry.notBeforeS = nowS + limits_.firstPauseS * std::exp2(entry.failures - 1.0);
            ++counters_.retried;
            // The room that was reserved is given back: the request is admitted anew.
            arrivals.push_back({request, {result.ticket, {}, {}, {}}, framesSinceAsked});
            continue;
        }
        counters_.failed += !isHere;
        if (!isHere && result.fault.empty()) result.fault = "cannot be read";
        arrivals.push_back({request, std::move(result), framesSinceAsked});
        requests_.erase(found);
    }
}

bool RequestQueue::waitForArrival() {
    if (!tickets_.empty() && loads_.waitForArrival()) return true;
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
