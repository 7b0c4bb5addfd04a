// traversal_benchmark: what a traversal costs without drawing: every page and index block is there,
// boxes answer at once, nothing is drawn. Tau is chosen so that about `nodes` of a tree of some
// 400,000 are visited from a place before it that sees most of it, looking around. `alone` has a
// sink that does nothing; `cached` goes through the frame runner, with its look-ups of every page
// in the cache. Time is CPU time of Strategy::traverse alone, per frame; `visited` and `drawn` are
// nodes a frame.
#include "hlod/strategies/strategies.h"
#include "hlod/view/frame_runner.h"
#include "tests/hlod/made_tree.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <ctime>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace pagoda::hlod {
namespace {

constexpr int kExtentBits = 14;  // of the scene
constexpr int kDepth = 8;        // of the leaves
constexpr size_t kNodes = 400'000;
constexpr int kViews = 16;

double threadCpuS() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

// Four or five of eight octants are there, as where surfaces run through them. Errors double from
// level to level.
test::MadeRecords makeRecords() {
    std::mt19937 random(1);
    constexpr int kSide = 1 << kExtentBits;
    test::MadeRecords records({.extentBits = kExtentBits}, {Vec3i(0), Vec3i(kSide)}, 64.0);
    for (size_t parent = 0; parent < records.nodes().size(); ++parent) {
        const ooc::NodeRecord above = records.nodes()[parent];
        if (above.id.depth() == kDepth || records.nodes().size() + 8 > kNodes) continue;
        const int side = kSide >> (above.id.depth() + 1);
        for (uint32_t octant = 0; octant < 8; ++octant) {
            if (random() % 100 < 42) continue;
            const Vec3i corner(octant & 1, (octant >> 1) & 1, (octant >> 2) & 1);
            const Vec3i least = above.box.min + corner * side;
            const bool isLeaf = above.id.depth() + 1 == kDepth;
            records.add(parent, octant, {least, least + Vec3i(side)},
                        isLeaf ? 0.0 : 0.5 * above.errorModelUnits);
        }
    }
    records.finish();
    records.page.value = ooc::Page{};
    records.page.value->mesh.positions = {Vec3i(0), Vec3i(1, 0, 0), Vec3i(0, 1, 0)};
    records.page.value->mesh.indices = {0, 1, 2};
    return records;
}

const test::MadeRecords& records() {
    static const test::MadeRecords made = makeRecords();
    return made;
}

Box3d sceneBox() {
    return records().lattice.toModel(records().nodes()[0].box);
}

// From a little before it, more to the side with each view.
Camera cameraOf(int view) {
    const Vec3d eye(-14000.5, 8100.5, 8000.5);
    const double angle = 0.01 * view;
    Camera camera{.eye = eye, .target = eye + Vec3d(std::cos(angle), std::sin(angle), 0.1)};
    camera.up = {0, 0, 1};
    camera.widthPx = 640;
    camera.heightPx = 480;
    return camera;
}

// Three in ten of the boxes below depth 4 are hidden; always the same ones.
class InstantAnswers final : public CountingVisibility {
public:
    QueryTicket query(const QueryShape& shape) override {
        const Box3d& box = std::get<Box3d>(shape);
        const double mixed = box.min.x * 7.31 + box.min.y * 3.77 + box.max.z * 5.93;
        const auto hash = static_cast<uint64_t>(mixed * 64.0) * 0x9E3779B97F4A7C15ull;
        const bool isSmall = box.max.x - box.min.x < (1 << (kExtentBits - 4));
        return {isSmall && (hash >> 32) % 10 < 3 ? 0u : 200u};
    }
    std::optional<uint64_t> poll(QueryTicket ticket) override { return ticket.value; }
    uint64_t wait(QueryTicket ticket) override { return ticket.value; }
    bool isPollFree() const override { return true; }
};

class NothingSink final : public FrameSink {
public:
    cache::PageState state(const Node&) const override { return cache::PageState::Resident; }
    cache::PageState want(const Node&, double, Use) override { return cache::PageState::Resident; }
    void keep(const Node&) override {}
    void refine(const Node&) override {}
    void draw(const Node&, Use) override { ++drawn; }
    void hide(const Node&) override {}
    CountingVisibility* counting() override { return &answers; }
    PyramidVisibility* pyramid() override { return nullptr; }

