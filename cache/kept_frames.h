// kept_frames.h: what was used lately stays: it is not evicted for something else, so that nothing
// on the screen gets coarser because something else loads. Pages and index blocks alike.
#pragma once

#include <cstdint>

namespace pagoda::cache {

inline constexpr uint64_t kKeptFrames = 2;  // before the current one

// What was used in this frame or later is kept.
[[nodiscard]] constexpr uint64_t keepSinceFrame(uint64_t frameIndex) {
    return frameIndex > kKeptFrames ? frameIndex - kKeptFrames : 0;
}

// What gives way at once to a want, but to no prefetch, is marked with this frame: prefetches evict
// only what was used before it, wants all that was used before keepSinceFrame().
[[nodiscard]] constexpr uint64_t spareFrame(uint64_t frameIndex) {
    const uint64_t since = keepSinceFrame(frameIndex);
    return since > 0 ? since - 1 : 0;
}

}  // namespace pagoda::cache
