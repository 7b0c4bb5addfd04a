// The frustum strategy, its cut and its faults, on small trees in memory.
#include "hlod/strategies/strategies.h"
#include "hlod/view/frame_cut.h"
#include "tests/viewer/memory_scene.h"

#include <gtest/gtest.h>

#include <random>

namespace pagoda::hlod {
namespace {

using test::MemoryScene;

// Says what is drawn; pages are there unless the scene fails them.
class RecordingSink final : public FrameSink {
public:
    explicit RecordingSink(const MemoryScene& scene) : scene_(scene) {}
    cache::PageState want(const Node& node, double) override {
        ++wanted;
        if (wanted > roomFor) return cache::PageState::NoRoom;
        return scene_.failing.contains(node.record->id) ? cache::PageState::Failed
                                                        : cache::PageState::Resident;
    }
    void refine(const Node& node) override { cut.refine(node); }
    void draw(const Node& node) override { cut.draw(node); }
    CountingVisibility* visibility() override { return nullptr; }
    FrameCut cut;
    int wanted = 0, roomFor = 1 << 30;

private:
    const MemoryScene& scene_;
};

struct Frame {
    explicit Frame(MemoryScene& made, const Camera& camera)
        : scene(made),
          index(scene),
          tree(scene.lattice, index),
          view(camera, tree.boxModel(tree.root())),
          sink(scene) {}
    bool traverse(double tauPx) {
        FrameContext context{view, tree, tauPx, sink, record};
        return makeStrategy("frustum")->traverse(context);
    }
    [[nodiscard]] std::set<ooc::NodeId> drawn() const {
        std::set<ooc::NodeId> ids;
        for (const Node& node : sink.cut.drawn()) EXPECT_TRUE(ids.insert(node.record->id).second);
        return ids;
    }
    MemoryScene& scene;
    cache::IndexCache index;
    NodeTree tree;
    View view;
    RecordingSink sink;
    FrameRecord record;
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
        ASSERT_TRUE(frame.traverse(tauPx));
        const auto drawn = frame.drawn();
        for (const ooc::NodeRecord& record : scene.block.nodes) {
            const Box3d box = scene.lattice.toModel(record.box);
            const double ssePx = frame.view.ssePx(record.errorModelUnits, box);
            if (drawn.contains(record.id) && !record.isLeaf()) {
                EXPECT_LE(ssePx, tauPx);
                EXPECT_GT(tauPx, 0.0);
            }
            if (frame.sink.cut.refined({0, record.id}) && !record.isLeaf()) {
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
    ASSERT_TRUE(frame.traverse(0.0));
    EXPECT_TRUE(frame.drawn().contains(leaf->id.parent()));
    EXPECT_EQ(frame.record.standIns, 1u);
    EXPECT_FALSE(frame.sink.cut.refined({0, leaf->id.parent()}));
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
    ASSERT_TRUE(frame.traverse(0.0));
    EXPECT_TRUE(frame.drawn().contains(deepest.id.parent().parent()));
}

TEST(FrustumStrategy, DrawsNothingWhenEvenTheRootFails) {
    MemoryScene scene = sphereScene();
    for (const ooc::NodeRecord& record : scene.block.nodes) scene.failing.insert(record.id);
    Frame frame(scene, lookFrom({0, 0, 30}));
    ASSERT_TRUE(frame.traverse(1.0));
    EXPECT_TRUE(frame.drawn().empty());
}

TEST(FrustumStrategy, AsksForACoarserCutWhenThereIsNoRoom) {
    MemoryScene scene = sphereScene();
    Frame frame(scene, lookFrom({0, 0, 30}));
    frame.sink.roomFor = 3;
    EXPECT_FALSE(frame.traverse(0.0));
}

TEST(NodeTree, ABrokenBlockStopsRefinementThere) {
    MemoryScene scene = sphereScene();
    scene.block.nodes[0].childBlock = 7;
    Frame frame(scene, lookFrom({0, 0, 30}));
    ASSERT_TRUE(frame.traverse(0.0));
    EXPECT_EQ(frame.drawn(), std::set{ooc::NodeId::root()});
    EXPECT_EQ(frame.record.standIns, 1u);
    ASSERT_EQ(frame.index.faults().size(), 1u);
    EXPECT_EQ(frame.index.faults().front().block, 7u);
}

TEST(NodeTree, HostileRecordsEndRefinementInsteadOfLeadingInCircles) {
    const auto drawn = [](auto&& spoil) {
        MemoryScene scene = sphereScene();
        spoil(scene.block.nodes);
        Frame frame(scene, lookFrom({0, 0, 30}));
        EXPECT_TRUE(frame.traverse(0.0));
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
    const ooc::NodeRecord leaf{.id = ooc::NodeId::root().child(1)};
    const ooc::NodeRecord inner{.id = ooc::NodeId::root().child(2), .childMask = 1};
    FrameCut cut;
    cut.draw({&leaf, 0});
    cut.draw({&inner, 0});
    EXPECT_TRUE(cut.refined({0, leaf.id}));
    EXPECT_FALSE(cut.refined({0, inner.id}));
    EXPECT_FALSE(cut.refined({0, leaf.id.child(0)}));
    EXPECT_FALSE(cut.refined({1, leaf.id}));
}

}  // namespace
}  // namespace pagoda::hlod
