// Boxes tested on the GPU against the same boxes counted pixel by pixel on the CPU, over random
// views, boxes and depths, and what pushed occluders keep.
#include "hlod/raster/pushed_depths.h"
#include "hlod/strategies/strategies.h"
#include "hlod/view/screen_box.h"
#include "tests/hlod/raster/raster_cases.h"
#include "tests/viewer/gl_fixture.h"
#include "tests/viewer/memory_scene.h"
#include "viewer/gpu_depth_tests.h"
#include "viewer/renderer.h"

#include <gtest/gtest.h>

#include <epoxy/gl.h>

#include <algorithm>

namespace pagoda::viewer {
namespace {

using hlod::test::Cases;
using test::MemoryScene;
using test::Triangle;

class DepthTestsTest : public GlTest {};

constexpr uint32_t kOrdinals = 5;

struct Frame {
    std::vector<float> depths;
    std::vector<uint32_t> ordinals;
};

// Slanted rectangles before each other, some of them ragged, with the ids of what drew them.
Frame frameOf(Cases& cases, const hlod::View& view) {
    const int width = view.camera().widthPx, height = view.camera().heightPx;
    Frame frame;
    frame.depths.assign(static_cast<size_t>(width) * static_cast<size_t>(height), 0.0f);
    frame.ordinals.assign(frame.depths.size(), 0);
    const double near = view.nearModelUnits();
    for (int layer = cases.whole(0, 8); layer > 0; --layer) {
        const int x0 = cases.whole(-width / 2, width - 1), x1 = cases.whole(x0, 2 * width);
        const int y0 = cases.whole(-height / 2, height - 1), y1 = cases.whole(y0, 2 * height);
        const double first = near / cases.real(10, 1500), last = near / cases.real(10, 1500);
        const bool isRagged = cases.whole(0, 3) == 0;
        const auto ordinal = static_cast<uint32_t>(cases.whole(1, kOrdinals));
        for (int y = std::max(y0, 0); y <= std::min(y1, height - 1); ++y) {
            for (int x = std::max(x0, 0); x <= std::min(x1, width - 1); ++x) {
                if (isRagged && cases.whole(0, 15) == 0) continue;
                const double share = (x - x0) / (x1 - x0 + 1.0);
                const auto depth = static_cast<float>(first + share * (last - first));
                const size_t at =
                    static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
                if (depth <= frame.depths[at]) continue;
                frame.depths[at] = depth;
                frame.ordinals[at] = ordinal;
            }
        }
    }
    return frame;
}

void upload(const Frame& frame, const FrameTarget& target) {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(target.depthTexture(), 0, 0, 0, target.widthPx(), target.heightPx(),
                        GL_DEPTH_COMPONENT, GL_FLOAT, frame.depths.data());
    glTextureSubImage2D(target.nodeOrdinalTexture(), 0, 0, 0, target.widthPx(), target.heightPx(),
                        GL_RED_INTEGER, GL_UNSIGNED_INT, frame.ordinals.data());
}

struct Agreement {
    int asked = 0, hidden = 0, falselySeen = 0, equal = 0;
    double sum = 0, sumOfTruth = 0;
};

// Boxes of one frame, tested at once.
void compare(Cases& cases, GpuDepthTests& gpu, const FrameTarget& target, bool doesPush,
             Agreement& agreement) {
    hlod::Camera camera = cases.view().camera();
    camera.widthPx = target.widthPx();
    camera.heightPx = target.heightPx();
    const hlod::View view(camera, Box3d{Vec3d(0), Vec3d(1024)});
    Frame frame = frameOf(cases, view);
    upload(frame, target);
    std::vector<float> pushes(1, 0.0f);
    while (pushes.size() <= kOrdinals) {
        pushes.push_back(hlod::depthPush(cases.real(0, 100), view.nearModelUnits()));
    }
    gpu.beginFrame(view, target, doesPush ? &pushes : nullptr);
    gpu.build();
    if (doesPush) hlod::pushDepths(frame.depths, frame.ordinals, pushes);
    hlod::BoxRaster raster;
    raster.setDepths(view, frame.depths);

    std::vector<Box3d> boxes;
    while (boxes.size() < 100) {
        const Box3i lattice = cases.box();
        const Box3d box{Vec3d(lattice.min), Vec3d(lattice.max)};
        if (!crossesNear(view, box) && view.intersectsFrustum(box)) boxes.push_back(box);
        if (cases.whole(0, 999) == 0) break;  // a view that sees none
    }
    std::vector<uint64_t> pixels(boxes.size()), truth(boxes.size());
    const size_t half = boxes.size() / 2;  // a later batch sees the same depths
    gpu.visiblePixels(std::span(boxes).first(half), std::span(pixels).first(half));
    gpu.visiblePixels(std::span(boxes).subspan(half), std::span(pixels).subspan(half));
    raster.visiblePixels(boxes, truth);
    for (size_t i = 0; i < boxes.size(); ++i) {
        ASSERT_GE(pixels[i], truth[i]) << "box " << i;
        ++agreement.asked;
        agreement.hidden += truth[i] == 0;
        agreement.falselySeen += truth[i] == 0 && pixels[i] > 0;
        agreement.equal += truth[i] == pixels[i];
        agreement.sum += static_cast<double>(pixels[i]);
        agreement.sumOfTruth += static_cast<double>(truth[i]);
    }
}

TEST_F(DepthTestsTest, TheGpuNeverHidesNorCountsLessThanTheCpuAndHardlyCountsMore) {
    Cases cases(21);
    GpuDepthTests gpu([] {}, [] {});
    Agreement all;
    for (const auto& [width, height] : {std::pair{61, 47}, {1, 1}, {640, 480}, {1030, 33}}) {
        const FrameTarget target(width, height);
        for (int i = 0; i < 24; ++i) compare(cases, gpu, target, i % 2 == 1, all);
    }
    throwOnGlError("the tests");
    EXPECT_GT(all.asked, 3000);
    EXPECT_GT(all.hidden, all.asked / 10);
    EXPECT_GT(all.asked - all.hidden, all.asked / 10);
    // Planes are rounded outwards by a thousandth of a pixel at most.
    EXPECT_LT(all.falselySeen, all.asked / 100);
    EXPECT_GT(all.equal, all.asked * 9 / 10);
    EXPECT_LT(all.sum, 1.01 * all.sumOfTruth);
}

// A wall, drawn a hundred steps before where its leaf has it, and a small panel between the two.
struct PushScene {
    static constexpr int kCoarse = 600, kTrue = 500, kPanel = 550;
    MemoryScene scene;
    ooc::NodeId wall = ooc::NodeId::root().child(0), panel = ooc::NodeId::root().child(1);

