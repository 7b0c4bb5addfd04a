// timeline.h: times of the last frames, for the line of bars in the HUD. Plain data.
#pragma once

#include "hlod/view/frame_record.h"

#include <array>
#include <cstddef>

namespace pagoda::viewer {

class Timeline {
public:
    static constexpr size_t kFrames = 120;
    struct Bar {
        float streamMs = 0, traverseMs = 0, queryMs = 0, drawMs = 0;
        [[nodiscard]] float totalMs() const { return streamMs + traverseMs + queryMs + drawMs; }
    };

    void add(const hlod::FrameRecord& record) {
        bars_[next_] = {static_cast<float>(record.streamMs), static_cast<float>(record.traverseMs),
                        static_cast<float>(record.queryMs), static_cast<float>(record.drawMs)};
        next_ = (next_ + 1) % kFrames;
    }
    // 0 is the oldest.
    [[nodiscard]] const Bar& bar(size_t i) const { return bars_[(next_ + i) % kFrames]; }

private:
    std::array<Bar, kFrames> bars_{};
    size_t next_ = 0;
};

}  // namespace pagoda::viewer
