#include "cache/disk_loads.h"

#include "ooc/base/error.h"
#include "tests/cache/scripted_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

namespace pagoda::cache {
namespace {

using test::ScriptedLoads;

struct Disk {
    explicit Disk(const DiskProfile& profile) {
        auto scripted = std::make_unique<ScriptedLoads>();
        inner = scripted.get();
        loads = std::make_unique<DiskLoads>(std::move(scripted), profile, clock);
    }
    void send(uint64_t ticket, uint64_t offset, uint64_t bytes) {
        loads->send({item(ticket, offset, bytes)});
    }
    static LoadItem item(uint64_t ticket, uint64_t offset, uint64_t bytes) {
        LoadItem made;
        made.ticket = ticket;
        made.range = {offset, bytes};
        made.node.id = ooc::NodeId{ticket};
        made.node.vertexCount = 3;
        return made;
    }
    // Plays until nothing is on its way: when each ticket came (< 0: as a fault).
    std::map<uint64_t, double> arrivalsS() {
        std::map<uint64_t, double> times;
        while (loads->waitForArrival()) {
            std::vector<LoadResult> arrived;
            loads->collect(arrived);
            EXPECT_FALSE(arrived.empty());
            for (const LoadResult& result : arrived) {
                EXPECT_NE(result.page.has_value(), !result.fault.empty());
                times[result.ticket] = result.page ? clock.nowS() : -clock.nowS();
            }
        }
        return times;
    }
    ManualClock clock;
    ScriptedLoads* inner = nullptr;
    std::unique_ptr<DiskLoads> loads;
};

void expectTimes(const std::map<uint64_t, double>& times,
                 const std::map<uint64_t, double>& expected) {
    ASSERT_EQ(times.size(), expected.size());
    for (const auto& [ticket, timeS] : expected) {
        EXPECT_NEAR(times.at(ticket), timeS, 1e-9) << "ticket " << ticket;
    }
}

TEST(DiskLoads, AnotherProfileHoldsForWhatIsSentFromNowOn) {
    Disk disk({.bytesPerS = 1000, .latencyS = 0.1});
    disk.send(1, 0, 900);  // 0.1 + 0.9
    disk.clock.advance(0.2);
    disk.loads->setProfile({.bytesPerS = 2000, .latencyS = 0.05});
    disk.send(2, 5000, 100);  // 0.2 + 0.05 + 0.05: it does not wait for the slow one
    disk.clock.advance(0.01);
    disk.loads->setProfile({});
    disk.send(3, 9000, 500);
    expectTimes(disk.arrivalsS(), {{1, 1.0}, {2, 0.3}, {3, 0.21}});
}

TEST(DiskLoads, LatenciesOverlapAndTransfersShareOneLine) {
    Disk disk({.bytesPerS = 1000, .latencyS = 0.1});
    disk.send(1, 0, 200);     // 0.1 + 0.2
    disk.send(2, 5000, 100);  // its latency has passed when the line is free: 0.3 + 0.1
    disk.clock.advance(0.25);
    disk.send(3, 9000, 500);  // 0.25 + 0.1 < 0.4: 0.4 + 0.5
    expectTimes(disk.arrivalsS(), {{1, 0.3}, {2, 0.4}, {3, 0.9}});
    EXPECT_EQ(disk.loads->counters().reads, 3u);
    EXPECT_EQ(disk.loads->counters().bytes, 800u);
}

TEST(DiskLoads, NothingIsGivenBeforeItsTimeAndWaitingMovesTheClock) {
    Disk disk({.bytesPerS = 1000, .latencyS = 0.1});
    disk.send(1, 0, 200);
    std::vector<LoadResult> arrived;
    disk.clock.advance(0.299);
    disk.loads->collect(arrived);
    EXPECT_TRUE(arrived.empty());
    EXPECT_EQ(disk.loads->readsInFlight(), 1u);
    EXPECT_TRUE(disk.loads->waitForArrival());
    EXPECT_NEAR(disk.clock.nowS(), 0.3, 1e-9);
    disk.loads->collect(arrived);
    EXPECT_EQ(arrived.size(), 1u);
    EXPECT_EQ(disk.loads->readsInFlight(), 0u);
    EXPECT_FALSE(disk.loads->waitForArrival());
}

TEST(DiskLoads, AJoinedReadTransfersItsGapsAndArrivesWhole) {
    Disk disk({.bytesPerS = 1000, .latencyS = 0.5});
    disk.loads->send({Disk::item(1, 100, 100), Disk::item(2, 250, 50), Disk::item(3, 300, 100)});
    expectTimes(disk.arrivalsS(), {{1, 0.8}, {2, 0.8}, {3, 0.8}});
    EXPECT_EQ(disk.loads->counters().bytes, 300u);
}

TEST(DiskLoads, WithoutABandwidthOnlyLatencyCountsAndAsItIsNothing) {
    Disk far({.latencyS = 0.04});
    far.send(1, 0, 1 << 30);
    far.send(2, 0, 1);
    expectTimes(far.arrivalsS(), {{1, 0.04}, {2, 0.04}});
    Disk near{DiskProfile{}};
    near.send(1, 0, 1 << 30);
    expectTimes(near.arrivalsS(), {{1, 0.0}});
}

TEST(DiskLoads, AShortReadWaitsOutAnotherLatency) {
    Disk disk({.bytesPerS = 1000, .latencyS = 0.1, .shortShare = 1});
    disk.send(1, 0, 200);
    disk.send(2, 500, 100);
    expectTimes(disk.arrivalsS(), {{1, 0.4}, {2, 0.5}});
    EXPECT_EQ(disk.loads->counters().shortReads, 2u);
}

TEST(DiskLoads, AFailedReadAnswersAfterItsLatencyTransfersNothingAndIsNeverReallyRead) {
    Disk disk({.bytesPerS = 1000, .latencyS = 0.1, .failShare = 1});
    disk.send(1, 0, 200);
    disk.loads->send({Disk::item(2, 500, 100), Disk::item(3, 600, 100)});
    expectTimes(disk.arrivalsS(), {{1, -0.1}, {2, -0.1}, {3, -0.1}});
    EXPECT_EQ(disk.loads->counters().failedReads, 2u);
    EXPECT_EQ(disk.loads->counters().bytes, 0u);
    EXPECT_TRUE(disk.inner->reads.empty());
}

TEST(DiskLoads, FailuresTakeTheirShareAndTheSameScenarioGivesTheSameArrivals) {
    const auto play = [](uint64_t seed) {
        Disk disk({.bytesPerS = 1e6,
                   .latencyS = 0.01,
                   .failShare = 0.2,
                   .shortShare = 0.1,
                   .seed = seed});
        std::map<uint64_t, double> all;
        for (uint64_t ticket = 1; ticket <= 2000; ++ticket) {
            disk.send(ticket, ticket * 1000, 1 + ticket % 700);
            if (ticket % 20 == 0) all.merge(disk.arrivalsS());
        }
        EXPECT_NEAR(static_cast<double>(disk.loads->counters().failedReads), 400, 60);
        EXPECT_NEAR(static_cast<double>(disk.loads->counters().shortReads), 200, 45);
        return all;
    };
    const auto first = play(1);
    EXPECT_EQ(first.size(), 2000u);
    EXPECT_EQ(first, play(1));
    EXPECT_NE(first, play(2));
}

TEST(DiskLoads, FaultsOfTheInnerQueueComeThrough) {
    Disk disk({.latencyS = 0.1});
    disk.inner->failing = {2};
    disk.send(1, 0, 10);
    disk.send(2, 50, 10);
    expectTimes(disk.arrivalsS(), {{1, 0.1}, {2, -0.1}});
}

TEST(DiskLoads, AReadThatTheInnerQueueHasLostDoesNotKeepWaitersForEver) {
    Disk disk({.latencyS = 0.1});
    disk.inner->hold();
    disk.send(1, 0, 10);
    EXPECT_FALSE(disk.loads->waitForArrival());
    std::vector<LoadResult> arrived;
    disk.loads->collect(arrived);
    EXPECT_TRUE(arrived.empty());
    disk.inner->letGo();
    EXPECT_TRUE(disk.loads->waitForArrival());
    disk.loads->collect(arrived);
    EXPECT_EQ(arrived.size(), 1u);
}

// Time that goes on by itself, but is driven by hand here.
class HandClock final : public Clock {
public:
    double nowS() const override { return timeS; }
    void waitUntil(double untilS) override { timeS = std::max(timeS, untilS); }
    bool isManual() const override { return false; }
    double timeS = 0;
};

TEST(DiskLoads, InRealTimeCollectingNeverWaitsForDecodingButWaitingDoes) {
    HandClock clock;
    auto scripted = std::make_unique<ScriptedLoads>();
    ScriptedLoads& inner = *scripted;
    DiskLoads loads(std::move(scripted), {.latencyS = 0.1}, clock);
    inner.hold();
    loads.send({Disk::item(1, 0, 10), Disk::item(2, 10, 10)});
    loads.send({Disk::item(3, 500, 10)});
    clock.timeS = 0.05;
    inner.answer(1);  // the second read is decoded first, and before its time
    std::vector<LoadResult> arrived;
    loads.collect(arrived);
    EXPECT_TRUE(arrived.empty());
    clock.timeS = 1;
    loads.collect(arrived);
    EXPECT_TRUE(arrived.empty());  // due, but the first read is not decoded
    inner.letGo();
    EXPECT_TRUE(loads.waitForArrival());
    loads.collect(arrived);
    ASSERT_EQ(arrived.size(), 3u);
    EXPECT_EQ(arrived[0].ticket, 1u);
    EXPECT_EQ(arrived[2].ticket, 3u);
    EXPECT_FALSE(loads.waitForArrival());
}

TEST(DiskProfile, IsReadFromText) {
    EXPECT_TRUE(parseDiskProfile("as-is").isAsIs());
    const DiskProfile disk = parseDiskProfile("100MB/s,10ms,fail=1%,short=2.5%");
    EXPECT_DOUBLE_EQ(disk.bytesPerS, 100e6);
    EXPECT_DOUBLE_EQ(disk.latencyS, 0.01);
    EXPECT_DOUBLE_EQ(disk.failShare, 0.01);
    EXPECT_DOUBLE_EQ(disk.shortShare, 0.025);
    EXPECT_DOUBLE_EQ(parseDiskProfile("50Mbit/s").bytesPerS, 6.25e6);
    EXPECT_DOUBLE_EQ(parseDiskProfile("0.5ms").latencyS, 0.0005);
    EXPECT_TRUE(parseDiskProfile("0ms").isAsIs());
}

TEST(DiskProfile, RefusesWhatItDoesNotKnowByName) {
    for (const char* text :
         {"",         ",",        "10ms,",        ",10ms",        "as-is,10ms", "As-is",
          "fast",     "100",      "100MB",        "100mb/s",      "10 ms",      "-1ms",
          "nanms",    "infMB/s",  "1e999ms",      "fail=1",       "fail=%",     "fail=101%",
          "fail=-1%", "short=x%", "latency=10ms", "10ms;fail=1%", "0MB/s",      "0Mbit/s"}) {
        try {
            static_cast<void>(parseDiskProfile(text));
            ADD_FAILURE() << "'" << text << "' was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.path(), "--disk") << text;
            EXPECT_FALSE(error.problem().empty()) << text;
        }
    }
}

}  // namespace
}  // namespace pagoda::cache
