// request_queue.h: what is asked for and not here yet: ranked anew each frame, joined where
// neighbours on disk are both wanted, dropped when nobody asks any more, tried again with growing
// pauses when it fails. Knows ranges and numbers, not what they hold. Render thread only. Its place
// in a frame: docs/frame.md.
#pragma once

#include "cache/clock.h"
#include "cache/line_estimate.h"
#include "cache/load_queue.h"

#include <compare>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace pagoda::cache {

struct RequestKey {
    uint32_t database = 0;
    bool isBlock = false;
    uint64_t id = 0;  // NodeId::value, or a block's number
    [[nodiscard]] auto operator<=>(const RequestKey&) const = default;
};

struct RequestKeyHash {
    [[nodiscard]] size_t operator()(const RequestKey& key) const noexcept {
        return static_cast<size_t>(
            (key.id + (uint64_t{key.database} << 59) + (uint64_t{key.isBlock} << 63)) *
            0x9E3779B97F4A7C15ull);
    }
};

struct Request {
    RequestKey key;
    ByteRange range;
    double priority = 0;      // greater is sooner; prefetched ones come after all others
    bool isPrefetch = false;  // nothing that is on the screen needs it yet
    ooc::NodeRecord node{};   // of a page
    uint8_t reason = 0;       // of a prefetch: the asker's own, < kPrefetchReasons
};

class RequestQueue {
public:
    struct Limits {
        size_t readsInFlight = 16;
        size_t prefetchBelowReads = 4;    // in flight: above, reads stay free for what is wanted
        uint64_t joinGapBytes = 2 << 10;  // bytes read in vain rather than a second read
        uint64_t readBytes = 1 << 20;     // of one joined read
        uint32_t attempts = 4;
        double firstPauseS = 0.02;  // doubles with each failure
        // Bytes in flight: no more than keep the line busy (line_estimate.h), and at least one
        // read; joined ones get shorter, so that several share the window.
        bool isWindowed = true;
    };
    struct Counters {
        uint64_t asked = 0, sent = 0, reads = 0, cancelled = 0, retried = 0, failed = 0;
        uint64_t bytesAsked = 0;      // ranges of what was sent
        uint64_t bytesRead = 0;       // with the gaps of joined reads
        uint64_t blockBytesRead = 0;  // of them, for index blocks
    };
    // What came of a request. With a fault every attempt has failed; with neither page, block nor
    // fault this one has, and there will be another: what admit() reserved is given back meanwhile.
    struct Arrival {
        Request request;
        LoadResult result;
        uint64_t framesSinceAsked = 0;  // a stale one that had been sent may come late
    };

    // Both outlive it.
    RequestQueue(LoadQueue& loads, Clock& clock, Limits limits);

    void beginFrame() {
        ++frame_;
        line_.beginFrame(clock_.nowS());
    }
    // Asks, or ranks anew: within a frame the greatest priority (a number, asserted) holds, and a
    // want beats a prefetch. True the first time in a frame that it is wanted (not prefetched).
    // What was wanted once arrives as wanted (Arrival::request), even if only prefetched since.
    bool ask(const Request& request);
    // Sends the best ones while reads are free. `admit` says whether there is room for it (and
    // reserves it); one that is not admitted waits, and so does everything less urgent of its kind
    // (pages or blocks): the best must not starve. Requests nobody asked for in this frame are
    // forgotten. O(n log n) of those that wait.
    void send(const std::function<bool(const Request&)>& admit);
    // Appends what came of requests that were sent.
    void collect(std::vector<Arrival>& arrivals);
    // Blocks until collect() may give something: an arrival, or the end of a pause (then send()
    // goes on). False when nothing is on its way.
    [[nodiscard]] bool waitForArrival();

    [[nodiscard]] bool isAsked(const RequestKey& key) const { return requests_.contains(key); }
    [[nodiscard]] bool isSent(const RequestKey& key) const;
    [[nodiscard]] size_t sentCount() const noexcept { return tickets_.size(); }
    [[nodiscard]] size_t waitingCount() const noexcept {
        return requests_.size() - tickets_.size();
    }
    [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
    [[nodiscard]] const LineEstimate& line() const noexcept { return line_; }

private:
    struct Entry {
        Request request;
        uint64_t frame = 0;        // when it was last asked for
        uint64_t wantedFrame = 0;  // 0: never
        uint64_t ticket = 0;       // 0: not sent
        uint32_t failures = 0;
        double notBeforeS = 0;
    };
    // What requests are ordered by, side by side: ten thousand are sorted in each frame.
    struct Rank {
        bool isPrefetch, isBlock;
        double priority;
        RequestKey key;
        Entry* entry;
        [[nodiscard]] bool isLater(const Rank& other) const;
    };
    struct Place {
        uint32_t database;
        uint64_t offset;
        RequestKey key;
        Entry* entry;
        [[nodiscard]] bool operator<(const Place& other) const;
    };
    struct Sent {
        RequestKey key;
        LineEstimate::Mark mark;
    };
    using Admit = std::function<bool(const Request&)>;
    void forgetStale();
    void rank();
    [[nodiscard]] static Place placeOf(Entry& entry);
    [[nodiscard]] bool isReadFree(bool isPrefetch);
    [[nodiscard]] uint64_t longestReadBytes() const;
    void sendRead(Entry& best, const Admit& admit);
    void sendItems(size_t low, size_t high);

    LoadQueue& loads_;
    Clock& clock_;
    Limits limits_;
    std::unordered_map<RequestKey, Entry, RequestKeyHash> requests_;
    std::unordered_map<uint64_t, Sent> tickets_;
    LineEstimate line_;
    std::vector<Rank> ranked_;     // waiting: a heap, the best on top
    std::vector<Place> byOffset_;  // the same, by place on disk
    std::vector<LoadResult> results_;
    uint64_t frame_ = 1, nextTicket_ = 1;
    Counters counters_;
};

}  // namespace pagoda::cache
