// line_estimate.h: how many bytes may be on their way so that the line stays busy and nothing new
// waits behind a long queue: bandwidth x (latency + 2 frames), both measured from what arrived.
// Like BBR's model (Cardwell et al., "BBR: Congestion-Based Congestion Control", 2016): rates count
// when the line had enough to do, latencies when it had nothing else. No limit until a rate is
// known. Numbers only; render thread.
#pragma once

#include <cstdint>
#include <limits>

namespace pagoda::cache {

class LineEstimate {
public:
    static constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

    // Frames of no time (nobody watches) must not keep the window from growing.
    static constexpr double kLeastFrameS = 1.0 / 60;

    // What is remembered of an item on its way.
    struct Mark {
        uint64_t bytes = 0, readBytes = 0;  // of the item, of the whole read
        double sentS = 0, sinceS = 0;       // sinceS: when deliveredBytes had come
        uint64_t deliveredBytes = 0;
        bool wasIdle = false;     // nothing else was on its way
        bool wasStarved = false;  // the line had too little to do
    };

    void beginFrame(double nowS);
    // One item of a read of `readBytes`.
    [[nodiscard]] Mark send(uint64_t bytes, uint64_t readBytes, double nowS);
    // There is room on the line and nothing to send.
    void starve() { starvedUntilBytes_ = deliveredBytes_ + bytesInFlight_ + 1; }
    // Of one that came, with what it was sent for or not.
    void arrive(const Mark& mark, bool isHere, double nowS);

    [[nodiscard]] uint64_t windowBytes() const;
    // May more be sent? Once in a while, while the window holds things up, not until the line is
    // empty: else the latency could not be told from the queue.
    [[nodiscard]] bool isFree(double nowS);
    [[nodiscard]] uint64_t bytesInFlight() const noexcept { return bytesInFlight_; }
    [[nodiscard]] double bytesPerS() const noexcept { return bytesPerS_; }  // 0: not known
    [[nodiscard]] double latencyS() const noexcept { return latencyS_; }

private:
    void learnRate(const Mark& mark, double nowS);
    void learnLatency(const Mark& mark, double nowS);

    double bytesPerS_ = 0;        // 0: not known
    double latencyS_ = -1;        // < 0: not known; while no rate is, with the transfer
    uint64_t transferBytes_ = 0;  // of that transfer
    bool isLatencyRough_ = false, isNextLatencyWhole_ = false;
    double latencyMeasuredS_ = 0, drainUntilS_ = 0;
    double frameS_ = kLeastFrameS, lastFrameS_ = -1;
    uint64_t bytesInFlight_ = 0, deliveredBytes_ = 0;
    double deliveredS_ = 0;
    // The first arrivals since nothing was on its way: before them the line had only its latency.
    bool hasFirst_ = false;
    double firstS_ = 0;
    uint64_t firstBytes_ = 0;
    uint64_t starvedUntilBytes_ = 0;
};

}  // namespace pagoda::cache
