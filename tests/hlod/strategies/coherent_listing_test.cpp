// The coherent traversal as published (paper 004), frame by frame on seven nodes, against sequences
// derived by hand from the paper's listing. Shares of boxes that are seen become biases by s = 1, t
// = 0.5: 1 -> 1, 0.75 -> 0.875, 0.5 -> 0.5, 0.25 -> 0.125.
#include "tests/hlod/strategies/seven_nodes.h"

#include <algorithm>

namespace pagoda::hlod {
namespace {

using test::Events;
using test::SevenNodes;

const Events kStopAtRoot = {"query R", "draw R", "wait R"};

TEST_F(SevenNodes, ANewNodeWaitsForItsAnswerAndIsDrawnLate) {
    EXPECT_EQ(frame(9, {{"R", {1}}}), (Events{"query R", "wait R", "draw R"}));
    EXPECT_EQ(record_.predictions.delay, 1u);
    EXPECT_EQ(record_.predictions.delayVisible, 1u);
    EXPECT_EQ(record_.delayedNodes, 1u);
    EXPECT_EQ(record_.waits, 1u);
    EXPECT_EQ(record_.visitedNodes, 1u);
}

TEST_F(SevenNodes, AVisibleStopIsDrawnAtOnceAndItsAnswerDrawsNothingTwice) {
    frame(9, {{"R", {1}}});
    EXPECT_EQ(frame(9, {{"R", {1}}}), kStopAtRoot);
    EXPECT_EQ(record_.predictions.stop, 1u);
    EXPECT_EQ(record_.delayedNodes, 0u);
    EXPECT_EQ(record_.rarnNodes, 0u);
    EXPECT_EQ(record_.waits, 1u);
}

TEST_F(SevenNodes, AWrongStopHasItsChildrenDrawnOverItAndCountsOnce) {
    frame(5, {{"R", {0.5}}});  // 0.5 x 8 <= 5
    EXPECT_EQ(frame(5, {{"R", {1}}, {"A", {1}}, {"B", {1}}}),
              (Events{"query R", "draw R", "wait R", "refine R", "query A", "query B", "wait A",
                      "draw A", "wait B", "draw B"}));
    EXPECT_EQ(record_.rarnNodes, 1u);
    EXPECT_EQ(record_.delayedNodes, 2u);
    // Its children stop now: it is refined at once, for 1 x 8 is more than 5.
    EXPECT_EQ(frame(5, {{"A", {1}}, {"B", {1}}}),
              (Events{"refine R", "query A", "draw A", "query B", "draw B", "wait A", "wait B"}));
    EXPECT_EQ(record_.rarnNodes, 0u);
}

TEST_F(SevenNodes, AStopWhoseRememberedBiasNoLongerDoesIsRefinedUnasked) {
    frame(9, {{"R", {1}}});
    EXPECT_EQ(frame(5, {{"A", {1}}, {"B", {1}}}),
              (Events{"refine R", "query A", "query B", "wait A", "draw A", "wait B", "draw B"}));
    EXPECT_EQ(record_.predictions.refine, 1u);
    EXPECT_EQ(record_.predictions.delay, 2u);
}

TEST_F(SevenNodes, WhatIsHiddenIsCulledAndWaitsInTheNextFrame) {
    frame(5, {{"R", {1}}, {"A", {1}}, {"B", {0}}});
    // B counts 0 in the mean of both, so R is asked too: 0.5 x 8 would do, 1 x 8 does not. B waits
    // and is hidden: not drawn, and nothing below it is asked.
    EXPECT_EQ(frame(5, {{"R", {1}}, {"A", {0}}, {"B", {0}}}),
              (Events{"query R", "wait R", "refine R", "query A", "draw A", "query B", "wait A",
                      "wait B", "hide B"}));
    EXPECT_EQ(record_.predictions.stopHidden, 1u);  // A was drawn in vain
    EXPECT_EQ(record_.predictions.delayHidden, 1u);
    EXPECT_EQ(record_.delayedNodes, 0u);
    EXPECT_EQ(record_.rarnNodes, 0u);
}

TEST_F(SevenNodes, WhatIsHiddenBelowANodePullsItUpToBeTestedItself) {
    frame(3, {{"R", {1}}, {"A", {1}}, {"A1", {1}}, {"A2", {1}}, {"B", {0.5}}});
    EXPECT_EQ(frame(3, {{"A1", {0}}, {"A2", {0}}, {"B", {0.5}}}),
              (Events{"refine R", "refine A", "query A1", "draw A1", "query A2", "draw A2",
                      "query B", "draw B", "wait A1", "wait A2", "wait B"}));
    // R is seen through B; A through nothing: it is asked about, its children are not.
    const Events events = frame(3, {{"R", {1}}, {"A", {0}}, {"B", {0.5}}});
    EXPECT_EQ(std::count(events.begin(), events.end(), "query A"), 1);
    EXPECT_EQ(std::count(events.begin(), events.end(), "hide A"), 1);
    EXPECT_EQ(std::count(events.begin(), events.end(), "query A1"), 0);
    EXPECT_EQ(std::count(events.begin(), events.end(), "draw A"), 0);
}

TEST_F(SevenNodes, InvisibilityIsPulledUpALevelAFrame) {
    frame(3, {{"R", {1}}, {"A", {1}}, {"A1", {1}}, {"A2", {1}}, {"B", {0}}});
    frame(3, {{"A1", {0}}, {"A2", {0}}, {"B", {0}}});
    EXPECT_EQ(frame(3, {{"R", {0}}}), (Events{"query R", "wait R", "hide R"}));
    EXPECT_EQ(record_.hiddenNodes, 0u);  // counted by who runs the frame
    EXPECT_EQ(record_.delayedNodes, 0u);
}

TEST_F(SevenNodes, TheCutRisesOnlyWhenTheMeanBiasOfChildrenAllowsIt) {
    const Events held = {"refine R", "query A", "draw A", "query B", "draw B", "wait A", "wait B"};
    frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {1}}});
    EXPECT_EQ(frame(4.5, {{"A", {1}}, {"B", {0.5}}}), held);
    // (1 + 0.5) / 2 x 8 = 6.
    EXPECT_EQ(frame(5.9, {{"A", {1}}, {"B", {0.5}}}), held);
    EXPECT_EQ(frame(6.1, {{"R", {0.5}}}), (Events{"query R", "wait R", "draw R"}));
    EXPECT_EQ(record_.delayedNodes, 1u);
}