    static std::vector<Triangle> square(int low, int high, int z) {
        const Vec3i a(low, low, z), b(high, low, z), c(high, high, z), d(low, high, z);
        return {{{a, b, c}}, {{a, c, d}}};
    }
    PushScene() {
        scene.lattice.stepExponent = 0;
        scene.lattice.extentBits = 10;
        scene.block.nodes.resize(4);
        const auto coarse = square(100, 900, kCoarse), fine = square(100, 900, kTrue);
        const auto small = square(450, 550, kPanel);
        scene.setNode(0, ooc::NodeId::root(), coarse, 10000.0);
        scene.setNode(1, wall, coarse, kCoarse - kTrue);
        scene.setNode(2, panel, small, 0.0);
        scene.setNode(3, wall.child(0), fine, 0.0);
        scene.block.nodes[0].childMask = 3;
        scene.block.nodes[0].childIndex = 1;
        scene.block.nodes[1].childMask = 1;
        scene.block.nodes[1].childIndex = 3;
        scene.block.nodes[1].box.extend(scene.block.nodes[3].box);
        scene.block.nodes[0].box.extend(scene.block.nodes[1].box);
    }
    static hlod::Camera camera() {
        hlod::Camera camera;
        camera.eye = Vec3d(512, 512, 2000);
        camera.target = Vec3d(512, 512, 0);
        camera.widthPx = 200;
        camera.heightPx = 150;
        return camera;
    }
    // The wall may be coarse, the root may not.
    static constexpr double kTauPx = 30.0;

    [[nodiscard]] bool showsPanel(const char* strategyName, const PyramidOptions& pyramid,
                                  double tauPx) const {
        Renderer renderer(scene.lattice, scene, {.pyramid = pyramid});
        const auto strategy = hlod::makeStrategy(strategyName);
        const hlod::FrameRecord record = renderer.render(camera(), *strategy, {.tauPx = tauPx});
        EXPECT_TRUE(record.isSettled);
        const auto drawn = renderer.runner().cut().drawn();
        const auto draws = [&](ooc::NodeId id) {
            return std::any_of(drawn.begin(), drawn.end(),
                               [&](const hlod::Node& node) { return node.record->id == id; });
        };
        EXPECT_TRUE(draws(tauPx > 0.0 ? wall : wall.child(0)));
        return draws(panel);
    }
};

TEST_F(DepthTestsTest, WhatTheFullModelShowsIsHiddenByACoarseOccluderUnlessItIsPushedBack) {
    const PushScene made;
    for (const char* name : {"hzb", "late"}) {
        for (const PyramidPlace place : {PyramidPlace::Cpu, PyramidPlace::Gpu}) {
            EXPECT_TRUE(made.showsPanel(name, {place, false}, 0.0)) << name;
            EXPECT_FALSE(made.showsPanel(name, {place, false}, PushScene::kTauPx)) << name;
            EXPECT_TRUE(made.showsPanel(name, {place, true}, PushScene::kTauPx)) << name;
        }
    }
}

}  // namespace
}  // namespace pagoda::viewer
