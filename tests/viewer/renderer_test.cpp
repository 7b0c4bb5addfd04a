#include "viewer/renderer.h"

#include "hlod/strategies/replay.h"
#include "hlod/strategies/strategies.h"
#include "tests/viewer/gl_fixture.h"
#include "tests/viewer/memory_scene.h"

#include <cmath>
#include <random>

namespace pagoda::viewer {
namespace {

using test::MemoryScene;
using test::Triangle;

class RendererTest : public GlTest {};

ooc::Lattice unitLattice(const Vec3d& origin = Vec3d(0.0)) {
    ooc::Lattice lattice;
    lattice.origin = origin;
    lattice.stepExponent = -20;
    lattice.extentBits = 21;  // two units wide
    return lattice;
}

// A sphere of one unit across around `origin` + 1.
MemoryScene sphereScene(const Vec3d& origin = Vec3d(0.0), int rings = 60) {
    return MemoryScene::make(unitLattice(origin), test::bumpySphere(Vec3d(1 << 20), 1 << 19, rings),
                             150);
}

hlod::Camera lookAt(const Vec3d& target, const Vec3d& offset, int widthPx = 320,
                    int heightPx = 240) {
    hlod::Camera camera;
    camera.eye = target + offset;
    camera.target = target;
    camera.up = Vec3d(0.05, 0.1, 1);
    camera.widthPx = widthPx;
    camera.heightPx = heightPx;
    return camera;
}

struct Result {
    hlod::FrameRecord record;
    Picture picture;
};

Result render(Renderer& renderer, const hlod::Camera& camera, double tauPx) {
    Result result;
    result.record =
        renderer.render(camera, *hlod::makeStrategy("frustum"), {.tauPx = tauPx, .background = {}});
    result.picture = renderer.read(result.record);
    return result;
}

Result renderReference(Renderer& renderer, const hlod::Camera& camera) {
    Result result;
    result.record = renderer.renderReference(camera, {});
    result.picture = renderer.read(result.record);
    return result;
}

size_t differentPixels(const Picture& a, const Picture& b) {
    size_t count = 0;
    for (size_t i = 0; i < a.pixelCount(); ++i) {
        if (!std::equal(&a.colours[4 * i], &a.colours[4 * i] + 4, &b.colours[4 * i])) ++count;
    }
    return count;
}

// The node at a pixel, 0 for none.
uint64_t nodeAt(const Picture& picture, size_t pixel) {
    const uint32_t ordinal = picture.nodeOrdinals[pixel];
    return ordinal == 0 ? 0 : picture.nodes.at(ordinal - 1).value;
}

TEST_F(RendererTest, TheReferenceIsTheCutAtTauZero) {
    MemoryScene scene = sphereScene();
    Renderer renderer(scene.lattice, scene, {});
    for (const Vec3d& offset : {Vec3d(2, 1, 0.5), Vec3d(0.55, 0, 0), Vec3d(0, 0, 0.1)}) {
        const hlod::Camera camera = lookAt(Vec3d(1.0), offset);
        const Result cut = render(renderer, camera, 0.0),
                     reference = renderReference(renderer, camera);
        EXPECT_GT(cut.record.coveredPixels, 10000u);
        EXPECT_EQ(cut.record.drawnTriangles, reference.record.drawnTriangles);
        EXPECT_EQ(cut.picture.colours, reference.picture.colours);
        EXPECT_EQ(cut.picture.depthsModelUnits, reference.picture.depthsModelUnits);
        EXPECT_EQ(cut.picture.triangles, reference.picture.triangles);
        for (size_t i = 0; i < cut.picture.pixelCount(); ++i) {
            ASSERT_EQ(nodeAt(cut.picture, i), nodeAt(reference.picture, i)) << "pixel " << i;
        }
    }
}

TEST_F(RendererTest, TheReferenceInASmallBudgetIsTheSamePicture) {
    MemoryScene scene = sphereScene({}, 150);
    const hlod::Camera camera = lookAt(Vec3d(1.0), {2, 1, 0.5});
    Renderer roomy(scene.lattice, scene, {});
    Renderer tight(scene.lattice, scene, {.hostBytes = 0, .gpuBytes = 1 << 20});
    int batches = 0;
    Result small;
    small.record = tight.renderReference(camera, {}, [&] { ++batches; });
    small.picture = tight.read(small.record);
    const Result large = renderReference(roomy, camera);
    EXPECT_GT(large.record.gpuBytes, uint64_t{2} << 20);
    EXPECT_GT(batches, 3);
    EXPECT_LE(small.record.gpuBytes, uint64_t{1} << 20);
    EXPECT_EQ(small.record.loadedPages, large.record.loadedPages);
    EXPECT_EQ(differentPixels(small.picture, large.picture), 0u);
    EXPECT_EQ(small.picture.triangles, large.picture.triangles);
}

TEST_F(RendererTest, RaisesTauUntilTheCutFitsAndSaysSo) {
    MemoryScene scene = sphereScene({}, 150);
    Renderer renderer(scene.lattice, scene, {.hostBytes = 0, .gpuBytes = 1 << 20});
    const Result result = render(renderer, lookAt(Vec3d(1.0), {2, 1, 0.5}), 0.0);
    EXPECT_EQ(result.record.tauPx, 0.0);
    EXPECT_GT(result.record.effectiveTauPx, 0.0);
    EXPECT_LE(result.record.gpuBytes, uint64_t{1} << 20);
    EXPECT_GT(result.record.coveredPixels, 10000u);
    EXPECT_TRUE(result.record.faults.empty());
}

TEST_F(RendererTest, TheSameFrameGivesTheSamePicture) {
    MemoryScene scene = sphereScene();
    const hlod::Camera camera = lookAt(Vec3d(1.0), {1, 1, 0.5});
    Renderer first(scene.lattice, scene, {}), second(scene.lattice, scene, {});
    const Result a = render(first, camera, 2.0);
    static_cast<void>(render(second, lookAt(Vec3d(1.0), {-1, 0, 0.5}), 1.0));  // another history
    const Result b = render(second, camera, 2.0);
    EXPECT_EQ(a.picture.colours, b.picture.colours);
    EXPECT_EQ(a.picture.depthsModelUnits, b.picture.depthsModelUnits);
    EXPECT_EQ(a.picture.triangles, b.picture.triangles);
}

TEST_F(RendererTest, APageThatFailsCostsDetailAndIsListed) {
    MemoryScene scene = sphereScene();
    const hlod::Camera camera = lookAt(Vec3d(1.0), {2, 1, 0.5});
    Renderer sound(scene.lattice, scene, {});
    const Result whole = render(sound, camera, 0.0);
    const size_t centre = 120 * 320 + 160;
    const ooc::NodeId seen{nodeAt(whole.picture, centre)};
    ASSERT_GT(seen.depth(), 0);
    scene.failing.insert(seen);
    Renderer renderer(scene.lattice, scene, {});
    const Result result = render(renderer, camera, 0.0);
    ASSERT_EQ(result.record.faults.size(), 1u);
    EXPECT_NE(result.record.faults.front().find("checksum is wrong"), std::string::npos);
    EXPECT_EQ(result.record.standIns, 1u);
    EXPECT_EQ(nodeAt(result.picture, centre), seen.parent().value);
    const Result reference = renderReference(renderer, camera);
    EXPECT_EQ(reference.record.faults.size(), 1u);
    EXPECT_LT(reference.record.drawnNodes, whole.record.drawnNodes);
}

TEST_F(RendererTest, AModelOfOneUnitMovedByFiveMillionDoesNotJitter) {
    const Vec3d moved(5e6, -5e6, 5e6);
    MemoryScene here = sphereScene(), there = sphereScene(moved);
    Renderer rendererHere(here.lattice, here, {}), rendererThere(there.lattice, there, {});
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(-1.5, 1.5);
    for (int i = 0; i < 12; ++i) {
        const Vec3d offset(place(random), place(random), 0.8 + std::abs(place(random)));
        const Result a = render(rendererHere, lookAt(Vec3d(1.0), offset, 640, 480), i % 2);
        const Result b = render(rendererThere, lookAt(moved + 1.0, offset, 640, 480), i % 2);
        EXPECT_GT(a.record.coveredPixels, 5000u);
        // 0.01 %: the eye itself is rounded to double there, which may move a rasterised edge.
        EXPECT_LE(differentPixels(a.picture, b.picture), a.picture.pixelCount() / 10000) << i;
    }
}

TEST_F(RendererTest, DepthIsRightToAMillimetreFiveMillionFromTheOrigin) {
    const Vec3d origin(5e6, 4e6, -5e6);
    const int s = 1 << 20;
    // A floor of 2 x 2 units, seen at a slant.
    const MemoryScene made = MemoryScene::withLeaves(
        unitLattice(origin), {{0,
                               {{{{0, 0, s}, {2 * s, 0, s}, {2 * s, 2 * s, s}}},
                                {{{0, 0, s}, {2 * s, 2 * s, s}, {0, 2 * s, s}}}}}});
    MemoryScene scene = made;
    Renderer renderer(scene.lattice, scene, {});
    const hlod::Camera camera = lookAt(origin + 1.0, {-1.3, -2.1, 0.9});
    const Result result = render(renderer, camera, 0.0);
    const hlod::View view(camera, renderer.sceneBox());
    double worst = 0;
    uint64_t covered = 0;
    for (int y = 0; y < camera.heightPx; ++y) {
        for (int x = 0; x < camera.widthPx; ++x) {
            const float depth =
                result.picture.depthsModelUnits[static_cast<size_t>(y * camera.widthPx + x)];
            if (std::isinf(depth)) continue;
            const Vec3d ray = view.forward() +
                              ((x + 0.5) / camera.widthPx * 2 - 1) * view.tanX() * view.right() +
                              (1 - (y + 0.5) / camera.heightPx * 2) * view.tanY() * view.up();
            const double expected = (origin.z + 1.0 - camera.eye.z) / ray.z;  // along the view
            worst = std::max(worst, std::abs(expected - static_cast<double>(depth)));
            ++covered;
        }
    }
    EXPECT_GT(covered, 5000u);
    EXPECT_LT(worst, 1e-3);
}

// A square facing +z, `z` steps up.
std::vector<Triangle> square(int z, uint32_t colour, int from = 0, int to = 1 << 21) {
    return {{{{from, from, z}, {to, from, z}, {to, to, z}}, colour},
            {{{from, from, z}, {to, to, z}, {from, to, z}}, colour}};
}

std::vector<Triangle> joined(std::vector<Triangle> a, const std::vector<Triangle>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

// Linear colour of the picture's middle.
Vec3d middle(const Picture& picture) {
    const size_t pixel =
        static_cast<size_t>(picture.heightPx / 2 * picture.widthPx + picture.widthPx / 2);
    Vec3d colour;
    for (int c = 0; c < 3; ++c) {
        const double srgb = picture.colours[4 * pixel + static_cast<size_t>(c)] / 255.0;
        colour[c] = srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
    }
    return colour;
}

constexpr uint32_t kWhite = 0xFFFFFFFFu, kRed = 0xFF0000FFu, kGreen = 0xFF00FF00u;
constexpr uint32_t kRedPane = 0x800000FFu, kGreenPane = 0x8000FF00u;

TEST_F(RendererTest, EqualDepthsFallToTheLeastNodeIdAndTriangle) {
    const int z = 1 << 20;
    MemoryScene scene = MemoryScene::withLeaves(
        unitLattice(), {{6, square(z, kRed)}, {2, joined(square(z, kGreen), square(z, kRed))}});
    Renderer renderer(scene.lattice, scene, {});
    const Result result = render(renderer, lookAt(Vec3d(1.0), {0.1, 0.2, 3}), 0.0);
    EXPECT_GT(result.record.coveredPixels, 5000u);
    for (size_t i = 0; i < result.picture.pixelCount(); ++i) {
        if (result.picture.nodeOrdinals[i] == 0) continue;
        ASSERT_EQ(nodeAt(result.picture, i), ooc::NodeId::root().child(2).value);
        ASSERT_LT(result.picture.triangles[i], 2u);
    }
}

// Red at alpha a over green at alpha a over white: (a + (1-a)^2, (1-a) a + (1-a)^2, (1-a)^2).
void expectRedOverGreen(const Picture& picture) {
    const double a = 128 / 255.0, b = 1 - a;
    const Vec3d colour = middle(picture), expected(a + b * b, b * a + b * b, b * b);
    EXPECT_NEAR(colour.y / colour.x, expected.y / expected.x, 0.015);
    EXPECT_NEAR(colour.z / colour.x, expected.z / expected.x, 0.015);
}

TEST_F(RendererTest, TranslucentNodesBlendFromBackToFront) {
    const int z = 1 << 20;
    for (const bool isRedFirst : {false, true}) {
        MemoryScene scene = MemoryScene::withLeaves(
            unitLattice(), {{isRedFirst ? 1u : 4u, square(z + 200000, kRedPane)},
                            {isRedFirst ? 4u : 1u, square(z + 100000, kGreenPane)},
                            {2, square(z, kWhite)}});
        Renderer renderer(scene.lattice, scene, {});
        const Result result = render(renderer, lookAt(Vec3d(1.0), {0, 0, 3}), 0.0);
        EXPECT_EQ(result.record.translucentTriangles, 4u);
        expectRedOverGreen(result.picture);
    }
}

TEST_F(RendererTest, TranslucentTrianglesOfOneNodeBlendFromBackToFront) {
    const int z = 1 << 20;
    const auto red = square(z + 200000, kRedPane), green = square(z + 100000, kGreenPane);
    for (const bool isRedFirst : {false, true}) {
        MemoryScene scene = MemoryScene::withLeaves(
            unitLattice(),
            {{0, joined(square(z, kWhite), isRedFirst ? joined(red, green) : joined(green, red))}});
        Renderer renderer(scene.lattice, scene, {});
        const Result result = render(renderer, lookAt(Vec3d(1.0), {0, 0, 3}), 0.0);
        expectRedOverGreen(result.picture);
        // Ids and depth are the opaque surface's.
        EXPECT_NEAR(result.picture.depthsModelUnits[120 * 320 + 160], 3.0, 1e-5);
        EXPECT_LT(result.picture.triangles[120 * 320 + 160], 2u);
    }
}

TEST_F(RendererTest, APaneBehindAWallIsNotSeenAndOneBeforeNothingCovers) {
    const int z = 1 << 20;
    MemoryScene scene = MemoryScene::withLeaves(
        unitLattice(), {{0, joined(square(z, kWhite, 0, 1 << 20), square(z - 100000, kRedPane))}});
    Renderer renderer(scene.lattice, scene, {});
    const Result result = render(renderer, lookAt(Vec3d(0.5, 0.5, 1.0), {0, 0, 3}), 0.0);
    const Vec3d colour = middle(result.picture);
    EXPECT_NEAR(colour.x, colour.z, 1e-9);
    size_t opaque = 0;
    for (const uint32_t ordinal : result.picture.nodeOrdinals) opaque += ordinal != 0 ? 1 : 0;
    EXPECT_GT(result.record.coveredPixels, opaque + 1000);
}

TEST_F(RendererTest, AZipperIsDrawnExactlyWhereOneSideIsRefined) {
    // Root -> inner nodes A (octant 0) and B (octant 1), each with one leaf; strip of the pair
    // stored with both.
    const int z = 1 << 20, s = 1 << 20;
    const auto sceneWith = [&](double errorA, double errorB) {
        const auto a = square(z, kRed, 0, s / 2), b = square(z, kGreen, 3 * s / 2, 2 * s);
        MemoryScene scene;
        scene.lattice = unitLattice();
        scene.block.nodes.resize(5);
        const ooc::NodeId root = ooc::NodeId::root();
        scene.setNode(0, root, joined(a, b), 1e9);
        scene.setNode(1, root.child(0), a, errorA);
        scene.setNode(2, root.child(1), b, errorB);
        scene.setNode(3, root.child(0).child(0), a, 0);
        scene.setNode(4, root.child(1).child(0), b, 0);
        scene.block.nodes[0].childMask = 3;
        scene.block.nodes[0].childIndex = 1;
        for (uint32_t i : {1u, 2u}) {
            ooc::NodeRecord& node = scene.block.nodes[i];
            node.childMask = 1;
            node.childIndex = i + 2;
            node.flags |= ooc::kNodeHasZippers;
            const ooc::NodeId neighbour = root.child(2 - i);
            scene.pages[node.id].zippers = {
                {neighbour.value,
                 {{s - 99999, s - 99999, z}, {s + 99999, s - 99999, z}, {s, s + 99999, z}},
                 {0, 1, 2}}};
        }
        return scene;
    };
    struct Case {
        double errorA, errorB;
        uint64_t zippers;
    };
    for (const Case& c : {Case{0, 0, 0}, Case{1e9, 0, 1}, Case{0, 1e9, 1}, Case{1e9, 1e9, 0}}) {
        MemoryScene scene = sceneWith(c.errorA, c.errorB);
        Renderer renderer(scene.lattice, scene, {});
        const Result result = render(renderer, lookAt(Vec3d(1.0), {0, 0, 3}), 1.0);
        EXPECT_EQ(result.record.drawnZippers, c.zippers);
        const uint64_t node = nodeAt(result.picture, 120 * 320 + 160);
        const ooc::NodeId refined = ooc::NodeId::root().child(c.errorA > 0 ? 0 : 1);
        EXPECT_EQ(node, c.zippers == 1 ? refined.value : 0u);
        // The truth that this cut is held against has the same ones.
        hlod::ReplayStrategy replay(renderer.runner().cut());
        Renderer truth(scene.lattice, scene, {});
        hlod::FrameRecord replayed = truth.render(lookAt(Vec3d(1.0), {0, 0, 3}), replay, {});
        EXPECT_EQ(replayed.drawnZippers, c.zippers);
        EXPECT_EQ(truth.read(replayed).colours, result.picture.colours);
    }
}

TEST_F(RendererTest, DrawsAModelOfAMillionthOfAUnitAndOneOfTenMillion) {
    for (const int exponent : {-40, 3}) {
        ooc::Lattice lattice = unitLattice();
        lattice.stepExponent = exponent;
        MemoryScene scene =
            MemoryScene::make(lattice, test::bumpySphere(Vec3d(1 << 20), 1 << 19, 60), 150);
        Renderer renderer(scene.lattice, scene, {});
        const double unit = std::ldexp(1.0, exponent + 20);
        const Result result = render(renderer, lookAt(Vec3d(unit), Vec3d(2, 1, 0.5) * unit), 0.0);
        MemoryScene plain = sphereScene();
        Renderer plainRenderer(plain.lattice, plain, {});
        const Result expected = render(plainRenderer, lookAt(Vec3d(1.0), {2, 1, 0.5}), 0.0);
        EXPECT_LE(differentPixels(result.picture, expected.picture), 7u);
    }
}

}  // namespace
}  // namespace pagoda::viewer