TEST_F(SevenNodes, AHiddenChildWeighsNothingAndOneOutOfSightDoesNotCount) {
    frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {0}}});
    // (1 + 0) / 2 x 8 = 4 <= 4.5: it would rise, were it not for its own answer.
    EXPECT_EQ(frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {0}}}),
              (Events{"query R", "wait R", "refine R", "query A", "draw A", "query B", "wait A",
                      "wait B", "hide B"}));
    // With B out of sight the mean is A's alone: 1 x 8.
    frame(withoutB(), 4.5, {{"R", {1}}, {"A", {1}}});
    EXPECT_EQ(record_.culledNodes, 1u);
    EXPECT_EQ(frame(withoutB(), 4.5, {{"A", {1}}}),
              (Events{"refine R", "query A", "draw A", "wait A"}));
}

TEST_F(SevenNodes, TheCutDoesNotRiseWhileAChildIsRefinedOrWouldBe) {
    frame(3, {{"R", {1}}, {"A", {0.5}}, {"B", {1}}, {"B1", {0.25}}, {"B2", {0.25}}});
    // The mean bias of A and B would do at 7, but B was refined; it rises itself: 0.125 x 4.
    EXPECT_EQ(frame(7, {{"A", {0.5}}, {"B", {1}}}),
              (Events{"refine R", "query A", "draw A", "query B", "wait A", "wait B", "draw B"}));
    // Now both stop; (0.5 + 1) / 2 x 8 = 6, and A's or B's own estimates allow it.
    EXPECT_EQ(frame(7, {{"R", {0.5}}}), (Events{"query R", "wait R", "draw R"}));
}

