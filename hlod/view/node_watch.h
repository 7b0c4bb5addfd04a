// node_watch.h: what frames note of one node that somebody asks about: why it is refined, drawn or
// left out. Costs a comparison an answer while a node is watched, nothing else. Plain data, filled
// in by who runs the frame; lines marked (strategy) by strategies that ask what is seen.
#pragma once

#include "cache/page_id.h"

#include <cstdint>

namespace pagoda::hlod {

struct NodeWatch {
    enum class Prediction { None, Refine, Stop, Delay };

    cache::PageId page{};  // whom to watch

    // Frames count from 1; 0: not since it is watched.
    uint64_t refinedFrame = 0, drawnFrame = 0, standInFrame = 0, hiddenFrame = 0;
    uint64_t wantedFrame = 0;  // its page
    double priority = 0;       // then

    uint64_t predictedFrame = 0;               // (strategy)
    Prediction prediction = Prediction::None;  // (strategy) paper 004: what was foretold of it
    uint64_t answeredFrame = 0;                // (strategy) when an answer about its box came
    bool isUnasked = false;                    // (strategy) then: it holds the eye, so it is seen
    uint64_t visiblePx = 0;                    // (strategy) the answer
    double outlinePx = 0;                      // (strategy) pixels of its box, were nothing before
    double relativeVisibility = 1.0, bias = 1.0;  // (strategy) mu and what it makes of the error
};

}  // namespace pagoda::hlod
