// What is left out of a picture: hidden objects against scenes that never had them, sections
// against a ray cast of every triangle.
#include "hlod/strategies/strategies.h"
#include "tests/viewer/gl_fixture.h"
#include "tests/viewer/memory_scene.h"
#include "viewer/renderer.h"

#include <cmath>
#include <limits>

namespace pagoda::viewer {
namespace {

using test::MemoryScene;
using test::Triangle;

ooc::Lattice lattice() {
    ooc::Lattice result;
    result.stepExponent = -12;
    result.extentBits = 16;  // 16 units
    return result;
}

// Balls behind each other along x; the last one's cover is translucent.
std::vector<Triangle> ballsBut(const ooc::ObjectSet& hidden) {
    std::vector<Triangle> triangles;
    const auto add = [&](uint32_t object, double x, double radius, uint32_t colour) {
        if (hidden.contains(object)) return;
        for (Triangle t : test::bumpySphere(Vec3d(x, 32'768, 32'768), radius, 24, colour)) {
            t.object = object;
            triangles.push_back(t);
        }
    };
    add(0, 10'000, 6'000, 0xFF4060E0u);
    add(1, 28'000, 9'000, 0xFF60C060u);
    add(2, 52'000, 11'000, 0xFFE0A040u);
    add(3, 10'000, 8'000, 0x80FFFFFFu);
    return triangles;
}

MemoryScene ballScene(const ooc::ObjectSet& hidden = {}) {
    return MemoryScene::make(lattice(), ballsBut(hidden), 100);
}

// From the left, along the row; the near plane is stated since it follows from the scene's box.
hlod::Camera alongTheRow(double fromX = -6.0) {
    hlod::Camera camera;
    camera.eye = Vec3d(fromX, 7.0, 9.0);
    camera.target = Vec3d(8.0);
    camera.up = Vec3d(0, 0, 1);
    camera.widthPx = 240;
    camera.heightPx = 180;
    camera.nearModelUnits = 0.01;
    return camera;
}

struct Result {
    hlod::FrameRecord record;
    Picture picture;
};

Result render(Renderer& renderer, const hlod::Camera& camera, hlod::Strategy& strategy,
              double tauPx, const hlod::Clip& clip) {
    RenderOptions options;
    options.tauPx = tauPx;
    options.clip = clip;
    Result result;
    result.record = renderer.render(camera, strategy, options);
    result.picture = renderer.read(result.record);
    return result;
}

std::shared_ptr<const ooc::ObjectSet> setOf(std::initializer_list<uint32_t> objects) {
    auto set = std::make_shared<ooc::ObjectSet>(4);
    for (const uint32_t object : objects) set->insert(object);
    return set;
}

class HiddenObjects : public GlTest, public ::testing::WithParamInterface<const char*> {};

// One renderer and one strategy throughout: what is learnt about one set must not harm the next.
TEST_P(HiddenObjects, ArePicturesOfScenesWithoutThem) {
    const MemoryScene scene = ballScene();
    Renderer renderer(scene.lattice, scene, {});
    const auto strategy = hlod::makeStrategy(GetParam());
    const hlod::Camera camera = alongTheRow();
    for (const auto& hidden : {setOf({}), setOf({1}), setOf({3}), setOf({0, 3}), setOf({0, 1, 3}),
                               setOf({2}), setOf({1, 2}), setOf({})}) {
        const MemoryScene without = ballScene(*hidden);
        Renderer other(without.lattice, without, {});
        hlod::Clip clip;
        clip.hidden = hidden;
        const Result shown = render(renderer, camera, *strategy, 0.0, clip);
        const Result expected =
            render(other, camera, *hlod::makeStrategy("frustum"), 0.0, hlod::Clip{});
        EXPECT_TRUE(shown.record.isSettled);
        EXPECT_GT(expected.record.coveredPixels, 1000u);
        EXPECT_EQ(shown.picture.depthsModelUnits, expected.picture.depthsModelUnits);
        EXPECT_EQ(shown.picture.colours, expected.picture.colours);
    }
}

TEST_P(HiddenObjects, AreInNoPixelOfACoarsePicture) {
    const MemoryScene scene = ballScene();
    Renderer renderer(scene.lattice, scene, {});
    const auto strategy = hlod::makeStrategy(GetParam());
    hlod::Clip clip;
    clip.hidden = setOf({1});
    const Result shown = render(renderer, alongTheRow(-30.0), *strategy, 30.0, clip);
    size_t covered = 0;
    bool isCoarse = false;
    for (size_t i = 0; i < shown.picture.pixelCount(); ++i) {
        const uint32_t ordinal = shown.picture.nodeOrdinals[i];
        if (ordinal == 0) continue;
        ++covered;
        const ooc::NodeId node = shown.picture.nodes.at(ordinal - 1);
        isCoarse |= node.depth() < 2;
        uint32_t triangle = shown.picture.triangles[i];
        for (const ooc::MeshRun& run : scene.pages.at(node).mesh.runs) {
            if (triangle < run.triangleCount) {
                ASSERT_NE(run.object, 1u);
                break;
            }
            triangle -= run.triangleCount;
        }
    }
    EXPECT_GT(covered, 200u);
    EXPECT_TRUE(isCoarse) << "tau is too fine for this test";
}

INSTANTIATE_TEST_SUITE_P(Strategies, HiddenObjects,
                         ::testing::Values("frustum", "coh", "hzb", "late", "auto"));

class SectionTest : public GlTest, public ::testing::WithParamInterface<const char*> {};

// Depth along the view of the nearest opaque triangle that is kept, without tree or GPU.
double cast(const std::vector<Triangle>& triangles, const hlod::View& view,
            const hlod::SectionPlane& plane, double xPx, double yPx) {
    const hlod::Camera& camera = view.camera();
    const Vec3d direction = view.forward() +
                            (2 * xPx / camera.widthPx - 1) * view.tanX() * view.right() +
                            (1 - 2 * yPx / camera.heightPx) * view.tanY() * view.up();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Triangle& t : triangles) {
        if (t.colour >> 24 != 255) continue;
        const Vec3d a = lattice().toModel(t.corners[0]);
        const Vec3d ab = lattice().toModel(t.corners[1]) - a;
        const Vec3d ac = lattice().toModel(t.corners[2]) - a;
        const Vec3d across = glm::cross(direction, ac), from = view.eye() - a;
        const double determinant = glm::dot(ab, across);
        const double u = glm::dot(from, across) / determinant;
        const Vec3d other = glm::cross(from, ab);
        const double v = glm::dot(direction, other) / determinant;
        const double along = glm::dot(ac, other) / determinant;
        if (!(u >= 0 && v >= 0 && u + v <= 1 && along > view.nearModelUnits())) continue;
        if (plane.above(view.eye() + along * direction) > 0.0) continue;
        nearest = std::min(nearest, along);
    }
    return nearest;
}

TEST_P(SectionTest, ShowsWhatAnEyeSeesOfTheRest) {
    const std::vector<Triangle> triangles = ballsBut({});
    const MemoryScene scene = ballScene();
    Renderer renderer(scene.lattice, scene, {});
    const auto strategy = hlod::makeStrategy(GetParam());
    const hlod::Camera camera = alongTheRow();
    const hlod::View view(camera, renderer.sceneBox());
    const auto planeThrough = [](const Vec3d& normal, const Vec3d& point) {
        const Vec3d unit = glm::normalize(normal);
        return hlod::SectionPlane{unit, glm::dot(unit, point)};
    };
    for (const hlod::SectionPlane& plane :
         {planeThrough({-1, 0, 0}, {7.0, 0, 0}), planeThrough({-1, 0.3, 0.2}, {12.5, 8, 8}),
          planeThrough({0, 0, 1}, {0, 0, 8.3}), planeThrough({1, 0, 0}, {3.0, 0, 0})}) {
        hlod::Clip clip;
        clip.section = plane;
        const Result shown = render(renderer, camera, *strategy, 0.0, clip);
        int compared = 0, wrong = 0, covered = 0;
        for (int y = 2; y < camera.heightPx; y += 7) {
            for (int x = 2; x < camera.widthPx; x += 7) {
                const double expected = cast(triangles, view, plane, x + 0.5, y + 0.5);
                // Silhouettes, and the cut's own edge, may fall to either side.
                const auto isAlike = [&](double depth) {
                    return std::isinf(expected) ? std::isinf(depth)
                                                : std::abs(depth - expected) < 0.02 * expected;
                };
                if (!isAlike(cast(triangles, view, plane, x + 0.52, y + 0.52)) ||
                    !isAlike(cast(triangles, view, plane, x + 0.48, y + 0.48))) {
                    continue;
                }
                ++compared;
                covered += !std::isinf(expected);
                const double drawn = static_cast<double>(
                    shown.picture.depthsModelUnits[static_cast<size_t>(y * camera.widthPx + x)]);
                const bool isRight = std::isinf(expected)
                                         ? std::isinf(drawn)
                                         : std::abs(drawn - expected) < 1e-4 * expected;
                wrong += !isRight;
            }
        }
        EXPECT_GT(compared, 700);
        EXPECT_GT(covered, 20);
        EXPECT_EQ(wrong, 0);
    }
    // Switched off, it leaves nothing behind.
    const Result whole = render(renderer, camera, *strategy, 0.0, {});
    Renderer fresh(scene.lattice, scene, {});
    const Result expected = render(fresh, camera, *hlod::makeStrategy("frustum"), 0.0, {});
    EXPECT_EQ(whole.picture.colours, expected.picture.colours);
}

INSTANTIATE_TEST_SUITE_P(Strategies, SectionTest,
                         ::testing::Values("frustum", "coh", "hzb", "late"));

class ClippedReference : public GlTest {};

TEST_F(ClippedReference, LeavesOutTheSame) {
    const MemoryScene scene = ballScene();
    Renderer renderer(scene.lattice, scene, {});
    RenderOptions options;
    options.clip.hidden = setOf({1, 3});
    options.clip.section = hlod::SectionPlane{Vec3d(0, 0, 1), 9.0};
    Result reference;
    reference.record = renderer.renderReference(alongTheRow(), options);
    reference.picture = renderer.read(reference.record);
    const Result cut =
        render(renderer, alongTheRow(), *hlod::makeStrategy("frustum"), 0.0, options.clip);
    EXPECT_EQ(reference.picture.colours, cut.picture.colours);
    EXPECT_EQ(reference.picture.depthsModelUnits, cut.picture.depthsModelUnits);
}

}  // namespace
}  // namespace pagoda::viewer
