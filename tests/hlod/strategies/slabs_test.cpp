// slabs (paper 003): what is asked and drawn in which order, against cases by hand and brute force;
// what its pictures show, against everything drawn.
#include "hlod/view/screen_box.h"
#include "tests/hlod/made_tree.h"
#include "tests/hlod/software_rig.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>
#include <set>

namespace pagoda::hlod {
namespace {

using test::MadeRecords;
using test::MadeTree;
using test::Rig;
using test::RoomScene;
using Events = std::vector<std::string>;

// Frames over records without pages: boxes are answered by script.
class BoxFrames final : public FrameSink, public CountingVisibility {
public:
    explicit BoxFrames(const MadeRecords& records) : records_(records), tree_(records) {}

    FrameRecord run(Strategy& strategy, const View& view, double tauPx) {
        events.clear();
        boxes.clear();
        drawn.clear();
        hidden.clear();
        wanted.clear();
        tree_.beginFrame();
        FrameRecord record;
        FrameContext frame{view, tree_.tree(), tauPx, tree_.frameIndex(), *this, record};
        strategy.traverse(frame);
        return record;
    }

    cache::PageState state(const Node& node) const override {
        const auto found = states.find(indexOf(node));
        return found == states.end() ? cache::PageState::Resident : found->second;
    }
    cache::PageState want(const Node& node, double, Use) override {
        wanted.insert(indexOf(node));
        return state(node);
    }
    void keep(const Node&) override {}
    void refine(const Node& node) override { note("refine", indexOf(node)); }
    void draw(const Node& node, Use use) override {
        note(use == Use::Cut ? "draw" : "stand in", indexOf(node));
        drawn.push_back(indexOf(node));
    }
    void hide(const Node& node) override { hidden.push_back(indexOf(node)); }
    CountingVisibility* counting() override { return this; }
    PyramidVisibility* pyramid() override { return nullptr; }

    QueryTicket query(const QueryShape& shape) override {
        boxes.push_back(std::get<Box3d>(shape));
        note("query", boxes.size() - 1);
        return {boxes.size() - 1};
    }
    std::optional<uint64_t> poll(QueryTicket) override { return std::nullopt; }
    uint64_t wait(QueryTicket ticket) override {
        note("wait", ticket.value);
        return answer(boxes[ticket.value]);
    }

    std::function<uint64_t(const Box3d&)> answer = [](const Box3d&) { return 1u; };
    std::map<size_t, cache::PageState> states;
    Events events;
    std::vector<Box3d> boxes;           // asked about
    std::vector<size_t> drawn, hidden;  // by record
    std::set<size_t> wanted;

private:
    size_t indexOf(const Node& node) const {
        size_t index = 0;
        while (records_.nodes()[index].id != node.record->id) ++index;
        return index;
    }
    void note(const char* what, size_t number) {
        events.push_back(std::string(what) + ' ' + std::to_string(number));
    }

