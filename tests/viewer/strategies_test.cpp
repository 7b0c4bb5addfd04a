// Strategies on OpenGL: their pictures against the cut at tau, and against their own cut without
// culling, whatever the latency of answers.
#include "hlod/strategies/strategies.h"
#include "hlod/strategies/replay.h"
#include "tests/viewer/gl_fixture.h"
#include "tests/viewer/memory_scene.h"
#include "viewer/renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace pagoda::viewer {
namespace {

using test::MemoryScene;

class StrategiesTest : public GlTest {};

constexpr int kSteps = 10;  // of a tenth of a radian

// Spheres in a ring behind walls: much of it is hidden from anywhere.
MemoryScene hiddenSpheres() {
    ooc::Lattice lattice;
    lattice.origin = Vec3d(0);
    lattice.stepExponent = -8;
    lattice.extentBits = 10;
    std::vector<test::Triangle> triangles;
    for (int i = 0; i < 8; ++i) {
        const double angle = 0.785398 * i;
        const Vec3d centre(512 + 330 * std::cos(angle), 512 + 330 * std::sin(angle), 512);
        for (const test::Triangle& t : test::bumpySphere(centre, 90, 20)) triangles.push_back(t);
    }
    const auto wall = [&](Vec3i a, Vec3i b, Vec3i c, Vec3i d) {
        triangles.push_back({{a, b, c}, 0xFF808080u});
        triangles.push_back({{a, c, d}, 0xFF808080u});
    };
    wall({512, 100, 300}, {512, 900, 300}, {512, 900, 724}, {512, 100, 724});
    wall({100, 512, 300}, {900, 512, 300}, {900, 512, 724}, {100, 512, 724});
    return MemoryScene::make(lattice, triangles, 150);
}

hlod::Camera cameraAt(int step) {
    hlod::Camera camera;
    const double angle = 0.1 * step;
    camera.eye = Vec3d(2.0 + 2.2 * std::cos(angle), 2.0 + 2.2 * std::sin(angle), 2.3);
    camera.target = Vec3d(2.0);
    camera.up = Vec3d(0, 0, 1);
    camera.widthPx = 200;
    camera.heightPx = 150;
    return camera;
}

ooc::NodeId nodeAt(const Picture& picture, size_t pixel) {
    const uint32_t ordinal = picture.nodeOrdinals[pixel];
    return ordinal == 0 ? ooc::NodeId{} : picture.nodes.at(ordinal - 1);
}

bool isSame(const Picture& a, const Picture& b, size_t pixel) {
    return nodeAt(a, pixel) == nodeAt(b, pixel) && a.triangles[pixel] == b.triangles[pixel];
}

TEST_F(StrategiesTest, BoolsSettledPictureIsTheCutAtTauBitForBit) {
    MemoryScene scene = hiddenSpheres();
    Renderer plain(scene.lattice, scene, {}), culled(scene.lattice, scene, {});
    const auto frustum = hlod::makeStrategy("frustum"), coherent = hlod::makeStrategy("bool");
    for (int step = 0; step < 40; step += 8) {
        hlod::FrameRecord a = plain.render(cameraAt(step), *frustum, {.tauPx = 0.5});
        hlod::FrameRecord b = culled.render(cameraAt(step), *coherent, {.tauPx = 0.5});
        EXPECT_TRUE(a.isSettled);
        EXPECT_TRUE(b.isSettled);
        EXPECT_LT(b.drawnNodes, a.drawnNodes);
        const auto loaded = [](Renderer& renderer) {
            return renderer.runner().streaming().residency().counters().loadedPages;
        };
        if (step == 0) {
            EXPECT_LT(loaded(culled), loaded(plain));  // later both have been all around
        }
        const Picture expected = plain.read(a), picture = culled.read(b);
        EXPECT_EQ(picture.colours, expected.colours);
        EXPECT_EQ(picture.depthsModelUnits, expected.depthsModelUnits);
        EXPECT_EQ(picture.triangles, expected.triangles);
    }
}

// Pixels of a walk around the scene that are not those of the strategy's own cut without culling:
// none.
void expectNoWrongPixel(const char* name, const RendererOptions& options) {
    MemoryScene scene = hiddenSpheres();
    Renderer truth(scene.lattice, scene, {}), renderer(scene.lattice, scene, options);
    const auto strategy = hlod::makeStrategy(name);
    size_t wrong = 0, covered = 0, hidden = 0;
    for (int step = 0; step < kSteps; ++step) {
        hlod::FrameRecord record = renderer.renderLive(cameraAt(step), *strategy, {});
        const Picture picture = renderer.read(record);
        hlod::ReplayStrategy replay(renderer.runner().cut());
        hlod::FrameRecord truthRecord = truth.render(cameraAt(step), replay, {});
        const Picture expected = truth.read(truthRecord);
        covered += record.coveredPixels;
        hidden += record.hiddenNodes;
        for (size_t i = 0; i < picture.pixelCount(); ++i) {
            const bool isOverdrawn =
                replay.overdrawn().contains(cache::PageId{0, nodeAt(picture, i)});
            wrong += !isSame(picture, expected, i) && !isOverdrawn &&
                     picture.depthsModelUnits[i] != expected.depthsModelUnits[i];
        }
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(covered, kSteps * 5000u);
    EXPECT_GT(hidden, size_t{kSteps});
}

TEST_F(StrategiesTest, NoPixelIsWrongAtAnyLatency) {
    for (const char* name : {"bool", "sw", "coh", "hzb", "late", "slabs"}) {
        for (const uint32_t latency : {0u, 1u, 2u, 4u}) {
            SCOPED_TRACE(name + (" at latency " + std::to_string(latency)));
            expectNoWrongPixel(name, {.queryLatencyFrames = latency});
        }
    }
}

TEST_F(StrategiesTest, NoPixelIsWrongWhereverThePyramidIsAndWhateverIsPushed) {
    for (const char* name : {"hzb", "late"}) {
        for (const PyramidPlace place : {PyramidPlace::Cpu, PyramidPlace::Gpu}) {
            for (const bool pushes : {false, true}) {
                SCOPED_TRACE(std::string(name) + (place == PyramidPlace::Gpu ? " gpu" : " cpu") +
                             (pushes ? " pushed" : ""));
                expectNoWrongPixel(name, {.pyramid = {place, pushes}});
            }
        }
    }
}

TEST_F(StrategiesTest, AnswersThatAreWaitedForCostSimulatedTime) {
    MemoryScene scene = hiddenSpheres();
    RendererOptions options;
    options.queryLatencyFrames = 2;
    Renderer renderer(scene.lattice, scene, options);
    const auto strategy = hlod::makeStrategy("sw");
    static_cast<void>(renderer.renderLive(cameraAt(0), *strategy, {}));
    EXPECT_GT(renderer.renderLive(cameraAt(1), *strategy, {}).simulatedStallMs, 0.0);
}

TEST_F(StrategiesTest, ATightBudgetChangesTauAndNothingElse) {
    MemoryScene scene = hiddenSpheres();
    Renderer tight(scene.lattice, scene, {.gpuBytes = uint64_t{1} << 20});
    Renderer roomy(scene.lattice, scene, {});
    const auto strategy = hlod::makeStrategy("frustum"), same = hlod::makeStrategy("frustum");
    for (int step = 0; step < 40; step += 5) {
        hlod::FrameRecord a = tight.render(cameraAt(step), *strategy, {.tauPx = 0.0});
        EXPECT_LE(a.gpuBytes, uint64_t{1} << 20);
        EXPECT_EQ(a.standIns, 0u);
        hlod::FrameRecord b = roomy.render(cameraAt(step), *same, {.tauPx = a.effectiveTauPx});
        EXPECT_EQ(tight.read(a).colours, roomy.read(b).colours) << "step " << step;
    }
}

}  // namespace
}  // namespace pagoda::viewer
