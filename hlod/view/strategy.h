// strategy.h: what a traversal sees of a frame, and what it may ask for. A strategy sees nodes,
// answers and budgets, never GL. One strategy is one file in hlod/strategies/ and one row in its
// table. Render thread only. Its place in a frame: docs/frame.md, step 2.
#pragma once

#include "cache/residency.h"
#include "hlod/view/camera.h"
#include "hlod/view/frame_record.h"
#include "hlod/view/node_tree.h"
#include "hlod/view/visibility.h"

namespace pagoda::hlod {

// What is told here, in order, is the frame: it can be recorded, replayed and compared.
class FrameSink {
public:
    virtual ~FrameSink() = default;
    // Is the node's page there to be drawn in this frame? Asks for it when not. Greater priority is
    // sooner. After NoRoom the frame is void: the strategy returns, and is run again with a greater
    // tau.
    [[nodiscard]] virtual cache::PageState want(const Node& node, double priority) = 0;
    // The node's children, or what they refine to, stand for it.
    virtual void refine(const Node& node) = 0;
    // Draws a node whose page want() said is resident. Its ancestors and descendants are not drawn.
    virtual void draw(const Node& node) = 0;
    // Counts against all that was drawn before; null where no queries can be had.
    [[nodiscard]] virtual CountingVisibility* visibility() = 0;
};

struct FrameContext {
    const View& view;
    NodeTree& tree;
    double tauPx;  // effective; 0 asks for every leaf
    FrameSink& sink;
    FrameRecord& record;  // visitedNodes, culledNodes, standIns are the strategy's to count
};

class Strategy {
public:
    virtual ~Strategy() = default;
    // Walks from the root and tells `sink` a cut that covers all that the frustum meets. False when
    // want() said NoRoom.
    [[nodiscard]] virtual bool traverse(FrameContext& frame) = 0;
};

}  // namespace pagoda::hlod
