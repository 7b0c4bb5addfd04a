// Pictures while pages are on their way from a slow disk: no holes, nothing coarser in a still view
// but by stand-ins, and nothing read that did not prove visible.
#include "hlod/view/screen_box.h"
#include "tests/hlod/software_rig.h"

#include <gtest/gtest.h>

#include <map>

namespace pagoda::hlod {
namespace {

using test::Rig;
using test::RoomScene;

constexpr int kStops = 24, kFramesAtStop = 8;
const char* const kSlowDisk = "1MB/s,40ms";

const RoomScene& rooms() {
    static const RoomScene scene;
    return scene;
}

class SlowDisk : public testing::TestWithParam<const char*> {};

TEST_P(SlowDisk, LeavesNoHoles) {
    Rig rig(rooms(), {.disk = cache::parseDiskProfile(kSlowDisk)}), leaves(rooms());
    const auto strategy = makeStrategy(GetParam()), frustum = makeStrategy("frustum");
    uint64_t standIns = 0;
    int framesWithoutRoot = 0;
    for (int i = 0; i < kStops * kFramesAtStop; ++i) {
        const Camera camera = rooms().walk(i / kFramesAtStop, kStops);
        const FrameRecord record = rig.live(camera, *strategy, 1.0);
        standIns += record.standIns;
        framesWithoutRoot += record.drawnNodes == 0;
        if (record.drawnNodes == 0) continue;
        if (i % kFramesAtStop == 0) static_cast<void>(leaves.settle(camera, *frustum, 0.0));
        EXPECT_EQ(test::holes(rig, leaves.picture()), 0u) << i;
    }
    EXPECT_GT(standIns, 30u);
    EXPECT_LE(framesWithoutRoot, 12);  // index block and page, 40 ms each
}

bool isBelow(ooc::NodeId node, ooc::NodeId above) {
    while (node != above && node != ooc::NodeId::root()) node = node.parent();
    return node == above;
}

// Of what each pixel shows in a still view.
struct Coarser {
    uint64_t byStandIns = 0, byCut = 0;
    uint64_t byOthers = 0;  // something else came to the front, which had been hidden
};

Coarser coarserPixels(const char* name, const char* disk, uint32_t latency = 0) {
    Rig rig(rooms(), {.disk = cache::parseDiskProfile(disk), .queryLatencyFrames = latency});
    const auto strategy = makeStrategy(name);
    SoftwarePicture last;
    Coarser counts;
    const auto errorAt = [&](const SoftwarePicture& picture, size_t pixel) {
        return rooms().record(picture.nodeAt(pixel)).errorModelUnits;
    };
    for (int i = 0; i < kStops * kFramesAtStop; ++i) {
        static_cast<void>(rig.live(rooms().walk(i / kFramesAtStop, kStops), *strategy, 1.0));
        const SoftwarePicture& now = rig.picture();
        std::set<ooc::NodeId> standIns;
        const FrameCut& cut = rig.runner.cut();
        for (size_t n = 0; n < cut.drawn().size(); ++n) {
            if (cut.drawnAsStandIn()[n] != 0) standIns.insert(cut.drawn()[n].record->id);
        }
        for (size_t p = 0; i % kFramesAtStop != 0 && p < now.pixelCount(); ++p) {
            if (last.nodeOrdinals[p] == 0 || now.nodeOrdinals[p] == 0) continue;
            if (now.depths[p] == last.depths[p] || errorAt(now, p) <= errorAt(last, p)) continue;
            const ooc::NodeId node = now.nodeAt(p);
            const bool isOther = !isBelow(last.nodeAt(p), node);
            ++(standIns.contains(node) ? counts.byStandIns
                                       : (isOther ? counts.byOthers : counts.byCut));
        }
        last = now;
    }
    return counts;
}

TEST(StillViewOnASlowDisk, NothingGetsCoarserUnderFrustum) {
    const Coarser coarser = coarserPixels("frustum", kSlowDisk);
    EXPECT_EQ(coarser.byCut + coarser.byOthers, 0u);
    // What gets finer may recede at its outline and show a stand-in behind it.
    EXPECT_LE(coarser.byStandIns, 3u);
}

// A child that turns visible and is not there has a stand-in, which may show before its siblings.
TEST(StillViewOnASlowDisk, OnlyStandInsMakeAnythingCoarserUnderBool) {
    const Coarser coarser = coarserPixels("bool", kSlowDisk);
    EXPECT_EQ(coarser.byCut + coarser.byOthers, 0u);
    EXPECT_LT(coarser.byStandIns, 100u);
}

// With history too: in a still view the cut only ever sinks.
class StillViewWithHistory : public testing::TestWithParam<const char*> {};

TEST_P(StillViewWithHistory, OnlyStandInsMakeAnythingCoarser) {
    for (const uint32_t latency : {0u, 1u, 2u, 4u}) {
        const Coarser coarser = coarserPixels(GetParam(), kSlowDisk, latency);
        EXPECT_EQ(coarser.byCut, 0u) << latency;
        // What was hidden may come to the front, coarse as what is little seen; and stand-ins, as
        // under bool: some pixels of all these pictures.
        const double pixels = 64.0 * 48.0 * kStops * kFramesAtStop;
        EXPECT_LT(static_cast<double>(coarser.byOthers), 1e-4 * pixels) << latency;
        EXPECT_LT(static_cast<double>(coarser.byStandIns), 1e-3 * pixels) << latency;
    }
}

INSTANTIATE_TEST_SUITE_P(, StillViewWithHistory,
                         testing::Values("sw", "coh", "hzb", "late", "slabs"));

// Hears what is asked about boxes, and the answers.
class SpyingVisibility final : public CountingVisibility, public PyramidVisibility {
public:
    QueryTicket query(const QueryShape& shape) override {
        const QueryTicket ticket = counting->query(shape);
        asked_[ticket.value] = std::get<Box3d>(shape);
        return ticket;
    }
    std::optional<uint64_t> poll(QueryTicket ticket) override { return wait(ticket); }
    uint64_t wait(QueryTicket ticket) override {
        return note(asked_[ticket.value], counting->wait(ticket));
    }
    void build() override { depths->build(); }
    void visiblePixels(std::span<const Box3d> boxes, std::span<uint64_t> pixels) override {
        depths->visiblePixels(boxes, pixels);
        for (size_t i = 0; i < boxes.size(); ++i) note(boxes[i], pixels[i]);
    }
    CountingVisibility* counting = nullptr;
    PyramidVisibility* depths = nullptr;
    std::vector<Box3d> seen;

private:
    uint64_t note(const Box3d& box, uint64_t pixels) {
        if (pixels > 0) seen.push_back(box);
        return pixels;
    }
    std::map<uint64_t, Box3d> asked_;
};

class SpyingDevice final : public Device {
public:
    SpyingDevice(const ooc::Lattice& lattice, uint64_t gpuBytes) : inner(lattice, gpuBytes) {}
    void beginFrame(const View& view) override {
        views.push_back(view);
        inner.beginFrame(view);
        spy.counting = inner.counting();
        spy.depths = inner.pyramid();
    }
    void draw(const Node& node) override { inner.draw(node); }
    CountingVisibility* counting() override { return &spy; }
    PyramidVisibility* pyramid() override { return &spy; }
    void endFrame(const FrameCut& cut, FrameRecord& record) override {
        inner.endFrame(cut, record);
    }
    SoftwareDevice inner;
    SpyingVisibility spy;
    std::vector<View> views;
};

class OnDemand : public testing::TestWithParam<const char*> {};

// Closed rooms: behind the walls is nothing to be had.
TEST_P(OnDemand, WhatNeverProvesVisibleIsNeverRead) {
    const RoomScene closed(RoomScene::Options{.doorShare = 0.0});
    Rig parts(closed, {.disk = cache::parseDiskProfile(kSlowDisk)});
    SpyingDevice device(closed.lattice, uint64_t{64} << 20);
    cache::Streaming streaming(std::span(&parts.database, 1), parts.loads, device.inner.pages(),
                               parts.clock, {});
    NodeTree tree(closed.lattice, streaming.index());
    FrameRunner runner(streaming, tree, device);
    const auto strategy = makeStrategy(GetParam());
    for (int i = 0; i < 120; ++i) {
        Camera camera = closed.walk(0, 1);
        camera.eye = closed.roomCentre(2, 2);
        camera.target = camera.eye + Vec3d(std::cos(0.05 * i), std::sin(0.05 * i), -0.1);
        static_cast<void>(runner.run(camera, *strategy, {1.0}));
        parts.clock.advance(1.0 / 60.0);
    }
    std::set<ooc::NodeId> visible;  // with their ancestors, which may stand in
    for (const ooc::IndexBlock& block : closed.blocks) {
        for (const ooc::NodeRecord& record : block.nodes) {
            const Box3d box = closed.lattice.toModel(record.box);
            const auto isIt = [&](const Box3d& seen) {
                return seen.min == box.min && seen.max == box.max;
            };
            const auto isUnasked = [&](const View& view) {
                return view.intersectsFrustum(box) && crossesNear(view, box);
            };
            if (std::none_of(device.spy.seen.begin(), device.spy.seen.end(), isIt) &&
                std::none_of(device.views.begin(), device.views.end(), isUnasked)) {
                continue;
            }
            ooc::NodeId node = record.id;
            while (visible.insert(node).second && node != ooc::NodeId::root()) node = node.parent();
        }
    }
    for (const auto& [node, times] : parts.loads.pages) {
        EXPECT_TRUE(visible.contains(node)) << std::hex << node.value;
    }
    EXPECT_GT(parts.loads.pages.size(), 10u);
    EXPECT_LT(parts.loads.pages.size(), closed.nodeCount() / 2);
}

INSTANTIATE_TEST_SUITE_P(, SlowDisk,
                         testing::Values("frustum", "bool", "sw", "simp", "coh", "hzb", "late",
                                         "slabs"));
INSTANTIATE_TEST_SUITE_P(, OnDemand, testing::Values("bool", "sw", "simp", "coh", "hzb", "late"));

}  // namespace
}  // namespace pagoda::hlod