    uint64_t drawn = 0;
    InstantAnswers answers;
};

class NothingDevice final : public Device {
public:
    void beginFrame(const View&) override {}
    void draw(const Node&) override { ++drawn_; }
    CountingVisibility* counting() override { return &answers_; }
    PyramidVisibility* pyramid() override { return nullptr; }
    void endFrame(const FrameCut&, FrameRecord& record) override {
        record.drawnNodes = drawn_;
        drawn_ = 0;
    }

private:
    InstantAnswers answers_;
    uint64_t drawn_ = 0;
};

class NothingPages final : public cache::GpuPages {
public:
    uint64_t sizeBytes(const ooc::Page&) const override { return 64; }
    uint64_t sizeBytes(const ooc::NodeRecord&) const override { return 64; }
    Upload upload(cache::PageId, const ooc::Page&) override { return Upload::Done; }
    void drop(cache::PageId) override {}
};

// Measures another strategy.
class Timed final : public Strategy {
public:
    explicit Timed(const std::string& name) : strategy_(makeStrategy(name)) {}
    void traverse(FrameContext& frame) override {
        const double beginS = threadCpuS();
        strategy_->traverse(frame);
        lastS = threadCpuS() - beginS;
    }
    void forget() override { strategy_->forget(); }

    double lastS = 0.0;

private:
    std::unique_ptr<Strategy> strategy_;
};

class Alone {
public:
    FrameRecord run(const Camera& camera, Strategy& strategy, double tauPx) {
        tree_.beginFrame();
        sink_.drawn = 0;
        FrameRecord record;
        const View view(camera, sceneBox());
        FrameContext frame{view, tree_.tree(), tauPx, tree_.frameIndex(), sink_, record};
        strategy.traverse(frame);
        record.drawnNodes = sink_.drawn;
        return record;
    }

private:
    test::MadeTree tree_{records()};
    NothingSink sink_;
};

class Cached {
public:
    FrameRecord run(const Camera& camera, Strategy& strategy, double tauPx) {
        FrameRecord record = runner_.run(camera, strategy, {tauPx});
        while (record.missingPages > 0) record = runner_.run(camera, strategy, {tauPx});
        return record;
    }

private:
    cache::ManualClock clock_;
    pagoda::test::InlineLoads loads_{records()};
    NothingPages pages_;
    NothingDevice device_;
    cache::SceneDatabase database_{records().lattice, &records()};
    cache::Streaming streaming_{std::span(&database_, 1),
                                loads_,
                                pages_,
                                clock_,
                                {.hostBytes = uint64_t{8} << 30, .gpuBytes = uint64_t{1} << 30}};
    NodeTree tree_{records().lattice, streaming_.index()};
    FrameRunner runner_{streaming_, tree_, device_};
};

// Visited nodes fall as tau rises.
double tauFor(const std::string& name, double nodes) {
    Alone alone;
    double least = 1e-3, most = 1e3;
    for (int i = 0; i < 24; ++i) {
        const double tauPx = std::sqrt(least * most);
        Timed strategy(name);
        uint64_t visited = 0;
        for (int view = 0; view < 4; ++view) {
            visited = alone.run(cameraOf(view), strategy, tauPx).visitedNodes;
        }
        (static_cast<double>(visited) > nodes ? least : most) = tauPx;
    }
    return std::sqrt(least * most);
}

template <typename World>
void traverse(benchmark::State& state, const std::string& name, double nodes) {
    const double tauPx = tauFor(name, nodes);
    World world;
    Timed strategy(name);
    for (int view = 0; view < kViews; ++view) world.run(cameraOf(view), strategy, tauPx);
    double visited = 0, drawn = 0, frames = 0;
    int view = 0, step = 1;
    for (auto _ : state) {
        const FrameRecord record = world.run(cameraOf(view), strategy, tauPx);
        state.SetIterationTime(strategy.lastS);
        visited += static_cast<double>(record.visitedNodes);
        drawn += static_cast<double>(record.drawnNodes);
        ++frames;
        view += step;
        if (view == 0 || view == kViews - 1) step = -step;  // back and forth: no jump
    }
    state.counters["visited"] = visited / frames;
    state.counters["drawn"] = drawn / frames;
}

const int kRegistered = [] {
    struct Workload {
        const char* name;
        double nodes;
    };
    for (const Workload workload : {Workload{"frustum", 1e5}, {"coh", 1e4}}) {
        const std::string name = workload.name;
        const auto add = [&](const char* how, auto* run) {
            benchmark::RegisterBenchmark(
                (name + '/' + how).c_str(),
                [=](benchmark::State& state) { run(state, name, workload.nodes); })
                ->UseManualTime()
                ->Unit(benchmark::kMillisecond);
        };
        add("alone", &traverse<Alone>);
        add("cached", &traverse<Cached>);
    }
    return 0;
}();

}  // namespace
}  // namespace pagoda::hlod
