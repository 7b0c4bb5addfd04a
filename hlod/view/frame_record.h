// frame_record.h: what one frame did: one schema for HUD, bench, tests and `render --stats`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pagoda::hlod {

struct FrameRecord {
    std::string strategy;
    int widthPx = 0, heightPx = 0;
    double tauPx = 0;           // asked for
    double effectiveTauPx = 0;  // raised until the cut fits the GPU budget

    uint64_t visitedNodes = 0;  // boxes looked at
    uint64_t culledNodes = 0;   // outside the frustum
    uint64_t drawnNodes = 0;
    uint64_t drawnTriangles = 0;  // zippers and translucent ones included
    uint64_t drawnZippers = 0;
    uint64_t translucentTriangles = 0;
    uint64_t standIns =
        0;  // nodes drawn because a page or index block below them was absent or broken
    uint64_t queries = 0;
    uint64_t coveredPixels = 0;  // not background; counted when the picture is read

    uint64_t loadedPages = 0, bytesRead = 0, bytesUploaded = 0;
    uint64_t evictedPages = 0;
    uint64_t indexBlocks = 0, indexBytes = 0;
    uint64_t gpuBytes = 0, hostBytes = 0;

    double traverseMs = 0;  // with loading and upload, while these are synchronous
    double drawMs = 0;      // draw calls and all that the GPU does
    double readMs = 0;      // reading the picture back

    std::vector<std::string> faults;  // one line each: what could not be read
};

// One JSON object on one line, keys in snake_case (docs/frame.md lists them).
[[nodiscard]] std::string frameRecordToJson(const FrameRecord& record);

}  // namespace pagoda::hlod