TEST_F(SevenNodes, TheCutSinksWithoutLimitInOneFrame) {
    frame(9, {{"R", {1}}});
    EXPECT_EQ(
        frame(1, {{"A", {1}}, {"A1", {1}}, {"A2", {1}}, {"B", {1}}, {"B1", {1}}, {"B2", {1}}}),
        (Events{"refine R", "query A", "query B", "wait A", "refine A", "query A1", "query A2",
                "wait B", "refine B", "query B1", "query B2", "wait A1", "draw A1", "wait A2",
                "draw A2", "wait B1", "draw B1", "wait B2", "draw B2"}));
    EXPECT_EQ(record_.delayedNodes, 4u);  // A and B were delayed too, but did not stop
    EXPECT_EQ(record_.predictions.delayVisible, 6u);
    EXPECT_EQ(record_.waits, 6u);
}

TEST_F(SevenNodes, WhatComesBackIntoTheFrustumWaits) {
    frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {1}}});
    EXPECT_EQ(frame(withoutB(), 4.5, {{"A", {1}}}),
              (Events{"refine R", "query A", "draw A", "wait A"}));
    EXPECT_EQ(frame(4.5, {{"A", {1}}, {"B", {1}}}),
              (Events{"refine R", "query A", "draw A", "query B", "wait A", "wait B", "draw B"}));
    EXPECT_EQ(record_.delayedNodes, 1u);
}

TEST_F(SevenNodes, LeavesStopWhateverIsAsked) {
    const std::map<std::string, Seen> all = {{"R", {1}},  {"A", {1}},  {"B", {1}}, {"A1", {1}},
                                             {"A2", {1}}, {"B1", {1}}, {"B2", {1}}};
    for (int i = 0; i < 3; ++i) {
        Events drawn;
        for (const std::string& event : frame(i == 2 ? 0.0 : 1e-6, all)) {
            if (event.starts_with("draw")) drawn.push_back(event);
        }
        EXPECT_EQ(drawn, (Events{"draw A1", "draw A2", "draw B1", "draw B2"}));
        EXPECT_EQ(record_.delayedNodes, i == 0 ? 4u : 0u);
        EXPECT_EQ(record_.rarnNodes, 0u);
    }
}

TEST_F(SevenNodes, AnswersThatAreThereAreTakenBetweenVisits) {
    // A's is there before B is visited: its children are nearer, and come first.
    EXPECT_EQ(frame(3, {{"R", {1, 0}}, {"A", {1, 0}}, {"A1", {1}}, {"A2", {1}}, {"B", {0.5}}}),
              (Events{"query R", "refine R", "query A", "refine A", "query A1", "query A2",
                      "query B", "wait A1", "draw A1", "wait A2", "draw A2", "wait B", "draw B"}));
    EXPECT_EQ(record_.waits, 3u);
}

TEST_F(SevenNodes, AnswersAreTakenOldestFirst) {
    // B's is there at once, but A's is asked for first, and not there until it is waited for.
    EXPECT_EQ(frame(4.5, {{"R", {1, 0}}, {"A", {1}}, {"B", {1, 0}}}),
              (Events{"query R", "refine R", "query A", "query B", "wait A", "draw A", "draw B"}));
    EXPECT_EQ(record_.waits, 1u);
}

TEST_F(SevenNodes, NothingIsWaitedForWhileThereIsSomethingToVisit) {
    frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {1}}});
    // A's answer comes at the second poll: after B's visit.
    EXPECT_EQ(frame(4.5, {{"A", {1, 1}}, {"B", {1, 0}}}),
              (Events{"refine R", "query A", "draw A", "query B", "draw B"}));
    EXPECT_EQ(record_.waits, 0u);
}

}  // namespace
}  // namespace pagoda::hlod
