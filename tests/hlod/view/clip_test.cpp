// What is left out of a view is neither looked at nor asked for, by any strategy.
#include "hlod/view/clip.h"

#include "tests/hlod/software_rig.h"

#include <gtest/gtest.h>

#include <random>

namespace pagoda::hlod {
namespace {

using test::Rig;
using test::RoomScene;

const RoomScene& rooms() {
    static const RoomScene scene;
    return scene;
}

// Truth: corners, and points between them.
TEST(Clip, RemovesOnlyBoxesOfWhichNothingIsKept) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    const auto point = [&] { return Vec3d(number(random), number(random), number(random)); };
    int removed = 0;
    for (int i = 0; i < 5000; ++i) {
        Clip clip;
        if (i % 2 == 0) clip.section = SectionPlane{glm::normalize(point()), number(random)};
        if (i % 3 != 0) {
            Box3d kept;
            kept.extend(point());
            kept.extend(point());
            clip.box = kept;
        }
        Box3d box;
        box.extend(point());
        box.extend(0.5 * (point() + box.min));
        if (!clip.removes(box)) continue;
        ++removed;
        for (int sample = 0; sample < 125; ++sample) {
            const Vec3d share = Vec3d(sample % 5, sample / 5 % 5, sample / 25) / 4.0;
            const Vec3d p = glm::mix(box.min, box.max, share);
            const bool isKept = (!clip.section || clip.section->above(p) <= 0.0) &&
                                (!clip.box || clip.box->contains(p));
            ASSERT_FALSE(isKept);
        }
    }
    EXPECT_GT(removed, 500);
}

class ClipTest : public testing::TestWithParam<const char*> {};

Vec3d middle() {
    const Box3d box = rooms().lattice.toModel(rooms().record(ooc::NodeId::root()).box);
    return 0.5 * (box.min + box.max);
}

void expectNothingLeftOutIsRead(const Clip& clip, const char* name) {
    Rig rig(rooms()), whole(rooms());
    rig.runner.setPrefetch(true);
    const auto strategy = makeStrategy(name), other = makeStrategy(name);
    for (int i = 0; i < 8; ++i) {
        const Camera camera = rooms().walk(i, 8);
        static_cast<void>(rig.runner.settle(camera, *strategy, {.tauPx = 1.0, .clip = clip}));
        static_cast<void>(whole.runner.settle(camera, *other, {.tauPx = 1.0}));
    }
    size_t leftOut = 0;
    for (const auto& [id, times] : rig.loads.pages) {
        if (id == ooc::NodeId::root()) continue;
        EXPECT_FALSE(clip.removes(rooms().lattice.toModel(rooms().record(id).box)));
    }
    for (const auto& [id, times] : whole.loads.pages) {
        leftOut += clip.removes(rooms().lattice.toModel(rooms().record(id).box));
    }
    EXPECT_GT(leftOut, 3u) << "nothing would have been read there anyway";
}

TEST_P(ClipTest, WhatIsCutAwayIsNeverRead) {
    Clip clip;
    clip.section = SectionPlane{glm::normalize(Vec3d(1.0, 0.2, 0.0)), 0.0};
    clip.section->offset = glm::dot(clip.section->normal, middle());
    expectNothingLeftOutIsRead(clip, GetParam());
}

TEST_P(ClipTest, WhatLiesBesideAllThatIsShownIsNeverRead) {
    Clip clip;
    clip.box = Box3d{middle() - Vec3d(1e9), middle()};
    expectNothingLeftOutIsRead(clip, GetParam());
}

TEST_P(ClipTest, AnotherClipIsAnotherView) {
    Rig rig(rooms());
    const auto strategy = makeStrategy(GetParam());
    const Camera camera = rooms().walk(2, 8);
    Clip clip;
    clip.section = SectionPlane{Vec3d(0.0, 0.0, 1.0), middle().z};
    const FrameRecord all = rig.runner.settle(camera, *strategy, {.tauPx = 1.0});
    const FrameRecord cut = rig.runner.settle(camera, *strategy, {.tauPx = 1.0, .clip = clip});
    EXPECT_TRUE(cut.isSettled);
    EXPECT_GT(cut.culledNodes, all.culledNodes);
    // Who learns from what is drawn knows only the other view; who does not has all that it wants.
    EXPECT_EQ(rig.live(camera, *strategy, 1.0).isSettled, !strategy->learnsWhatIsHidden())
        << "it had another clip before";
}

INSTANTIATE_TEST_SUITE_P(Strategies, ClipTest,
                         testing::Values("frustum", "bool", "sw", "simp", "coh", "hzb", "late",
                                         "slabs"));

}  // namespace
}  // namespace pagoda::hlod
