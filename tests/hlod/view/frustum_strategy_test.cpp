// The frustum strategy, its cut and its faults, on small trees in memory.
#include "hlod/strategies/strategies.h"
#include "hlod/view/frame_cut.h"
#include "tests/viewer/inline_loads.h"
#include "tests/viewer/memory_scene.h"

#include <gtest/gtest.h>

#include <random>

namespace pagoda::hlod {
namespace {

using test::MemoryScene;

// Says what is drawn; pages are there unless the scene fails them, or the test keeps them away.
class RecordingSink final : public FrameSink {
public:
    explicit RecordingSink(const MemoryScene& scene) : scene_(scene) {}
    cache::PageState state(const Node& node) const override {
        if (scene_.failing.contains(node.record->id)) return cache::PageState::Failed;
        return absent.contains(node.record->id) ? cache::PageState::Absent
                                                : cache::PageState::Resident;
    }
    cache::PageState want(const Node& node, double, Use use) override {
        if (use == Use::Cut) wanted.insert(node.record->id);
        return state(node);
    }
    void keep(const Node&) override {}
    void refine(const Node& node) override { refined.insert(node.record->id); }
    void draw(const Node& node, Use use) override {
        cut.draw(node);
        standIns += use == Use::StandIn;
    }
    void hide(const Node&) override { ADD_FAILURE() << "nothing was tested"; }
    CountingVisibility* counting() override { return nullptr; }
    PyramidVisibility* pyramid() override { return nullptr; }
    FrameCut cut;
    std::set<ooc::NodeId> absent, wanted, refined;
    int standIns = 0;

private:
    const MemoryScene& scene_;
};

struct Frame {
    explicit Frame(MemoryScene& made, const Camera& camera)
        : scene(made),
          loads(scene),
          requests(loads, clock, {}),
          index(scene.lattice, scene, requests, uint64_t{1} << 30),
          tree(scene.lattice, index),
          view(camera, scene.lattice.toModel(scene.block.nodes[0].box)),
          sink(scene) {
        index.beginFrame(1);
        requests.beginFrame();
        static_cast<void>(tree.root());
        load();
    }
    void load() {
        requests.send([&](const cache::Request& request) { return index.admit(request); });
        std::vector<cache::RequestQueue::Arrival> arrivals;
        requests.collect(arrivals);
        for (cache::RequestQueue::Arrival& arrival : arrivals) index.arrive(arrival);
    }
    void traverse(double tauPx) {
        sink.cut.clear();
        sink.refined.clear();
        sink.wanted.clear();
        sink.standIns = 0;
        FrameContext context{view, tree, tauPx, 1, sink, record};
        strategy->traverse(context);
    }
    [[nodiscard]] std::set<ooc::NodeId> drawn() const {
        std::set<ooc::NodeId> ids;
        for (const Node& node : sink.cut.drawn()) EXPECT_TRUE(ids.insert(node.record->id).second);
        return ids;
    }
    MemoryScene& scene;
    test::InlineLoads loads;
    cache::ManualClock clock;
    cache::RequestQueue requests;
    cache::IndexCache index;
    NodeTree tree;
    View view;
    RecordingSink sink;
    FrameRecord record;
    std::unique_ptr<Strategy> strategy = makeStrategy("frustum");
};

MemoryScene sphereScene() {
    ooc::Lattice lattice;
    lattice.origin = Vec3d(-8);
    lattice.stepExponent = -6;
    lattice.extentBits = 10;
    return MemoryScene::make(lattice, test::bumpySphere(Vec3d(512), 300, 60), 200);
}

Camera lookFrom(const Vec3d& eye) {
    Camera camera;
    camera.eye = eye;
    camera.target = Vec3d(0);
    camera.up = Vec3d(0, 0.1, 1);
    return camera;
}

bool isBelow(ooc::NodeId node, ooc::NodeId ancestor) {
    while (node.depth() > ancestor.depth() || node.slot() != 0) node = node.parent();
    return node == ancestor;
}

TEST(FrustumStrategy, EveryLeafInTheFrustumIsDrawnOrStoodForByExactlyOneNode) {
    MemoryScene scene = sphereScene();
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-12, 12), tau(0.0, 40.0);
    for (int i = 0; i < 60; ++i) {
        Frame frame(scene, lookFrom({place(random), place(random), place(random)}));
        const double tauPx = i % 5 == 0 ? 0.0 : tau(random);
        frame.traverse(tauPx);
        const auto drawn = frame.drawn();
        for (const ooc::NodeRecord& record : scene.block.nodes) {
            const Box3d box = scene.lattice.toModel(record.box);
            const double ssePx = frame.view.ssePx(record.errorModelUnits, box);
            if (drawn.contains(record.id) && !record.isLeaf()) {
                EXPECT_LE(ssePx, tauPx);
                EXPECT_GT(tauPx, 0.0);
            }
            if (frame.sink.refined.contains(record.id) && !record.isLeaf()) {
                EXPECT_TRUE(ssePx > tauPx || tauPx == 0.0);
            }
            if (!record.isLeaf()) continue;
            const auto covering = std::count_if(drawn.begin(), drawn.end(), [&](ooc::NodeId node) {
                return isBelow(record.id, node);
            });
            EXPECT_LE(covering, 1);
            if (frame.view.intersectsFrustum(box)) {
                EXPECT_EQ(covering, 1);
            }
        }
    }
}

TEST(FrustumStrategy, AParentStandsInForAChildWhosePageFails) {
    MemoryScene scene = sphereScene();
    const auto leaf = std::find_if(scene.block.nodes.begin(), scene.block.nodes.end(),
                                   [](const ooc::NodeRecord& record) { return record.isLeaf(); });
    scene.failing.insert(leaf->id);
    Frame frame(scene, lookFrom({0, 0, 30}));
    frame.traverse(0.0);
    EXPECT_TRUE(frame.drawn().contains(leaf->id.parent()));
    EXPECT_EQ(frame.sink.standIns, 1);
    EXPECT_FALSE(frame.sink.refined.contains(leaf->id.parent()));
    for (const ooc::NodeRecord& record : scene.block.nodes) {
        if (!record.isLeaf()) continue;
        const bool isStoodFor = isBelow(record.id, leaf->id.parent());
        EXPECT_EQ(frame.drawn().contains(record.id), !isStoodFor);
    }
}

TEST(FrustumStrategy, TheNearestAncestorThatCanBeReadStandsIn) {
    MemoryScene scene = sphereScene();
    const ooc::NodeRecord& deepest = *std::max_element(
        scene.block.nodes.begin(), scene.block.nodes.end(),
        [](const ooc::NodeRecord& a, const ooc::NodeRecord& b) { return a.id < b.id; });
    scene.failing = {deepest.id, deepest.id.parent()};
    Frame frame(scene, lookFrom({0, 0, 30}));
    frame.traverse(0.0);
    EXPECT_TRUE(frame.drawn().contains(deepest.id.parent().parent()));
}

TEST(FrustumStrategy, DrawsNothingWhenEvenTheRootFails) {
    MemoryScene scene = sphereScene();
    for (const ooc::NodeRecord& record : scene.block.nodes) scene.failing.insert(record.id);
    Frame frame(scene, lookFrom({0, 0, 30}));
    frame.traverse(1.0);
    EXPECT_TRUE(frame.drawn().empty());
}

TEST(FrustumStrategy, AsksForTheWholePathWhileAnAncestorStandsIn) {
    MemoryScene scene = sphereScene();
    Frame frame(scene, lookFrom({0, 0, 30}));
    for (const ooc::NodeRecord& record : scene.block.nodes) {
        if (record.id != ooc::NodeId::root()) frame.sink.absent.insert(record.id);
    }
    frame.traverse(0.0);
    EXPECT_EQ(frame.drawn(), std::set{ooc::NodeId::root()});
    EXPECT_EQ(frame.sink.standIns, 1);
    for (const ooc::NodeRecord& record : scene.block.nodes) {
        EXPECT_EQ(frame.sink.wanted.contains(record.id), record.isLeaf());
    }
}

TEST(FrustumStrategy, WhatWasRefinedStaysAndAMissingChildHasAStandInBesideTheOthers) {
    MemoryScene scene = sphereScene();
    Frame frame(scene, lookFrom({0, 0, 30}));
    frame.traverse(0.0);
    const std::set<ooc::NodeId> before = frame.drawn();
    const ooc::NodeId gone = *before.rbegin();
    frame.sink.absent.insert(gone);
    frame.traverse(0.0);
    std::set<ooc::NodeId> expected = before;
    expected.erase(gone);
    expected.insert(gone.parent());
    EXPECT_EQ(frame.drawn(), expected);
    EXPECT_EQ(frame.sink.standIns, 1);
    frame.strategy->forget();
    frame.traverse(0.0);  // without that memory the parent stands in alone
    EXPECT_FALSE(frame.drawn().contains(gone.parent().child(0)));
    EXPECT_TRUE(frame.drawn().contains(gone.parent()));
}

TEST(NodeTree, ABrokenBlockStopsRefinementThere) {
    MemoryScene scene = sphereScene();
    scene.block.nodes[0].childBlock = 7;
    Frame frame(scene, lookFrom({0, 0, 30}));
    frame.traverse(0.0);
    EXPECT_EQ(frame.drawn(), std::set{ooc::NodeId::root()});
    EXPECT_EQ(frame.sink.standIns, 1);
    ASSERT_EQ(frame.index.faults().size(), 1u);
    EXPECT_EQ(frame.index.faults().front().block, 7u);
}

TEST(NodeTree, HostileRecordsEndRefinementInsteadOfLeadingInCircles) {
    const auto drawn = [](auto&& spoil) {
        MemoryScene scene = sphereScene();
        spoil(scene.block.nodes);
        Frame frame(scene, lookFrom({0, 0, 30}));
        frame.traverse(0.0);
        EXPECT_FALSE(frame.index.faults().empty());
        return frame.drawn();
    };
    const std::set root{ooc::NodeId::root()};
    EXPECT_EQ(drawn([](auto& nodes) { nodes[0].childIndex = 0; }), root);
    EXPECT_EQ(drawn([](auto& nodes) { nodes[0].childIndex = UINT32_MAX; }), root);
    EXPECT_EQ(drawn([](auto& nodes) { nodes[0].childMask |= 15u << 8; }), root);
    EXPECT_EQ(drawn([](auto& nodes) { nodes[1].id = ooc::NodeId::root(); }), root);
    EXPECT_GT(drawn([](auto& nodes) { nodes[1].childIndex = nodes[0].childIndex; }).size(), 1u);
}

TEST(FrameCut, ALeafThatIsDrawnCountsAsRefinedAndAStandInDoesNot) {
    const ooc::NodeRecord leaf{.id = ooc::NodeId::root().child(1), .flags = ooc::kNodeHasZippers};
    const ooc::NodeRecord inner{
        .id = ooc::NodeId::root().child(2), .childMask = 1, .flags = ooc::kNodeHasZippers};
    FrameCut cut;
    cut.draw({&leaf, nullptr, 0, 0});
    cut.draw({&inner, nullptr, 0, 1});
    EXPECT_TRUE(cut.refined({0, leaf.id}));
    EXPECT_FALSE(cut.refined({0, inner.id}));
    EXPECT_FALSE(cut.refined({0, leaf.id.child(0)}));
    EXPECT_FALSE(cut.refined({1, leaf.id}));
}

}  // namespace
}  // namespace pagoda::hlod
