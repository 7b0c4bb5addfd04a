// strategy.h: what a traversal sees of a frame, and what it may ask for. A strategy sees nodes,
// answers and budgets, never GL. One strategy is one file in hlod/strategies/ and one row in its
// table. Render thread only. Its place in a frame: docs/frame.md.
//
// What is absent never opens a hole. A node whose children are not all there is drawn itself, as a
// stand-in, and the walk goes on below it by boxes alone, so that the whole path is asked for at
// once. A node that was refined in the last frame stays refined; where a child is absent all the
// same (it was hidden or out of sight before), the nearest resident ancestor is drawn too.
#pragma once

#include "cache/residency.h"
#include "hlod/view/camera.h"
#include "hlod/view/frame_record.h"
#include "hlod/view/node_tree.h"
#include "hlod/view/node_watch.h"
#include "hlod/view/visibility.h"

namespace pagoda::hlod {

// What a page is wanted for.
enum class Use {
    Cut,      // to be drawn for itself
    StandIn,  // to be drawn while something finer is on its way
};

// What is told here, in order, is the frame: it can be recorded, replayed and compared.
class FrameSink {
public:
    virtual ~FrameSink() = default;
    // Of the node's page, without asking for it.
    [[nodiscard]] virtual cache::PageState state(const Node& node) const = 0;
    // Is the node's page there to be drawn in this frame? Asks for it when not. Greater priority
    // (requestPriority) is sooner.
    virtual cache::PageState want(const Node& node, double priority, Use use) = 0;
    // The page of a refined node may be needed as a stand-in: the last to go of what is not drawn.
    virtual void keep(const Node& node) = 0;
    // The node's children, or what they refine to, stand for it.
    virtual void refine(const Node& node) = 0;
    // Draws a node whose page want() said is resident; once a frame.
    virtual void draw(const Node& node, Use use) = 0;
    // The node meets the frustum and proved hidden behind what was drawn.
    virtual void hide(const Node& node) = 0;
    // Counts against all that was drawn before; null where no queries can be had.
    [[nodiscard]] virtual CountingVisibility* counting() = 0;
    [[nodiscard]] virtual PyramidVisibility* pyramid() = 0;
};

struct FrameContext {
    const View& view;
    NodeTree& tree;
    double tauPx;  // effective; 0 asks for every leaf
    uint64_t frameIndex;
    FrameSink& sink;
    FrameRecord& record;                      // what a strategy counts is marked there
    const FrameRecord* lastRecord = nullptr;  // of the frame before, with its times
    bool isSameView = false;                  // as in the frame before
    // How far below a stand-in absent nodes are asked for. All the way is soonest sharp; one level
    // reads least, since what is nearer hides more of what is behind it than its stand-in does.
    uint32_t probeLevels = UINT32_MAX;
    // What the frame before cost: its time, or CPU time where the CPU draws, and simulated stalls.
    double lastCostMs = 0.0;
    NodeWatch* watch = nullptr;  // null: no node is asked about
};

class Strategy {
public:
    virtual ~Strategy() = default;
    // Walks from the root and tells `sink` what to draw so that all that may be seen is covered.
    virtual void traverse(FrameContext& frame) = 0;
    // Drops what earlier frames taught: the next one begins as the first.
    virtual void forget() {}
    // Does it want less once more of the scene is there to hide the rest?
    [[nodiscard]] virtual bool learnsWhatIsHidden() const { return false; }
};

// How urgent a page is: visible pixels weighed by how far its stand-in's error exceeds what is
// allowed, capped, so that coarse levels do not crowd out what is seen.
[[nodiscard]] double requestPriority(double visiblePx, double excessError);

}  // namespace pagoda::hlod
