// frame_record.h: what one frame did: one schema for HUD, bench, tests and `render --stats`.
// Lines marked (strategy) are counted by the strategy, all others by who runs the frame.
#pragma once

#include "cache/prefetch_counts.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pagoda::hlod {

// What a prediction came to (paper 004): refine, stop or delay, against what its answer said.
struct PredictionCounts {
    uint64_t refine = 0, stop = 0, delay = 0;
    uint64_t stopHidden = 0;    // drawn, and then found hidden
    uint64_t delayHidden = 0;   // rightly not drawn
    uint64_t delayVisible = 0;  // drawn late
};

struct FrameRecord {
    std::string strategy;
    std::string choice;  // of a strategy that chooses: what, and why (strategy)
    uint64_t frameIndex = 0;
    int widthPx = 0, heightPx = 0;
    double tauPx = 0;           // asked for
    double effectiveTauPx = 0;  // raised until the cut fits the GPU budget

    uint64_t visitedNodes = 0;  // boxes looked at (strategy)
    uint64_t culledNodes = 0;   // outside the frustum (strategy)
    uint64_t hiddenNodes = 0;   // proved hidden, with all below
    uint64_t drawnNodes = 0;
    uint64_t drawnTriangles = 0;  // zippers and translucent ones included
    uint64_t drawnZippers = 0;
    uint64_t translucentTriangles = 0;
    uint64_t standIns = 0;  // nodes drawn because a page or index block below them was not there
    uint64_t queries = 0;
    uint64_t delayedNodes = 0;  // drawn after their answer had come (strategy)
    uint64_t rarnNodes = 0;     // rendered already, refinement needed in the same frame (strategy)
    uint64_t risenNodes = 0;    // drawn in place of the children of the frame before (strategy)
    uint64_t waits = 0;         // times that an answer was waited for (strategy)
    PredictionCounts predictions;  // (strategy)
    uint64_t coveredPixels = 0;    // not background; counted when the picture is read
    uint64_t fallbackPixels = 0;   // drawn by stand-ins; counted when the picture is read

    uint64_t missingPages = 0;  // wanted and not there
    uint64_t demandBytes = 0;   // GPU bytes of the whole cut, there or not
    uint64_t loadedPages = 0, bytesRead = 0, bytesUploaded = 0;
    uint64_t evictedPages = 0, reloadedPages = 0;
    cache::PrefetchCounts prefetch{};       // pages read ahead, by PrefetchReason
    cache::PrefetchCount prefetchedBlocks;  // index blocks read ahead
    std::string prefetchOff;                // what is not read ahead because it does not pay
    uint64_t indexBlocks = 0, indexBytes = 0;
    uint64_t gpuBytes = 0, hostBytes = 0;

    double frameMs = 0;           // all of it but reading the picture back
    double streamMs = 0;          // taking arrivals, uploading, sending requests
    double traverseMs = 0;        // the strategy's own work
    double queryMs = 0;           // issuing and waiting for answers
    double drawMs = 0;            // draw calls and all that the GPU does
    double readMs = 0;            // reading the picture back
    double simulatedStallMs = 0;  // of answers that are late by --query-latency and waited for
    double cpuMs = 0;             // of the whole process, all threads

    bool isSettled = false;  // nothing is missing, and the next frame will draw the same

    std::vector<std::string> faults;  // one line each: what could not be read
};

// One JSON object on one line, keys in snake_case (docs/frame.md lists them).
[[nodiscard]] std::string frameRecordToJson(const FrameRecord& record);

}  // namespace pagoda::hlod
