// Budgets and promises in any order of events: random frames, arrivals, faults and budgets, after
// each step held against a plain model that counts all over again.
#include "cache/residency.h"

#include "tests/cache/scripted_world.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace pagoda::cache {
namespace {

using test::pageOf;
using test::Tree;
using test::World;

// Host memory, as residency.h tells it: reservations and decoded pages, least recently used first
// out, of one frame the greatest id.
class HostModel {
public:
    explicit HostModel(uint64_t budgetBytes) : budgetBytes_(budgetBytes) {}

    [[nodiscard]] uint64_t bytes() const {
        uint64_t sum = 0;
        for (const auto& [key, reserved] : reserved_) sum += reserved;
        for (const auto& [id, page] : pages_) sum += page.bytes;
        return sum;
    }
    [[nodiscard]] bool holds(PageId id) const { return pages_.contains(id); }
    [[nodiscard]] size_t reservationCount() const { return reserved_.size(); }
    void touch(PageId id, uint64_t frame) { pages_.at(id).frame = frame; }
    void admit(const Request& request, uint64_t frame) {
        const uint64_t bytes = request.range.bytes + decodedBytes(request.node);
        ASSERT_TRUE(makeRoom(bytes, frame));
        ASSERT_TRUE(reserved_.emplace(request.key, bytes).second) << "sent twice";
    }
    void arrive(const RequestQueue::Arrival& arrival, uint64_t frame) {
        ASSERT_EQ(reserved_.erase(arrival.request.key), 1u) << "came without having been sent";
        if (!arrival.result.page) return;
        const uint64_t bytes = decodedBytes(*arrival.result.page);
        if (bytes > budgetBytes_ || !makeRoom(bytes, UINT64_MAX)) return;
        pages_[{arrival.request.key.database, arrival.request.node.id}] = {bytes, frame};
    }

private:
    struct Page {
        uint64_t bytes, frame;
    };
    bool makeRoom(uint64_t needed, uint64_t beforeFrame) {
        auto left = pages_;
        while (bytes() + needed > budgetBytes_) {
            auto oldest = pages_.end();
            for (auto page = pages_.begin(); page != pages_.end(); ++page) {
                if (page->second.frame >= beforeFrame) continue;
                if (oldest == pages_.end() || page->second.frame <= oldest->second.frame) {
                    oldest = page;
                }
            }
            if (oldest == pages_.end()) {
                pages_ = std::move(left);
                return false;
            }
            pages_.erase(oldest);
        }
        return true;
    }

    uint64_t budgetBytes_;
    std::map<RequestKey, uint64_t> reserved_;
    std::map<PageId, Page> pages_;
};

class Soak {
public:
    explicit Soak(uint64_t seed)
        : random_(seed),
          tree_({.gapBytes = below(3) * 5000}),
          world_({{1000 + below(20000), 60 + below(1500), below(2) * below(300)},
                  {.readsInFlight = 1 + below(8), .attempts = 2, .firstPauseS = 0.1}}),
          host_(world_.residency.hostBudgetBytes()) {
        for (ooc::NodeRecord& node : tree_.records) {
            node.vertexCount = static_cast<uint32_t>(1 + below(90));
            if (below(12) == 0) {
                world_.loads.longerBy[node.id.value] = static_cast<uint32_t>(below(200));
            }
            if (below(20) == 0) world_.gpu.refused.insert(pageOf(node));
        }
        world_.loads.hold();
    }

    void step() {
        shake();
        begin();
        const uint64_t wanted = below(12);
        for (uint64_t i = 0; i < wanted; ++i) want(anyNode());
        for (uint64_t i = below(4); i > 0; --i) world_.prefetch(anyNode(), priority());
        for (uint64_t i = below(4); i > 0; --i) world_.residency.keep(pageOf(anyNode()));
        check();
        end();
        check();
        if (below(4) == 0) {
            take();
            world_.residency.uploadArrived();
            check();
        }
    }

    // Nobody wants anything any more and all that is on its way arrives: nothing stays reserved.
    void drain() {
        world_.loads.letGo();
        for (int i = 0; i < 5; ++i) {
            begin();
            end();
        }
        check();
        EXPECT_EQ(host_.reservationCount(), 0u);
        EXPECT_EQ(world_.requests.sentCount(), 0u);
        EXPECT_EQ(world_.loads.readsInFlight(), 0u);
    }
    [[nodiscard]] const World& world() const { return world_; }

private:
    uint64_t below(uint64_t end) { return random_() % end; }
    double priority() { return static_cast<double>(below(1000)); }
    const ooc::NodeRecord& anyNode() { return tree_.records[below(tree_.records.size())]; }

