// What fails is tried again, and whoever waits is told the truth.
#include "cache/request_queue.h"

#include "tests/cache/scripted_world.h"

#include <gtest/gtest.h>

namespace pagoda::cache {
namespace {

using test::ScriptedLoads;

struct Retrying {
    Retrying() { node.vertexCount = 10; }
    // A frame that asks for node 1 (and what else), if `isAsked`; true when it was sent.
    bool frame(bool isAsked = true) {
        const size_t before = loads.reads.size();
        requests.beginFrame();
        if (isAsked) requests.ask({{0, false, 1}, {0, 10}, 1.0, false, node});
        requests.send([](const Request&) { return true; });
        return loads.reads.size() > before;
    }
    std::vector<RequestQueue::Arrival> collect() {
        std::vector<RequestQueue::Arrival> arrivals;
        requests.collect(arrivals);
        return arrivals;
    }
    // Sent, and failed at once.
    void failOnce() {
        ASSERT_TRUE(frame());
        ASSERT_EQ(collect().size(), 1u);
    }
    ooc::NodeRecord node{.id = ooc::NodeId{1}};
    ManualClock clock;
    ScriptedLoads loads;
    RequestQueue requests{loads, clock, {.attempts = 4, .firstPauseS = 0.5}};
};

TEST(RequestRetry, PausesDoubleAndTheLastFailureIsAFault) {
    Retrying queue;
    queue.loads.failing = {1};
    double timeS = 0;
    for (const double pauseS : {0.5, 1.0, 2.0}) {
        ASSERT_TRUE(queue.frame()) << "at " << timeS;
        const auto arrivals = queue.collect();
        ASSERT_EQ(arrivals.size(), 1u);  // what was reserved for it is given back
        EXPECT_FALSE(arrivals[0].result.page.has_value());
        EXPECT_EQ(arrivals[0].result.fault, "");
        EXPECT_TRUE(queue.requests.isAsked({0, false, 1}));
        timeS += pauseS;
        queue.clock.waitUntil(timeS - 0.001);
        ASSERT_FALSE(queue.frame());
        queue.clock.waitUntil(timeS);
    }
    ASSERT_TRUE(queue.frame());
    const auto arrivals = queue.collect();
    ASSERT_EQ(arrivals.size(), 1u);
    EXPECT_EQ(arrivals[0].result.fault, "scripted fault");
    EXPECT_FALSE(queue.requests.isAsked({0, false, 1}));
    EXPECT_EQ(queue.requests.counters().retried, 3u);
    EXPECT_EQ(queue.requests.counters().failed, 1u);
    EXPECT_EQ(queue.requests.counters().sent, 4u);
}

TEST(RequestRetry, AReadThatWorksTheSecondTimeIsNoFault) {
    Retrying queue;
    queue.loads.failing = {1};
    queue.failOnce();
    queue.loads.failing.clear();
    queue.clock.advance(0.5);
    ASSERT_TRUE(queue.frame());
    EXPECT_TRUE(queue.collect().at(0).result.page.has_value());
    EXPECT_EQ(queue.requests.counters().failed, 0u);
}

TEST(RequestRetry, FailuresAreRememberedThroughThePauseAndNoLonger) {
    Retrying queue;
    queue.loads.failing = {1};
    queue.failOnce();
    queue.clock.advance(0.25);
    ASSERT_FALSE(queue.frame(false));  // nobody asks, but the pause has not ended
    EXPECT_TRUE(queue.requests.isAsked({0, false, 1}));
    queue.clock.advance(0.25);
    ASSERT_TRUE(queue.frame());
    ASSERT_EQ(queue.collect().size(), 1u);
    queue.clock.advance(0.75);
    ASSERT_FALSE(queue.frame());  // the second pause: 1 s
    queue.clock.advance(0.25);
    ASSERT_FALSE(queue.frame(false));
    EXPECT_FALSE(queue.requests.isAsked({0, false, 1}));
    EXPECT_EQ(queue.requests.counters().cancelled, 1u);
}

TEST(RequestRetry, AFailureThatGivesNoReasonIsAFaultAllTheSame) {
    Retrying queue;
    queue.loads.empty = {1};
    for (int i = 0; i < 3; ++i) {
        queue.failOnce();
        queue.clock.advance(10);
    }
    ASSERT_TRUE(queue.frame());
    EXPECT_FALSE(queue.collect().at(0).result.fault.empty());
}

TEST(RequestRetry, WaitingEndsWithAnArrivalOrAPauseAndIsFalseWhenNothingIsOnItsWay) {
    Retrying queue;
    EXPECT_FALSE(queue.requests.waitForArrival());
    queue.loads.failing = {1};
    ASSERT_TRUE(queue.frame());
    EXPECT_TRUE(queue.requests.waitForArrival());
    ASSERT_EQ(queue.collect().size(), 1u);
    EXPECT_TRUE(queue.requests.waitForArrival());
    EXPECT_DOUBLE_EQ(queue.clock.nowS(), 0.5);
    EXPECT_FALSE(queue.requests.waitForArrival());  // the pause has ended: send() goes on
    ASSERT_TRUE(queue.frame());
    queue.collect();
    EXPECT_FALSE(queue.frame(false));
    EXPECT_FALSE(queue.requests.waitForArrival());  // nobody asks for it any more
    EXPECT_DOUBLE_EQ(queue.clock.nowS(), 0.5);
}

TEST(RequestRetry, WhatNeverArrivesBlocksNeitherWaitingNorPauses) {
    Retrying queue;
    queue.loads.failing = {1};
    queue.failOnce();
    queue.loads.hold();
    queue.requests.beginFrame();
    queue.requests.ask({{0, false, 1}, {0, 10}, 1.0, false, queue.node});
    queue.requests.ask({{0, false, 2}, {100, 10}, 1.0, false, queue.node});
    queue.requests.send([](const Request&) { return true; });
    ASSERT_EQ(queue.requests.sentCount(), 1u);  // node 2, which never comes
    EXPECT_TRUE(queue.requests.waitForArrival());
    EXPECT_DOUBLE_EQ(queue.clock.nowS(), 0.5);
    EXPECT_FALSE(queue.requests.waitForArrival());
}

}  // namespace
}  // namespace pagoda::cache
