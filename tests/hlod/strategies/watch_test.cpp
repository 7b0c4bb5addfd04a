// What frames note of a node that is asked about.
#include "tests/hlod/software_rig.h"

#include "hlod/strategies/bias.h"
#include "hlod/view/screen_box.h"

#include <gtest/gtest.h>

namespace pagoda::hlod {
namespace {

using test::Rig;
using test::RoomScene;

const RoomScene& rooms() {
    static const RoomScene scene;
    return scene;
}

class WatchTest : public testing::TestWithParam<const char*> {};

// Every node of a settled cut in turn: what is noted of it is what the cut and the answers say.
TEST_P(WatchTest, SaysOfANodeWhatTheFrameDidWithIt) {
    Rig rig(rooms());
    const auto strategy = makeStrategy(GetParam());
    const Camera camera = rooms().walk(3, 8);
    FrameRecord record = rig.runner.settle(camera, *strategy, {.tauPx = 1.0});
    const View view(camera, rig.runner.sceneBoxModel());
    std::vector<ooc::NodeId> drawn, hidden;
    for (const Node& node : rig.runner.cut().drawn()) drawn.push_back(node.record->id);
    for (const Node& node : rig.runner.cut().hidden()) hidden.push_back(node.record->id);
    ASSERT_GT(drawn.size(), 10u);
    int weighed = 0;
    for (const ooc::NodeId id : drawn) {
        NodeWatch watch;
        watch.page = {0, id};
        record = rig.runner.run(camera, *strategy, {.tauPx = 1.0, .watch = &watch});
        EXPECT_EQ(watch.drawnFrame, record.frameIndex);
        EXPECT_EQ(watch.wantedFrame, record.frameIndex);
        EXPECT_EQ(watch.refinedFrame, 0u);
        EXPECT_EQ(watch.hiddenFrame, 0u);
        if (std::string(GetParam()) == "frustum") {
            EXPECT_EQ(watch.answeredFrame, 0u);
            continue;
        }
        EXPECT_EQ(watch.predictedFrame, record.frameIndex);
        EXPECT_EQ(watch.answeredFrame, record.frameIndex);
        const Box3d box = rooms().lattice.toModel(rooms().record(id).box);
        EXPECT_EQ(watch.isUnasked, crossesNear(view, box));
        if (watch.isUnasked) continue;
        ++weighed;
        EXPECT_DOUBLE_EQ(watch.outlinePx, boxPixels(view, box));
        const double share = std::min(1.0, static_cast<double>(watch.visiblePx) / watch.outlinePx);
        EXPECT_DOUBLE_EQ(watch.relativeVisibility, share);
        const StrategyOptions usual;
        EXPECT_DOUBLE_EQ(watch.bias,
                         std::max(sigmoidBias(share, usual.biasS, usual.biasT), usual.biasFloor));
    }
    for (const ooc::NodeId id : hidden) {
        NodeWatch watch;
        watch.page = {0, id};
        record = rig.runner.run(camera, *strategy, {.tauPx = 1.0, .watch = &watch});
        EXPECT_EQ(watch.hiddenFrame, record.frameIndex);
        EXPECT_EQ(watch.visiblePx, 0u);
        EXPECT_EQ(watch.drawnFrame, 0u);
    }
    if (std::string(GetParam()) != "frustum") {
        EXPECT_GT(weighed, 5);
        EXPECT_GT(hidden.size(), 3u);
    }
}

INSTANTIATE_TEST_SUITE_P(Strategies, WatchTest, testing::Values("frustum", "sw", "coh", "hzb"));

}  // namespace
}  // namespace pagoda::hlod
