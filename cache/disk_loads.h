// disk_loads.h: a simulated disk in front of another queue: results are held back until a disk of
// the profile would have given them. Reading and decoding go on meanwhile, so that only the time of
// arrival is simulated. On a manual clock arrivals depend on the profile and what was sent alone:
// the same scenario gives the same frames every time.
// The model: requests overlap (each waits out its latency on its own); transfers share one line and
// use it in the order they were sent. A failed read answers when its transfer would have begun, and
// leaves the line to the next one. Results arrive whole reads at a time, in order of time.
#pragma once

#include "cache/clock.h"
#include "cache/load_queue.h"

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

namespace pagoda::cache {

struct DiskProfile {
    double bytesPerS = 0;   // 0: as fast as it comes
    double latencyS = 0;    // of each read, and of each further part of a short one
    double failShare = 0;   // of reads that fail (and may succeed when tried again), in [0, 1]
    double shortShare = 0;  // of reads that give half at first: the rest takes another latency
    uint64_t seed = 1;
    [[nodiscard]] bool isAsIs() const {
        return bytesPerS <= 0 && latencyS <= 0 && failShare <= 0 && shortShare <= 0;
    }
};

// "as-is", or parts joined by commas: "500MB/s", "50Mbit/s", "10ms", "fail=1%", "short=5%".
// Throws Error ("--disk" as its path) for anything else, and for a disk of no bandwidth.
[[nodiscard]] DiskProfile parseDiskProfile(std::string_view text);

class DiskLoads final : public LoadQueue {
public:
    struct Counters {
        uint64_t reads = 0, bytes = 0, failedReads = 0, shortReads = 0;
    };

    // `clock` outlives it.
    DiskLoads(std::unique_ptr<LoadQueue> inner, const DiskProfile& profile, Clock& clock);

    void send(std::vector<LoadItem> items) override;
    void collect(std::vector<LoadResult>& arrived) override;
    // Moves the clock to the next arrival. False also when the inner queue has lost what is due.
    [[nodiscard]] bool waitForArrival() override;
    [[nodiscard]] size_t readsInFlight() const override { return reads_.size(); }
    // Of what is sent from now on; what is on its way keeps its time of arrival.
    void setProfile(const DiskProfile& profile);
    [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

private:
    struct Read {
        double doneS = 0;
        bool isFailed = false;
        std::vector<uint64_t> tickets;
    };
    [[nodiscard]] double chance();                // the next of a fixed sequence in [0, 1)
    [[nodiscard]] bool isHere(const Read& read);  // decoded
    void take(const Read& read, std::vector<LoadResult>& arrived);

    std::unique_ptr<LoadQueue> inner_;
    DiskProfile profile_;
    Clock& clock_;
    double lineFreeS_ = 0;
    uint64_t draws_ = 0;
    std::deque<Read> reads_;                          // in order of arrival
    std::unordered_map<uint64_t, LoadResult> ready_;  // by ticket: read, not yet due
    std::vector<LoadResult> scratch_;
    Counters counters_;
};

}  // namespace pagoda::cache
