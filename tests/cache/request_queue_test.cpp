// What is sent, in which order, and joined how. Retries and waiting: request_retry_test.cpp.
#include "cache/request_queue.h"

#include "tests/cache/scripted_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace pagoda::cache {
namespace {

using test::ScriptedLoads;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr uint64_t kMany = 1000;  // reads in flight: no bound

Request page(uint64_t id, double priority, uint64_t offset, uint64_t bytes = 10) {
    Request request{{0, false, id}, {offset, bytes}, priority, false, {}};
    request.node.id = ooc::NodeId{id};
    return request;
}
Request block(uint64_t number, double priority, uint64_t offset, uint64_t bytes = 10) {
    return {{0, true, number}, {offset, bytes}, priority, false, {}};
}
Request prefetched(Request request) {
    request.isPrefetch = true;
    return request;
}

struct Queue {
    explicit Queue(const RequestQueue::Limits& limits) : requests(loads, clock, limits) {}
    // A new frame that asks for these and sends what it may.
    void frame(const std::vector<Request>& asked) {
        requests.beginFrame();
        for (const Request& request : asked) requests.ask(request);
        send();
    }
    void send() {
        requests.send([this](const Request& request) {
            if (refused.contains(request.key)) return false;
            admitted.push_back(request.key.id);
            return true;
        });
    }
    std::vector<RequestQueue::Arrival> collect() {
        std::vector<RequestQueue::Arrival> arrivals;
        requests.collect(arrivals);
        return arrivals;
    }
    [[nodiscard]] std::vector<std::vector<uint64_t>> reads() const {
        std::vector<std::vector<uint64_t>> ids;
        for (const auto& read : loads.reads) {
            ids.emplace_back();
            for (const LoadItem& item : read) {
                ids.back().push_back(item.isBlock ? item.block : item.node.id.value);
            }
        }
        return ids;
    }
    ManualClock clock;
    ScriptedLoads loads;
    RequestQueue requests;
    std::set<RequestKey> refused;
    std::vector<uint64_t> admitted;
};

using Reads = std::vector<std::vector<uint64_t>>;
constexpr RequestQueue::Limits kAlone{.readsInFlight = kMany, .joinGapBytes = 0, .readBytes = 1};

TEST(RequestQueue, SendsTheBestFirstBlocksBeforePagesAndPrefetchedLast) {
    Queue queue(kAlone);
    queue.frame({page(1, 5, 0), prefetched(page(2, 99, 100)), page(3, 7, 200), block(4, 1, 300),
                 block(5, 2, 400), page(6, 7, 500)});
    // Of equals the smaller id: coarser nodes come first.
    EXPECT_EQ(queue.reads(), (Reads{{5}, {4}, {3}, {6}, {1}}));
    queue.collect();
    queue.frame({prefetched(page(2, 99, 100)), prefetched(page(7, 100, 600))});
    EXPECT_EQ(queue.reads().at(5), std::vector<uint64_t>{7});
    EXPECT_EQ(queue.reads().at(6), std::vector<uint64_t>{2});
}

TEST(RequestQueue, SendsWhileReadsAreFreeAndGoesOnWithTheBestWhenOneIsBack) {
    auto limits = kAlone;
    limits.readsInFlight = 2;
    Queue queue(limits);
    queue.loads.hold();
    const std::vector<Request> asked{page(1, 1, 0), page(2, 2, 100), page(3, 3, 200),
                                     page(4, 4, 300)};
    queue.frame(asked);
    EXPECT_EQ(queue.reads(), (Reads{{4}, {3}}));
    queue.frame(asked);
    EXPECT_EQ(queue.loads.reads.size(), 2u);
    queue.loads.answer(1);
    EXPECT_EQ(queue.collect().size(), 1u);
    queue.frame({page(1, 9, 0), page(2, 2, 100), page(4, 4, 300)});  // ranked anew
    EXPECT_EQ(queue.reads().back(), std::vector<uint64_t>{1});
}

TEST(RequestQueue, WithinAFrameTheGreatestPriorityHoldsAndAWantBeatsAPrefetch) {
    Queue queue(kAlone);
    queue.requests.beginFrame();
    EXPECT_TRUE(queue.requests.ask(page(1, 5, 0)));
    EXPECT_FALSE(queue.requests.ask(page(1, 8, 0)));
    EXPECT_FALSE(queue.requests.ask(page(1, 2, 0)));
    EXPECT_FALSE(queue.requests.ask(prefetched(page(1, 100, 0))));
    EXPECT_FALSE(queue.requests.ask(prefetched(page(2, 100, 100))));
    EXPECT_TRUE(queue.requests.ask(page(2, 7, 100)));
    EXPECT_FALSE(queue.requests.ask(page(2, 7, 100)));
    EXPECT_TRUE(queue.requests.ask(page(3, 6, 200)));
    EXPECT_EQ(queue.requests.counters().asked, 3u);
    queue.send();
    EXPECT_EQ(queue.reads(), (Reads{{1}, {2}, {3}}));
    queue.requests.beginFrame();  // the next frame, all of it sent: wanted once more
    EXPECT_FALSE(queue.requests.ask(prefetched(page(1, 1, 0))));
    EXPECT_TRUE(queue.requests.ask(page(1, 1, 0)));
    EXPECT_FALSE(queue.requests.ask(page(1, 1, 0)));
}

TEST(RequestQueue, PrefetchesOnlyWhileFewReadsAreInFlight) {
    auto limits = kAlone;
    limits.readsInFlight = 6;
    limits.prefetchBelowReads = 2;
    Queue queue(limits);
    queue.loads.hold();
    std::vector<Request> asked;
    for (uint64_t i = 1; i <= 9; ++i) asked.push_back(prefetched(page(i, 1, i * 100)));
    queue.frame(asked);
    EXPECT_EQ(queue.loads.reads.size(), 2u);
    for (uint64_t i = 11; i <= 19; ++i) asked.push_back(page(i, 1, i * 100));
    queue.frame(asked);  // what is wanted finds four reads free
    EXPECT_EQ(queue.reads(), (Reads{{1}, {2}, {11}, {12}, {13}, {14}}));
}

TEST(RequestQueue, JoinsNeighboursWithinTheGapAndTheLimitOfARead) {
    Queue queue({.readsInFlight = kMany, .joinGapBytes = 5, .readBytes = 60});
    // 10-byte pages at 100, 110 (touching), 125 (gap 5), 141 (gap 6), 151; 300..390 touching.
    queue.frame({page(1, 9, 110), page(2, 1, 100), page(3, 1, 125), page(4, 2, 141),
                 page(5, 1, 151), page(10, 8, 350), page(11, 1, 300), page(12, 1, 310),
                 page(13, 1, 320), page(14, 1, 330), page(15, 1, 340), page(16, 1, 360),
                 page(17, 1, 370), page(18, 1, 380), page(19, 1, 390)});
    // 10 is joined by those behind it first, then by those before it, to 60 bytes.
    EXPECT_EQ(queue.reads(),
              (Reads{{2, 1, 3}, {15, 10, 16, 17, 18, 19}, {4, 5}, {11, 12, 13, 14}}));
    EXPECT_EQ(queue.requests.counters().reads, 4u);
    EXPECT_EQ(queue.requests.counters().sent, 15u);
    EXPECT_EQ(queue.requests.counters().bytesAsked, 150u);
    EXPECT_EQ(queue.requests.counters().bytesRead, 155u);
}

TEST(RequestQueue, NeverJoinsAcrossDatabasesKindsOrUrgency) {
    Queue queue({.readsInFlight = kMany, .joinGapBytes = 50, .readBytes = 1000});
    Request elsewhere = page(2, 4, 10);
    elsewhere.key.database = 1;
    queue.frame({page(1, 5, 0), elsewhere, block(3, 5, 20), prefetched(page(4, 5, 30))});
    EXPECT_EQ(queue.reads(), (Reads{{3}, {1}, {2}, {4}}));
    EXPECT_EQ(queue.requests.counters().bytesRead, 40u);
    EXPECT_EQ(queue.requests.counters().blockBytesRead, 10u);  // of the index alone
    queue.collect();
    for (const Request& neighbour : {elsewhere, block(2, 4, 10), prefetched(page(2, 4, 10))}) {
        Queue pair({.readsInFlight = kMany, .joinGapBytes = 50, .readBytes = 1000});
        pair.frame({page(1, 5, 0), neighbour});
        EXPECT_EQ(pair.loads.reads.size(), 2u);
    }
}

TEST(RequestQueue, APageLongerThanTheLimitIsReadAlone) {
    Queue queue({.readsInFlight = kMany, .joinGapBytes = 5, .readBytes = 60});
    queue.frame({page(1, 9, 0, 500), page(2, 1, 500)});
    EXPECT_EQ(queue.reads(), (Reads{{1}, {2}}));
}

TEST(RequestQueue, WhatIsNotAdmittedBlocksTheLessUrgentOfItsKindAlone) {
    Queue queue({.readsInFlight = kMany, .joinGapBytes = 5, .readBytes = 60});
    queue.refused = {{0, false, 2}};
    const std::vector<Request> asked{page(1, 9, 0),    page(2, 8, 100),
                                     page(3, 7, 200),  page(4, 6, 10),  // beside 1: joins its read
                                     block(5, 1, 300), prefetched(page(6, 1, 400))};
    queue.frame(asked);
    EXPECT_EQ(queue.reads(), (Reads{{5}, {1, 4}}));
    queue.refused = {{0, true, 7}};
    queue.frame({page(2, 8, 100), page(3, 7, 200), block(7, 2, 500), block(8, 1, 700)});
    EXPECT_EQ(queue.reads(), (Reads{{5}, {1, 4}, {2}, {3}}));
}

TEST(RequestQueue, ANeighbourThatIsNotAdmittedStaysOutOfTheRead) {
    Queue queue({.readsInFlight = kMany, .joinGapBytes = 50, .readBytes = 1000});
    queue.refused = {{0, false, 2}};
    queue.frame({page(1, 9, 100), page(2, 1, 110), page(3, 2, 120), page(4, 1, 90)});
    EXPECT_EQ(queue.reads(), (Reads{{4, 1}, {3}}));
    EXPECT_EQ(queue.requests.waitingCount(), 1u);
}

TEST(RequestQueue, StaleRequestsAreForgottenAndCountedButNotSentOnes) {
    auto limits = kAlone;
    limits.readsInFlight = 1;
    Queue queue(limits);
    queue.loads.hold();
    queue.frame({page(1, 9, 0), page(2, 8, 100), page(3, 7, 200)});
    queue.frame({page(3, 7, 200)});
    EXPECT_EQ(queue.requests.counters().cancelled, 1u);
    EXPECT_FALSE(queue.requests.isAsked({0, false, 2}));
    EXPECT_TRUE(queue.requests.isSent({0, false, 1}));
    EXPECT_EQ(queue.requests.waitingCount(), 1u);
    queue.frame({});
    EXPECT_EQ(queue.requests.counters().cancelled, 2u);
    queue.loads.answer(0);
    const auto arrivals = queue.collect();
    ASSERT_EQ(arrivals.size(), 1u);
    EXPECT_EQ(arrivals[0].request.key.id, 1u);
    EXPECT_EQ(arrivals[0].framesSinceAsked, 2u);
    EXPECT_TRUE(arrivals[0].result.page.has_value());
    EXPECT_FALSE(queue.requests.isAsked({0, false, 1}));
    EXPECT_EQ(queue.requests.sentCount(), 0u);
}

TEST(RequestQueue, WhatWasWantedOnceArrivesAsWanted) {
    Queue queue(kAlone);
    queue.loads.hold();
    queue.frame({page(1, 1, 0), prefetched(page(2, 1, 100)), prefetched(page(3, 1, 200))});
    queue.frame({prefetched(page(1, 1, 0)), page(2, 1, 100), prefetched(page(3, 1, 200))});
    queue.loads.letGo();
    std::map<uint64_t, bool> isPrefetch;
    for (const auto& arrival : queue.collect()) {
        isPrefetch[arrival.request.key.id] = arrival.request.isPrefetch;
    }
    EXPECT_EQ(isPrefetch, (std::map<uint64_t, bool>{{1, false}, {2, false}, {3, true}}));
}

TEST(RequestQueue, AFullCacheIsAskedOnceAndNotForEachOfTenThousandRequests) {
    Queue queue({.readsInFlight = kMany});
    std::vector<Request> asked;
    for (uint64_t i = 1; i <= 10000; ++i) asked.push_back(page(i, 1, i * 10));
    int questions = 0;
    queue.requests.beginFrame();
    for (const Request& request : asked) queue.requests.ask(request);
    queue.requests.send([&](const Request&) {
        ++questions;
        return false;
    });
    EXPECT_EQ(questions, 1);
    EXPECT_EQ(queue.requests.waitingCount(), 10000u);
    queue.frame({});
    EXPECT_EQ(queue.requests.waitingCount(), 0u);
}

// Every read that random requests lead to, held against the rules, said plainly.
TEST(RequestQueue, ReadsKeepEveryRuleOfJoiningOverRandomRequests) {
    constexpr uint64_t kSeed = 5;
    SCOPED_TRACE(kSeed);
    std::mt19937_64 random(kSeed);
    for (int round = 0; round < 300; ++round) {
        const RequestQueue::Limits limits{.readsInFlight = kMany,
                                          .prefetchBelowReads = kMany,
                                          .joinGapBytes = random() % 30,
                                          .readBytes = 20 + random() % 200};
        Queue queue(limits);
        std::vector<Request> asked;
        uint64_t offset = 0;
        for (uint64_t id = 1; id <= 40; ++id) {
            offset += random() % 20;
            const uint64_t bytes = 1 + random() % 60;
            Request request = page(id, static_cast<double>(random() % 10), offset, bytes);
            request.key.database = random() % 4 == 0;
            request.isPrefetch = random() % 4 == 0;
            asked.push_back(request);
            offset += bytes;
        }
        std::shuffle(asked.begin(), asked.end(), random);
        queue.frame(asked);

        std::map<uint64_t, Request> unsent;
        for (const Request& request : asked) unsent[request.key.id] = request;
        size_t firstAdmitted = 0;
        for (const auto& read : queue.loads.reads) {
            // The read was begun for the best of all that had not been sent.
            const Request best = unsent.at(queue.admitted.at(firstAdmitted));
            for (const auto& [id, other] : unsent) {
                ASSERT_LE(best.isPrefetch, other.isPrefetch);
                ASSERT_TRUE(best.isPrefetch < other.isPrefetch || best.priority >= other.priority);
            }
            firstAdmitted += read.size();
            const uint64_t begin = read.front().range.offset, end = read.back().range.end();
            ASSERT_TRUE(read.size() == 1 || end - begin <= limits.readBytes);
            for (size_t i = 0; i < read.size(); ++i) {
                const Request& item = unsent.at(read[i].node.id.value);
                ASSERT_EQ(item.range, read[i].range);
                ASSERT_EQ(read[i].database, best.key.database);
                ASSERT_EQ(item.isPrefetch, best.isPrefetch);
                if (i == 0) continue;
                ASSERT_GE(read[i].range.offset, read[i - 1].range.end());
                ASSERT_LE(read[i].range.offset - read[i - 1].range.end(), limits.joinGapBytes);
            }
            for (const LoadItem& item : read) unsent.erase(item.node.id.value);
        }
        ASSERT_TRUE(unsent.empty());
    }
}

}  // namespace
}  // namespace pagoda::cache
