#include "cache/line_estimate.h"

#include <algorithm>

namespace pagoda::cache {
namespace {

constexpr double kFramesAhead = 2;  // arrivals are seen once a frame, and answered at its end
constexpr double kRise = 0.5, kFall = 0.125;  // of the way to a new sample
constexpr double kFrameShare = 0.125, kLatencyShare = 0.25;
constexpr double kLongestFrameS = 1;
constexpr double kRemeasureS = 10;  // as BBR: emptying the line costs a latency
constexpr double kLongestDrainS = 1;

}  // namespace

void LineEstimate::beginFrame(double nowS) {
    if (lastFrameS_ >= 0) {
        const double lastedS = std::clamp(nowS - lastFrameS_, kLeastFrameS, kLongestFrameS);
        frameS_ += kFrameShare * (lastedS - frameS_);
    }
    lastFrameS_ = nowS;
}

bool LineEstimate::isFree(double nowS) {
    if (bytesInFlight_ == 0) return true;
    if (nowS < drainUntilS_) return false;
    if (bytesInFlight_ < windowBytes()) return true;
    if (isLatencyRough_ || nowS - latencyMeasuredS_ > kRemeasureS) {
        isLatencyRough_ = false;
        isNextLatencyWhole_ = true;
        drainUntilS_ = nowS + kLongestDrainS;
        latencyMeasuredS_ = nowS;
    }
    return false;
}

LineEstimate::Mark LineEstimate::send(uint64_t bytes, uint64_t readBytes, double nowS) {
    const bool isIdle = bytesInFlight_ == 0;
    if (isIdle) {
        hasFirst_ = false;
        deliveredS_ = drainUntilS_ = nowS;
    }
    bytesInFlight_ += bytes;
    return {.bytes = bytes,
            .readBytes = readBytes,
            .sentS = nowS,
            .sinceS = deliveredS_,
            .deliveredBytes = deliveredBytes_,
            .wasIdle = isIdle,
            .wasStarved = deliveredBytes_ < starvedUntilBytes_};
}

void LineEstimate::arrive(const Mark& mark, bool isHere, double nowS) {
    bytesInFlight_ -= mark.bytes;
    if (!isHere) return;  // fails sooner or later than bytes come
    deliveredBytes_ += mark.bytes;
    deliveredS_ = nowS;
    if (!hasFirst_ || nowS <= firstS_) {
        hasFirst_ = true;
        firstS_ = nowS;
        firstBytes_ = deliveredBytes_;
    }
    learnLatency(mark, nowS);
    learnRate(mark, nowS);
}

void LineEstimate::learnRate(const Mark& mark, double nowS) {
    // Of the first flight, what came after its first bytes.
    const bool isFirstFlight = mark.deliveredBytes < firstBytes_ && mark.sinceS < firstS_;
    const double sinceS = isFirstFlight ? firstS_ : mark.sinceS;
    const uint64_t before = isFirstFlight ? firstBytes_ : mark.deliveredBytes;
    if (!(nowS > sinceS) || deliveredBytes_ <= before) return;
    const double rate = static_cast<double>(deliveredBytes_ - before) / (nowS - sinceS);
    if (rate <= bytesPerS_ && mark.wasStarved) return;  // it could have been more
    if (bytesPerS_ > 0) {
        bytesPerS_ += (rate > bytesPerS_ ? kRise : kFall) * (rate - bytesPerS_);
    } else if (!mark.wasStarved) {
        bytesPerS_ = rate;
        latencyS_ = std::max(latencyS_ - static_cast<double>(transferBytes_) / rate, 0.0);
        isLatencyRough_ = true;
    }
}

// Behind others, bytes wait for more than the latency.
void LineEstimate::learnLatency(const Mark& mark, double nowS) {
    if (!mark.wasIdle) return;
    latencyMeasuredS_ = nowS;
    const double tookS = nowS - mark.sentS;
    if (!(bytesPerS_ > 0)) {
        latencyS_ = tookS;
        transferBytes_ = mark.readBytes;
        return;
    }
    const double sampleS = std::max(tookS - static_cast<double>(mark.readBytes) / bytesPerS_, 0.0);
    latencyS_ += (isNextLatencyWhole_ ? 1 : kLatencyShare) * (sampleS - latencyS_);
    isNextLatencyWhole_ = false;
}

uint64_t LineEstimate::windowBytes() const {
    if (!(bytesPerS_ > 0) || latencyS_ < 0) return kUnlimited;
    const double bytes = bytesPerS_ * (latencyS_ + kFramesAhead * frameS_);
    return bytes < 1e15 ? static_cast<uint64_t>(bytes) : kUnlimited;
}

}  // namespace pagoda::cache
