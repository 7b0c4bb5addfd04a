// What the coherent traversal can do beyond the paper, frame by frame on seven nodes, against
// sequences derived by hand.
#include "tests/hlod/strategies/seven_nodes.h"

#include <algorithm>

namespace pagoda::hlod {
namespace {

using test::Events;

class CoherentOptions : public test::SevenNodes {
protected:
    void use(void (*change)(StrategyOptions&)) {
        StrategyOptions options = kPaperOptions;
        change(options);
        strategy_ = makeStrategy("coh", options);
    }
    static int64_t count(const Events& events, const char* event) {
        return std::count(events.begin(), events.end(), event);
    }
    // A and B are refined; A1 and B1 are seen whole, of A2 and B2 nothing.
    static std::map<std::string, Seen> halves() {
        return {{"R", {1}}, {"A", {1}},  {"A1", {1}}, {"A2", {0}},
                {"B", {1}}, {"B1", {1}}, {"B2", {0}}};
    }
};

TEST_F(CoherentOptions, WhatWasSeenIsAskedAboutOnceInNFramesAndDrawnInAll) {
    use([](StrategyOptions& options) { options.retestEvery = 3; });
    frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {1}}});
    for (int cycle = 0; cycle < 4; ++cycle) {
        int64_t asked[2] = {};
        for (int i = 0; i < 3; ++i) {
            const Events events = frame(4.5, {{"A", {1}}, {"B", {1}}});
            asked[0] += count(events, "query A");
            asked[1] += count(events, "query B");
            EXPECT_EQ(count(events, "draw A"), 1);
            EXPECT_EQ(count(events, "draw B"), 1);
        }
        EXPECT_EQ(asked[0], 1);
        EXPECT_EQ(asked[1], 1);
    }
}

TEST_F(CoherentOptions, WhatIsHiddenIsCulledWithinNFrames) {
    use([](StrategyOptions& options) { options.retestEvery = 3; });
    frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {1}}});
    int64_t drawn = 0;
    Events events;
    for (int i = 0; i < 4; ++i) {
        events = frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {0}}});
        drawn += count(events, "draw B");
    }
    EXPECT_GE(drawn, 1);
    EXPECT_LE(drawn, 3);
    // Hidden, it is asked about in every frame.
    EXPECT_EQ(count(events, "query B"), 1);
    EXPECT_EQ(count(events, "hide B"), 1);
}

TEST_F(CoherentOptions, InAStillViewAllIsAskedAbout) {
    use([](StrategyOptions& options) { options.retestEvery = 1000; });
    frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {1}}});
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(
            frame(lookingAhead(), 4.5, {{"A", {1}}, {"B", {1}}}, true),
            (Events{"refine R", "query A", "draw A", "query B", "draw B", "wait A", "wait B"}));
    }
}

TEST_F(CoherentOptions, WhatWasHiddenForFourFramesIsAskedAboutTogether) {
    use([](StrategyOptions& options) { options.hiddenBatch = 2; });
    for (int i = 0; i < 4; ++i) {
        const Events events = frame(3.5, halves());
        EXPECT_EQ(count(events, "query A2"), 1) << i;
        EXPECT_EQ(count(events, "query B2"), 1) << i;
    }
    EXPECT_EQ(frame(3.5, halves()),
              (Events{"refine R", "query A", "query B", "wait A", "refine A", "query A1", "draw A1",
                      "wait B", "refine B", "query B1", "draw B1", "query A2+B2", "wait A1",
                      "wait B1", "wait A2+B2", "hide A2", "hide B2"}));
    EXPECT_EQ(record_.predictions.delayHidden, 2u);
}

TEST_F(CoherentOptions, OneOfABatchThatIsSeenHasAllAskedAboutByThemselves) {
    use([](StrategyOptions& options) { options.hiddenBatch = 2; });
    for (int i = 0; i < 4; ++i) frame(3.5, halves());
    auto seen = halves();
    seen["B2"] = {1};
    const Events events = frame(3.5, seen);
    ASSERT_GE(events.size(), 7u);
    EXPECT_EQ(
        Events(events.end() - 7, events.end()),
        (Events{"wait A2+B2", "query A2", "query B2", "wait A2", "hide A2", "wait B2", "draw B2"}));
    // It stops, and A2 has only itself to be asked with: alone.
    const Events next = frame(3.5, seen);
    EXPECT_EQ(count(next, "query A2"), 1);
    EXPECT_EQ(count(next, "query B2"), 1);
    EXPECT_EQ(count(next, "hide A2"), 1);
    EXPECT_EQ(count(next, "draw B2"), 1);
}

TEST_F(CoherentOptions, ABatchThatIsNotFullIsAskedAboutLastOfAll) {
    use([](StrategyOptions& options) { options.hiddenBatch = 100; });
    for (int i = 0; i < 4; ++i) frame(3.5, halves());
    const Events events = frame(3.5, halves());
    ASSERT_GE(events.size(), 4u);
    EXPECT_EQ(Events(events.end() - 4, events.end()),
              (Events{"query A2+B2", "wait A2+B2", "hide A2", "hide B2"}));
    EXPECT_EQ(events[events.size() - 5], "wait B1");
}

TEST_F(CoherentOptions, TheCutRisesOnlyBelowTauByItsShare) {
    use([](StrategyOptions& options) { options.hysteresis = 0.1; });
    frame(4.5, {{"R", {1}}, {"A", {1}}, {"B", {0.5}}});
    // (1 + 0.5) / 2 x 8 = 6, and a tenth of it more.
    EXPECT_EQ(frame(6.5, {{"A", {1}}, {"B", {0.5}}}),
              (Events{"refine R", "query A", "draw A", "query B", "draw B", "wait A", "wait B"}));
    EXPECT_EQ(record_.risenNodes, 0u);
    EXPECT_EQ(frame(6.7, {{"R", {0.5}}}), (Events{"query R", "wait R", "draw R"}));
    EXPECT_EQ(record_.risenNodes, 1u);
    frame(6.7, {{"R", {0.5}}});
    EXPECT_EQ(record_.risenNodes, 0u);
}

}  // namespace
}  // namespace pagoda::hlod
