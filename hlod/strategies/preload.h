// preload.h: asks for every node from the root down to the cut at tau, and draws nothing: what a
// renderer that holds the whole model would have there. Benchmarks run it before they measure
// culling alone. Not in the table of strategies.
#pragma once

#include "hlod/view/strategy.h"

namespace pagoda::hlod {

class PreloadStrategy final : public Strategy {
public:
    void traverse(FrameContext& frame) override;
};

}  // namespace pagoda::hlod