    const MadeRecords& records_;
    MadeTree tree_;
};

StrategyOptions uniform(int resolution, size_t batch, uint64_t queryTriangles = 1) {
    return {.slabs = {.resolution = resolution, .batch = batch, .queryTriangles = queryTriangles}};
}

View lookingAlongZ() {
    Camera camera{.eye = {2000, 500, -4000}, .target = {2000, 500, 0}, .fovyDegrees = 60};
    camera.nearModelUnits = 1.0;
    return {camera, {}};
}

// 1 and 2 in front, side by side; 3 behind, as wide as both. A grid of 4 has cells of 1000.
MadeRecords threeLeaves() {
    MadeRecords records({.extentBits = 12}, {Vec3i(0), {4000, 1000, 4000}}, 100.0);
    records.add(0, 0, {{100, 0, 100}, {900, 1000, 900}}, 0.0);
    records.add(0, 1, {{2100, 0, 100}, {2900, 1000, 900}}, 0.0);
    records.add(0, 4, {{100, 0, 3100}, {2900, 1000, 3900}}, 0.0);
    records.finish();
    return records;
}

TEST(Slabs, AllOfASlabIsDrawnBeforeTheNextIsAskedAbout) {
    const MadeRecords records = threeLeaves();
    BoxFrames frames(records);
    const auto strategy = makeStrategy("slabs", uniform(4, 64));
    const FrameRecord record = frames.run(*strategy, lookingAlongZ(), 0.0);
    // The third is drawn by its first cell; its others are not opened again.
    const Events right = {"query 0", "query 1", "wait 0",  "wait 1",  "refine 0",
                          "draw 1",  "draw 2",  "query 2", "query 3", "query 4",
                          "wait 2",  "wait 3",  "wait 4",  "draw 3"};
    EXPECT_EQ(frames.events, right);
    EXPECT_EQ(record.waits, 2u);
}

// One query a batch: what is drawn meanwhile is not asked about.
TEST(Slabs, BatchesAreAskedAtOnceAndDrawnBeforeTheNext) {
    const MadeRecords records = threeLeaves();
    BoxFrames frames(records);
    const auto strategy = makeStrategy("slabs", uniform(4, 1));
    const FrameRecord record = frames.run(*strategy, lookingAlongZ(), 0.0);
    const Events right = {"query 0", "wait 0", "refine 0", "draw 1", "query 1",
                          "wait 1",  "draw 2", "query 2",  "wait 2", "draw 3"};
    EXPECT_EQ(frames.events, right);
    EXPECT_EQ(record.waits, 3u);
}

TEST(Slabs, WhatWouldDrawTooLittleIsDrawnUnasked) {
    const MadeRecords records = threeLeaves();  // of one triangle each
    BoxFrames frames(records);
    const auto strategy = makeStrategy("slabs", uniform(4, 64, 2));
    static_cast<void>(frames.run(*strategy, lookingAlongZ(), 0.0));
    const Events right = {"refine 0", "draw 1", "draw 2", "draw 3"};
    EXPECT_EQ(frames.events, right);
}

TEST(Slabs, WhatIsHiddenIsNotAskedFor) {
    const MadeRecords records = threeLeaves();
    BoxFrames frames(records);
    frames.answer = [](const Box3d& box) { return box.min.z < 2000.0 ? 1u : 0u; };
    const auto strategy = makeStrategy("slabs", uniform(4, 64));
    static_cast<void>(frames.run(*strategy, lookingAlongZ(), 0.0));
    EXPECT_EQ(frames.drawn, (std::vector<size_t>{1, 2}));
    EXPECT_EQ(frames.hidden, std::vector<size_t>{3});
    EXPECT_FALSE(frames.wanted.contains(3));
}

TEST(Slabs, WhatHoldsTheEyeIsVisibleUnasked) {
    const MadeRecords records = threeLeaves();
    BoxFrames frames(records);
    frames.answer = [](const Box3d&) { return 0u; };
    Camera camera{.eye = {500, 500, 500}, .target = {500, 500, 4000}, .fovyDegrees = 60};
    camera.nearModelUnits = 1.0;
    const auto strategy = makeStrategy("slabs", uniform(4, 64));
    static_cast<void>(frames.run(*strategy, View(camera, {}), 0.0));
    EXPECT_EQ(frames.drawn, std::vector<size_t>{1});
    EXPECT_EQ(frames.hidden, std::vector<size_t>{3});
}

// Absent or failed, the root covers it; the next frame asks for it again.
TEST(Slabs, WhatIsAbsentHasAStandIn) {
    for (const cache::PageState state : {cache::PageState::Absent, cache::PageState::Failed}) {
        const MadeRecords records = threeLeaves();
        BoxFrames frames(records);
        frames.states[3] = state;
        const auto strategy = makeStrategy("slabs", uniform(4, 64));
        for (int frame = 0; frame < 3; ++frame) {
            static_cast<void>(frames.run(*strategy, lookingAlongZ(), 0.0));
            EXPECT_EQ(frames.drawn, std::vector<size_t>{0});
            EXPECT_TRUE(frames.wanted.contains(3));
        }
        // Hidden, it does not keep the others from being drawn (from the frame after).
        frames.answer = [](const Box3d& box) { return box.min.z < 1000.0 ? 1u : 0u; };
        static_cast<void>(frames.run(*strategy, lookingAlongZ(), 0.0));
        static_cast<void>(frames.run(*strategy, lookingAlongZ(), 0.0));
        EXPECT_EQ(frames.drawn, (std::vector<size_t>{1, 2}));
        // Seen again, it has the root beside the others.
        frames.answer = [](const Box3d&) { return 1u; };
        static_cast<void>(frames.run(*strategy, lookingAlongZ(), 0.0));
        EXPECT_TRUE(std::count(frames.drawn.begin(), frames.drawn.end(), 0u) == 1);
        EXPECT_TRUE(frames.wanted.contains(3));
    }
}

// Two leaves fill the scene's near left quarter: by hand, 64 cells of a grid of 4.
TEST(Slabs, NestedGridsCutVisibleCellsThatHoldTooMuch) {
    MadeRecords records({.extentBits = 12}, {Vec3i(0), Vec3i(4000)}, 100.0);
    records.add(0, 0, {{0, 0, 0}, {1000, 1000, 400}}, 0.0);
    records.add(0, 4, {{0, 0, 600}, {1000, 1000, 1000}}, 0.0);
    records.finish();
    const auto queriesWith = [&](double splitTriangles) {
        BoxFrames frames(records);
        frames.answer = [](const Box3d& box) { return box.min.z < 500.0 ? 1u : 0u; };
        const StrategyOptions options{
            .slabs = {.isNested = true, .splitTriangles = splitTriangles}};
        const auto strategy = makeStrategy("slabs", options);
        static_cast<void>(frames.run(*strategy, lookingAlongZ(), 0.0));
        return std::pair(frames.boxes.size(), frames.drawn);
    };
    // One cell holds both: seen, both are drawn.
    EXPECT_EQ(queriesWith(2.0), std::pair(size_t{1}, std::vector<size_t>{1, 2}));
    // Cut, the nearest 16 cells draw the one in front, the next layer's is drawn already; of the
    // other, 2 layers of 16 are asked about.
    EXPECT_EQ(queriesWith(1.9), std::pair(size_t{1 + 16 + 32}, std::vector<size_t>{1}));
}

bool overlaps(const Box3d& a, const Box3d& b) {
    return glm::all(glm::lessThan(a.min, b.max)) && glm::all(glm::lessThan(b.min, a.max));
}

// Random leaves and answers: a node is drawn once if it meets a box that was seen, else hidden.
TEST(Slabs, DrawsWhatMeetsAVisibleCellOnceAndNothingElse) {
    std::mt19937 random(3);
    const auto whole = [&](int least, int most) {
        return std::uniform_int_distribution<int>(least, most)(random);
    };
    size_t drawn = 0, hidden = 0;
    for (int round = 0; round < 100; ++round) {
        MadeRecords records({.extentBits = 12}, {Vec3i(0), Vec3i(4000)}, 100.0);
        for (size_t parent = 0; parent < 9; ++parent) {
            for (uint32_t octant = 0; octant < 8; ++octant) {
                const Vec3i least(whole(0, 3000), whole(0, 3000), whole(0, 3000));
                const Box3i box{least, least + Vec3i(whole(1, 900), whole(1, 900), whole(1, 900))};
                records.add(parent, octant, parent == 0 ? Box3i{Vec3i(0), Vec3i(4000)} : box,
                            parent == 0 ? 50.0 : 0.0);
            }
        }
        records.finish();
        BoxFrames frames(records);
        std::vector<Box3d> seen;
        frames.answer = [&](const Box3d& box) {
            const bool isSeen = whole(0, 4) == 0;
            if (isSeen) seen.push_back(box);
            return isSeen ? 1u : 0u;
        };
        Camera camera;
        camera.eye = {whole(-3000, 7000), whole(-3000, 7000), -9000};
        camera.target = {2000, 2000, 2000};
        camera.nearModelUnits = 1.0;
        const View view(camera, {});
        StrategyOptions options = uniform(whole(1, 12), static_cast<size_t>(whole(1, 40)));
        const auto strategy = makeStrategy("slabs", options);
        static_cast<void>(frames.run(*strategy, view, 0.0));
        const std::set<size_t> drawnOnce(frames.drawn.begin(), frames.drawn.end());
        EXPECT_EQ(drawnOnce.size(), frames.drawn.size());
        const std::set<size_t> hiddenOnce(frames.hidden.begin(), frames.hidden.end());
        for (size_t node = 9; node < records.nodes().size(); ++node) {
            const Box3d box = records.lattice.toModel(records.nodes()[node].box);
            const bool isIn = view.intersectsFrustum(box);
            const bool isSeen = std::any_of(seen.begin(), seen.end(),
                                            [&](const Box3d& each) { return overlaps(each, box); });
            EXPECT_EQ(drawnOnce.contains(node), isIn && isSeen) << node;
            EXPECT_EQ(hiddenOnce.contains(node), isIn && !isSeen) << node;
        }
        drawn += frames.drawn.size();
        hidden += frames.hidden.size();
    }
    EXPECT_GT(drawn, 1000u);
    EXPECT_GT(hidden, 500u);
}

const RoomScene& rooms() {
    static const RoomScene scene;
    return scene;
}

struct Kind {
    const char* name;
    SlabsOptions options;
};

class SlabsPictures : public testing::TestWithParam<Kind> {};

// What everything drawn shows is what there is to see: each node of it must be drawn.
TEST_P(SlabsPictures, ShowWhatEverythingDrawnShows) {
    Rig culled(rooms()), whole(rooms());
    const auto slabs = makeStrategy("slabs", {.slabs = GetParam().options});
    const auto frustum = makeStrategy("frustum");
    uint64_t drawnNodes = 0, nodesInFrustum = 0;
    for (int i = 0; i < 24; ++i) {
        const Camera camera = rooms().walk(i, 24);
        const double tauPx = i % 3;
        const FrameRecord record = culled.settle(camera, *slabs, tauPx);
        ASSERT_TRUE(record.isSettled);
        nodesInFrustum += whole.settle(camera, *frustum, tauPx).drawnNodes;
        drawnNodes += record.drawnNodes;
        std::set<ooc::NodeId> drawn;
        for (const Node& node : culled.runner.cut().drawn()) {
            EXPECT_TRUE(drawn.insert(node.record->id).second) << "drawn twice";
        }
        const SoftwarePicture &a = culled.picture(), &b = whole.picture();
        ASSERT_EQ(a.depths, b.depths) << i;
        for (size_t p = 0; p < b.pixelCount(); ++p) {
            const bool isTied =
                a.nodeOrdinals[p] != 0 && b.nodeOrdinals[p] != 0 && a.nodeAt(p) != b.nodeAt(p);
            if (b.nodeOrdinals[p] != 0 && !isTied) {
                EXPECT_TRUE(drawn.contains(b.nodeAt(p)));
            }
        }
    }
    EXPECT_LT(3 * drawnNodes, 2 * nodesInFrustum);
}

TEST_P(SlabsPictures, SettleOverPagesThatFail) {
    RoomScene scene;
    size_t count = 0;
    for (const auto& [id, page] : scene.pages) {
        if (id != ooc::NodeId::root().value && ++count % 11 == 0) scene.failing.insert({id});
    }
    Rig rig(scene), leaves(rooms());
    const auto slabs = makeStrategy("slabs", {.slabs = GetParam().options});
    const auto frustum = makeStrategy("frustum");
    uint64_t standIns = 0;
    for (int i = 0; i < 12; ++i) {
        const Camera camera = rooms().walk(i, 12);
        const FrameRecord record = rig.settle(camera, *slabs, 1.0);
        standIns += record.standIns;
        static_cast<void>(leaves.settle(camera, *frustum, 0.0));
        EXPECT_EQ(test::holes(rig, leaves.picture()), 0u) << i;
    }
    EXPECT_GT(standIns, 12u);
}

// A closed room: all that is to be had lies in the cells that its walls meet.
TEST(Slabs, WhatLiesInHiddenCellsOnlyIsNeverRead) {
    const RoomScene closed(RoomScene::Options{.doorShare = 0.0});
    Rig rig(closed);
    const auto slabs = makeStrategy("slabs");
    const Vec3d eye = closed.roomCentre(2, 2);
    for (int i = 0; i < 40; ++i) {
        Camera camera = closed.walk(0, 1);
        camera.eye = eye;
        camera.target = eye + Vec3d(std::cos(0.16 * i), std::sin(0.16 * i), -0.1);
        ASSERT_TRUE(rig.settle(camera, *slabs, 0.0).isSettled);
    }
    const Box3d scene = closed.lattice.toModel(closed.record(ooc::NodeId::root()).box);
    const Vec3d size = scene.max - scene.min;
    const double cell = std::max(size.x, size.y) / SlabsOptions{}.resolution;
    const double room = closed.roomCentre(3, 2).x - eye.x;
    const Vec3d reach(0.5 * room + cell, 0.5 * room + cell, size.z);
    size_t leaves = 0, leavesRead = 0;
    for (const ooc::IndexBlock& block : closed.blocks) {
        for (const ooc::NodeRecord& record : block.nodes) {
            if (!record.isLeaf()) continue;
            ++leaves;
            if (!rig.loads.pages.contains(record.id)) continue;
            ++leavesRead;
            EXPECT_TRUE(overlaps(closed.lattice.toModel(record.box), {eye - reach, eye + reach}));
        }
    }
    EXPECT_GT(leavesRead, 10u);
    EXPECT_LT(4 * leavesRead, leaves);
}

INSTANTIATE_TEST_SUITE_P(
    , SlabsPictures,
    testing::Values(Kind{"uniform", {}}, Kind{"coarse", {.resolution = 6, .batch = 3}},
                    Kind{"nested", {.isNested = true, .splitTriangles = 150}},
                    Kind{"octree", {.isNested = true, .branching = 2, .splitTriangles = 50}},
                    Kind{"threshold", {.resolution = 20, .batch = 8, .queryTriangles = 50}}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace pagoda::hlod
