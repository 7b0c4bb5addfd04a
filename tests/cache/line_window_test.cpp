// No more bytes in flight than keep a slow line busy: what is urgent comes soon, and as much comes
// as without the limit. On a simulated disk and a clock that the test moves.
#include "cache/disk_loads.h"
#include "cache/request_queue.h"
#include "tests/cache/scripted_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <vector>

namespace pagoda::cache {
namespace {

using test::ScriptedLoads;

constexpr double kFrameS = 1.0 / 60;

// Endless pages, more urgent the smaller their number; enough of them are asked for in each
// frame.
struct Line {
    Line(const char* disk, bool isWindowed, uint64_t pageBytes, bool isScattered = false)
        : profile(parseDiskProfile(disk)),
          pageBytes_(pageBytes),
          gapBytes_(isScattered ? 100'000 : 0),
          loads(std::make_unique<ScriptedLoads>(), profile, clock),
          requests(loads, clock, {.isWindowed = isWindowed}) {}

    Request page(uint64_t id, double priority) const {
        Request request{
            {0, false, id}, {id * (pageBytes_ + gapBytes_), pageBytes_}, priority, false, {}};
        request.node.id = ooc::NodeId{id};
        request.node.vertexCount = 3;
        return request;
    }
    // A frame of the run time: takes what has come, asks, sends; then time passes.
    void frame(uint64_t asked, const std::vector<Request>& urgent = {}) {
        std::vector<RequestQueue::Arrival> arrivals;
        requests.collect(arrivals);
        for (const auto& arrival : arrivals) {
            const uint64_t id = arrival.request.key.id;
            if (!arrival.result.page) continue;
            arrivedS[id] = clock.nowS();
            arrivedBytes += arrival.request.range.bytes;
            wanted.erase(id);
        }
        while (wanted.size() < asked) wanted.insert(next++);
        requests.beginFrame();
        for (const uint64_t id : wanted) requests.ask(page(id, -static_cast<double>(id)));
        for (const Request& request : urgent) requests.ask(request);
        requests.send([](const Request&) { return true; });
        mostInFlight = std::max(mostInFlight, requests.line().bytesInFlight());
        clock.advance(kFrameS);
    }
    void frames(int count) {
        for (int i = 0; i < count; ++i) frame(enough());
    }
    // Pages for some frames of the line, and for its latency.
    [[nodiscard]] uint64_t enough() const {
        const double seconds = 3 * kFrameS + profile.latencyS;
        return 30 + (4'000'000 + static_cast<uint64_t>(profile.bytesPerS * seconds)) / pageBytes_;
    }
    // What a new request of highest priority, asked for now, takes to come.
    double urgentS(uint64_t id) {
        const double beginS = clock.nowS();
        while (!arrivedS.contains(id)) {
            frame(enough(), {page(id, 1e9)});
            if (clock.nowS() > beginS + 60) return 60;
        }
        return arrivedS[id] - beginS;
    }

    DiskProfile profile;
    ManualClock clock;
    uint64_t pageBytes_, gapBytes_;
    DiskLoads loads;
    RequestQueue requests;
    std::set<uint64_t> wanted;
    std::map<uint64_t, double> arrivedS;
    uint64_t next = 1, arrivedBytes = 0, mostInFlight = 0;
};

constexpr const char* kSlow = "50Mbit/s,40ms";
constexpr double kSlowBytesPerS = 50e6 / 8, kSlowLatencyS = 0.04;
constexpr double kSlowWindowS = kSlowLatencyS + 2 * kFrameS;
constexpr uint64_t kFar = 50'000'000;

TEST(LineWindow, LearnsTheLineFromWhatArrives) {
    for (const uint64_t pageBytes : std::initializer_list<uint64_t>{4'000, 30'000}) {
        Line line(kSlow, true, pageBytes);
        EXPECT_EQ(line.requests.line().windowBytes(), LineEstimate::kUnlimited);
        line.frames(900);
        EXPECT_NEAR(line.requests.line().bytesPerS() / kSlowBytesPerS, 1, 0.15);
        EXPECT_NEAR(line.requests.line().latencyS(), kSlowLatencyS, kFrameS);
    }
}

TEST(LineWindow, AnUrgentRequestComesWithinOneWindowOnASlowLine) {
    for (const uint64_t pageBytes : std::initializer_list<uint64_t>{4'000, 30'000, 100'000}) {
        Line line(kSlow, true, pageBytes);
        line.frames(300);
        double worstS = 0;
        std::mt19937_64 random(3);
        for (uint64_t i = 0; i < 50; ++i) {
            line.frames(static_cast<int>(random() % 20));
            worstS = std::max(worstS, line.urgentS(kFar + 10 * i));
        }
        // A window, the read that went over it, its own transfer, and the frame that sees it come.
        const double readS =
            static_cast<double>(std::max<uint64_t>(pageBytes, 120'000)) / kSlowBytesPerS;
        EXPECT_LE(worstS, kSlowWindowS * 1.15 + 2 * readS + kFrameS) << pageBytes;
    }
}

TEST(LineWindow, WithoutTheLimitItWaitsBehindALongQueue) {
    Line line(kSlow, false, 4'000);
    line.frames(300);
    EXPECT_GT(line.urgentS(kFar), 4 * kSlowWindowS);
}

// Of the bytes that arrive without the limit.
double share(const char* disk, uint64_t pageBytes, bool isScattered) {
    Line limited(disk, true, pageBytes, isScattered);
    Line unlimited(disk, false, pageBytes, isScattered);
    limited.frames(600);
    unlimited.frames(600);
    return static_cast<double>(limited.arrivedBytes) / static_cast<double>(unlimited.arrivedBytes);
}

TEST(LineWindow, AsMuchArrivesAsWithoutTheLimit) {
    for (const char* disk : {kSlow, "100MB/s,10ms", "50Mbit/s,40ms,fail=1%"}) {
        for (const bool isScattered : {false, true}) {
            EXPECT_GE(share(disk, 4'000, isScattered), 0.95) << disk << " " << isScattered;
            EXPECT_GE(share(disk, 30'000, isScattered), 0.95) << disk << " " << isScattered;
        }
    }
    // A read that takes twice as long leaves the line a gap, which the window does not foresee.
    EXPECT_GE(share("50Mbit/s,40ms,short=5%", 4'000, false), 0.9);
    EXPECT_GE(share("500MB/s", 30'000, true), 0.95);
}

}  // namespace
}  // namespace pagoda::cache
