// coherent.h: the traversal that the strategies of paper 004 share. They differ in how a node's
// state is predicted, in whether answers weigh the error (VMSSE) or only say yes or no, and in
// whether an answer is waited for at once; in nothing else.
//
// Nodes are taken from a queue, nearest box first. A prediction says refine (no query, children
// next), stop (query its box and draw it at once) or delay (query; drawing waits for the answer).
// Answers are taken in order while the walk goes on, and waited for when nothing else is left. A
// wrong stop whose answer says "refine" has its children drawn over it (RARN).
#pragma once

#include "hlod/strategies/node_memory.h"
#include "hlod/strategies/pyramid_answers.h"
#include "hlod/strategies/strategies.h"

#include <cstdint>
#include <deque>
#include <vector>

namespace pagoda::hlod {

struct CoherentRules {
    enum class Predict {
        Coherent,  // from the node's own last answer, or its children's (paper 004)
        InOrder,   // from the last answer of any node (the older scheme, `simp`)
        Never,     // always delay
    };
    Predict predict = Predict::Coherent;
    bool doesWeighError = true;  // VMSSE; else SSE alone
    bool doesWaitAtOnce = false;
    bool usesPyramid = false;  // answers from depths drawn before the first wait, not from queries
    // Stops are asked about by queries whose answers come in later frames, the rest by the pyramid.
    bool takesLateAnswers = false;
    StrategyOptions options{};
};

class CoherentStrategy final : public Strategy {
public:
    explicit CoherentStrategy(const CoherentRules& rules) : rules_(rules) {}
    void traverse(FrameContext& frame) override;
    void forget() override;
    [[nodiscard]] bool learnsWhatIsHidden() const override { return true; }
    // From the next frame on; what was learnt stays.
    void usePyramid(bool doesUse) { rules_.usesPyramid = doesUse; }

private:
    enum class Prediction : uint8_t { Refine, Stop, Delay };
    // Half a cache line with the page's id: the walk waits for memory more than for anything else.
    struct Memory {
        double bias = 1.0;
        uint32_t visitedFrame = 0;  // of this strategy
        uint8_t hiddenFrames = 0;   // in a row, up to its last visit; 255: or more
        bool isVisible : 1 = false;
        bool isStop : 1 = false;
        bool isDoubted : 1 = false;   // a late answer saw nothing of it, whatever the pyramid says
        bool isRefined : 1 = false;   // in the frame of its last visit
        bool wasRefined : 1 = false;  // in the frame before that
    };
    // A node in this frame. A cache line.
    struct Visit {
        Node node;
        Memory* memory = nullptr;  // null: outside the frustum
        double ssePx = 0;
        uint64_t visiblePx = 0;
        uint32_t parent = 0;
        // Levels below the node that is drawn as a stand-in: tested and asked for, never drawn. 0:
        // there is none above.
        uint32_t probeLevel = 0;
        Prediction prediction = Prediction::Delay;
        bool isDrawn = false;
    };
    struct Queued {
        float distance = 0;
        uint32_t visit = 0;
    };
    struct Asked {
        uint32_t visit = 0;  // or the first in gathered_ of those that were asked together
        QueryTicket ticket;
        uint32_t together = 0;  // 0: one
    };

    void push(const Node& node, uint32_t parent, uint32_t probeLevel);
    [[nodiscard]] uint32_t pop();
    void visit(uint32_t index);
    [[nodiscard]] Prediction predict(uint32_t index);
    [[nodiscard]] bool mayRise(const Visit& visit, const NodeRange& children);
    void askLate(uint32_t index);
    void takeLateAnswers();
    [[nodiscard]] bool hasHiddenChildrenOnly(const NodeRange& children);
    [[nodiscard]] const NodeRange& children(uint32_t index, double priority);
    [[nodiscard]] bool wasVisitedBefore(const Memory& memory) const {
        return memory.visitedFrame + 1 == frameNumber_;
    }
    void takeAnswers(bool doesPoll);
    void ask(uint32_t index);
    [[nodiscard]] bool isTrusted(const Visit& visit) const;
    void trust(uint32_t index);
    [[nodiscard]] bool isGathered(const Visit& visit) const;
    void askGathered();
    void answer(uint32_t index, uint64_t visiblePx);
    void seeUnasked(uint32_t index);
    void markVisible(uint32_t index);
    // Null when the node is not the one that is watched.
    [[nodiscard]] NodeWatch* watchOf(const Visit& visit) const;
    void noteAnswer(NodeWatch& watch, uint64_t visiblePx, double outlinePx, bool isUnasked) const;
    void emit(uint32_t index);
    void draw(uint32_t index);
    void refine(uint32_t index);
    [[nodiscard]] bool canRefine(const Memory& memory, const NodeRange& children);
    void standInFor(uint32_t index);
    [[nodiscard]] bool drawStandIn(uint32_t index);
    [[nodiscard]] bool isFine(const Visit& visit, double bias) const;
    [[nodiscard]] double biasOf(uint64_t visiblePx, double outlinePx) const;
    [[nodiscard]] double priorityOf(const Visit& visit) const;
    [[nodiscard]] bool isLater(const Queued& a, const Queued& b) const;

    CoherentRules rules_;
    NodeMemory<Memory> memory_;
    uint32_t frameNumber_ = 1;  // memories of frame 0 are of no frame
    double lastBias_ = 1.0;     // of the last answer in order
    FrameContext* frame_ = nullptr;
    CountingVisibility* counting_ = nullptr;
    PyramidAnswers pyramidAnswers_;
    // Of a stop in an earlier frame.
    struct LateQuery {
        cache::PageId page;
        uint32_t slot = 0;
        double outlinePx = 0;
        QueryTicket ticket;
    };
    std::deque<LateQuery> lateQueries_;  // oldest first
    CountingVisibility* late_ = nullptr;
    bool mayCoarsen_ = true;  // in this frame
    double lastTauPx_ = 0.0;
    std::vector<Visit> visits_;
    std::vector<Queued> queue_;       // a heap, nearest first
    std::deque<Asked> pending_;       // oldest first
    std::vector<uint32_t> gathered_;  // visits that are asked about together
    size_t askedGathered_ = 0;        // the first so many of them were
    // Looked up for the prediction, used again by what follows from it.
    uint32_t familyOf_ = 0;
    NodeRange family_;
};

}  // namespace pagoda::hlod