    // What the world does by itself.
    void shake() {
        for (size_t i = 0; i < world_.loads.reads.size(); ++i) {
            if (!answered_.contains(i) && below(3) == 0) {
                world_.loads.answer(i);
                answered_.insert(i);
            }
        }
        if (below(5) == 0) world_.clock.advance(0.05);
        world_.loads.failing.clear();
        if (below(4) == 0) {
            for (int i = 0; i < 20; ++i) world_.loads.failing.insert(anyNode().id.value);
        }
        world_.gpu.noRoom = below(10) == 0 ? static_cast<int>(below(4)) : 0;
        if (below(200) == 0) {
            world_.residency.dropAll();
            usedIn_.clear();
        }
    }
    void take() {
        std::vector<RequestQueue::Arrival> arrivals;
        world_.requests.collect(arrivals);
        for (RequestQueue::Arrival& arrival : arrivals) {
            host_.arrive(arrival, world_.frame);
            world_.residency.arrive(arrival);
        }
    }
    void begin() {
        take();
        world_.requests.beginFrame();
        world_.residency.beginFrame(++world_.frame);
        check();
    }
    void want(const ooc::NodeRecord& node) {
        const PageId id = pageOf(node);
        const bool wasFailed = world_.residency.state(id) == PageState::Failed;
        const PageState state = world_.want(node, priority(), below(4) == 0);
        ASSERT_EQ(state == PageState::Resident, world_.gpu.resident.contains(id));
        ASSERT_TRUE(!wasFailed || state == PageState::Failed);
        if (state == PageState::Resident) usedIn_[id] = world_.frame;
        if (state == PageState::Absent && host_.holds(id)) host_.touch(id, world_.frame);
    }
    void end() {
        world_.requests.send([this](const Request& request) {
            const PageId id{request.key.database, request.node.id};
            EXPECT_NE(world_.residency.state(id), PageState::Failed);
            EXPECT_FALSE(host_.holds(id)) << "is here already";
            if (!world_.residency.admit(request)) return false;
            host_.admit(request, world_.frame);
            return true;
        });
    }
    void check() {
        const Residency& residency = world_.residency;
        ASSERT_LE(world_.gpu.usedBytes(), residency.gpuBudgetBytes());
        ASSERT_EQ(world_.gpu.usedBytes(), residency.gpuUsedBytes());
        ASSERT_LE(host_.bytes(), residency.hostBudgetBytes());
        ASSERT_EQ(host_.bytes(), residency.hostUsedBytes());
        for (const auto& [id, frame] : usedIn_) {
            if (frame + 2 < world_.frame) continue;
            ASSERT_TRUE(world_.gpu.resident.contains(id)) << "used in one of the last two frames";
        }
    }

    std::mt19937_64 random_;
    Tree tree_;
    World world_;
    HostModel host_;
    std::set<size_t> answered_;
    std::map<PageId, uint64_t> usedIn_;
};

TEST(ResidencySoak, NoBudgetIsExceededAndEveryPromiseHoldsInAnyOrderOfEvents) {
    uint64_t evicted = 0, failed = 0, reloaded = 0, retried = 0, prefetched = 0, cancelled = 0;
    for (uint64_t seed = 1; seed <= 80; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Soak soak(seed);
        for (int i = 0; i < 250; ++i) {
            soak.step();
            if (::testing::Test::HasFatalFailure()) FAIL() << "in step " << i;
        }
        soak.drain();
        const Residency::Counters& counters = soak.world().residency.counters();
        evicted += counters.evictedPages;
        failed += counters.failedPages;
        reloaded += counters.reloadedPages;
        const PrefetchCount ahead = sumOf(counters.prefetch);
        prefetched += ahead.usedBytes;
        ASSERT_LE(ahead.usedBytes, ahead.bytes);
        retried += soak.world().requests.counters().retried;
        cancelled += soak.world().requests.counters().cancelled;
    }
    // All of it happened, and often.
    for (const uint64_t count : {evicted, failed, reloaded, retried, prefetched, cancelled}) {
        EXPECT_GT(count, 200u);
    }
}

TEST(ResidencySoak, TheSameEventsEvictTheSamePages) {
    Soak first(3), second(3);
    for (int i = 0; i < 400; ++i) {
        first.step();
        second.step();
        ASSERT_EQ(first.world().gpu.dropped, second.world().gpu.dropped);
        ASSERT_EQ(first.world().gpu.uploaded, second.world().gpu.uploaded);
        ASSERT_EQ(first.world().loads.reads.size(), second.world().loads.reads.size());
    }
    EXPECT_GT(first.world().gpu.dropped.size(), 50u);
}

}  // namespace
}  // namespace pagoda::cache
