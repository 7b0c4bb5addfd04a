// scripted_world.h: a cache without disk, threads or GL, in which a test decides what happens and
// when: loads that answer late, never, out of order or with faults; GPU memory that counts; a small
// tree of nodes. One byte of GPU memory a vertex.
#pragma once

#include "cache/load_queue.h"
#include "cache/residency.h"

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <vector>

namespace pagoda::cache::test {

// Root, 8 children, 64 grandchildren. Pages lie breadth first in the file, `gapBytes` apart.
class Tree {
public:
    struct Options {
        uint32_t vertices = 10, pageBytes = 100;
        uint64_t gapBytes = 0;
    };
    explicit Tree(const Options& options);
    Tree() : Tree(Options{}) {}
    [[nodiscard]] const ooc::NodeRecord& root() const { return records[0]; }
    [[nodiscard]] const ooc::NodeRecord& child(uint32_t i) const { return records[1 + i]; }
    [[nodiscard]] const ooc::NodeRecord& grandchild(uint32_t i, uint32_t j) const {
        return records[9 + 8 * i + j];
    }
    std::vector<ooc::NodeRecord> records;
};

[[nodiscard]] inline PageId pageOf(const ooc::NodeRecord& node) {
    return {0, node.id};
}
[[nodiscard]] inline RequestKey keyOf(const ooc::NodeRecord& node) {
    return {0, false, node.id.value};
}

// Answers everything at the next collect(), unless told otherwise.
class ScriptedLoads final : public LoadQueue {
public:
    void send(std::vector<LoadItem> items) override;
    void collect(std::vector<LoadResult>& arrived) override;
    [[nodiscard]] bool waitForArrival() override;
    [[nodiscard]] size_t readsInFlight() const override { return waiting_.size(); }

    // While held, nothing arrives but what is told to.
    void hold() { isHeld_ = true; }
    void letGo() { isHeld_ = false; }
    // Answers a read, by its place in `reads`: its items last to first.
    void answer(size_t read);
    void answerAllInReverse();

    std::vector<std::vector<LoadItem>> reads;  // all that were sent
    std::set<uint64_t> failing;                // nodes (NodeId::value) and blocks that give faults
    std::set<uint64_t> empty;                  // ... that give neither value nor fault
    std::map<uint64_t, uint32_t> longerBy;     // nodes: vertices more than their record says
    uint32_t nodesPerBlock = 2;

private:
    [[nodiscard]] LoadResult resultOf(const LoadItem& item) const;

    bool isHeld_ = false;
    std::vector<size_t> waiting_;  // reads that have not been answered, in order
    std::vector<LoadResult> due_;
};

// Checks that pages come once and go once.
class CountingGpu final : public GpuPages {
public:
    uint64_t sizeBytes(const ooc::Page& page) const override { return page.mesh.positions.size(); }
    uint64_t sizeBytes(const ooc::NodeRecord& node) const override { return node.vertexCount; }
    Upload upload(PageId id, const ooc::Page& page) override;
    void drop(PageId id) override;
    [[nodiscard]] uint64_t usedBytes() const;

    std::map<PageId, uint64_t> resident;
    std::vector<PageId> uploaded, dropped;  // ever, in order
    std::set<PageId> refused;
    int noRoom = 0;  // so many uploads from now on find no gap; -1: all of them
};

// Frames of a Residency, as Streaming plays them.
struct World {
    struct Setup {
        Residency::Budgets budgets{uint64_t{1} << 20, uint64_t{1} << 20, 0};
        RequestQueue::Limits limits{};
    };
    explicit World(const Setup& setup)
        : requests(loads, clock, setup.limits), residency(setup.budgets, requests, gpu) {}
    World() : World(Setup{}) {}

    void take();   // what has arrived
    void begin();  // take(), and the next frame begins
    PageState want(const ooc::NodeRecord& node, double priority = 1.0, bool isStandIn = false) {
        return residency.want({pageOf(node), node, priority}, isStandIn);
    }
    void prefetch(const ooc::NodeRecord& node, double priority = 1.0, uint8_t reason = 0) {
        residency.prefetch({pageOf(node), node, priority}, reason);
    }
    void end();  // requests are sent
    // Whole frames that want these, the first most urgent.
    void frames(int count, const std::vector<const ooc::NodeRecord*>& wanted);
    [[nodiscard]] bool isResident(const ooc::NodeRecord& node) const {
        return residency.isResident(pageOf(node));
    }

    ManualClock clock;
    ScriptedLoads loads;
    CountingGpu gpu;
    RequestQueue requests;
    Residency residency;
    uint64_t frame = 0;
};

}  // namespace pagoda::cache::test
