// The test models: right triangle counts, repeatable, closed or free of coinciding faces.
#include "tools/generate/generator.h"

#include "ooc/base/error.h"
#include "ooc/base/hash.h"
#include "ooc/writers/float_exact.h"
#include "tools/generate/collected_scene.h"
#include "tools/generate/scene_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pagoda::tools {
namespace {

struct Made {
    CollectedScene scene;
    SceneViews views;
};

Made make(const char* kind, uint64_t triangles, uint64_t seed = 1) {
    Made made;
    made.views = findGenerator(kind)->generate(made.scene, {.triangles = triangles, .seed = seed});
    return made;
}

uint64_t hashOf(const CollectedScene& scene) {
    return hash64(std::as_bytes(std::span(scene.corners)));
}

TEST(Generate, EveryKindMeetsTheTriangleCountWithinFivePercent) {
    for (const Generator& generator : generators()) {
        for (const uint64_t wanted : {uint64_t{100'000}, uint64_t{400'000}}) {
            const Made made = make(std::string(generator.name).c_str(), wanted);
            EXPECT_NEAR(static_cast<double>(made.scene.triangleCount()),
                        static_cast<double>(wanted), 0.05 * static_cast<double>(wanted))
                << generator.name;
        }
    }
}

TEST(Generate, ATinyCountIsRefusedWithTheLeastThatGoes) {
    for (const char* kind : {"powerplant", "city", "interior"}) {
        try {
            (void)make(kind, 10);
            FAIL() << kind;
        } catch (const Error& error) {
            EXPECT_NE(error.problem().find("at least"), std::string::npos);
        }
    }
}

TEST(Generate, TheSameSeedGivesTheSameTrianglesAndAnotherSeedOthers) {
    for (const Generator& generator : generators()) {
        const std::string kind(generator.name);
        const uint64_t first = hashOf(make(kind.c_str(), 100'000, 5).scene);
        EXPECT_EQ(first, hashOf(make(kind.c_str(), 100'000, 5).scene)) << kind;
        EXPECT_NE(first, hashOf(make(kind.c_str(), 100'000, 6).scene)) << kind;
    }
}

TEST(Generate, EveryEdgeOfTheTorusBelongsToTwoTrianglesThatRunAgainstEachOther) {
    for (const uint64_t triangles : {uint64_t{32}, uint64_t{5'000}, uint64_t{100'003}}) {
        const Made made = make("torus", triangles, triangles);
        using Key = std::array<float, 6>;
        std::map<Key, int> balance, uses;
        const std::vector<Vec3f>& corners = made.scene.corners;
        for (size_t t = 0; t < made.scene.triangleCount(); ++t) {
            for (size_t i = 0; i < 3; ++i) {
                const Vec3f a = corners[3 * t + i], b = corners[3 * t + (i + 1) % 3];
                const Key forward{a.x, a.y, a.z, b.x, b.y, b.z};
                const Key backward{b.x, b.y, b.z, a.x, a.y, a.z};
                const Key& key = std::min(forward, backward);
                ++uses[key];
                balance[key] += key == forward ? 1 : -1;
            }
        }
        for (const auto& [edge, count] : uses) ASSERT_EQ(count, 2);
        for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0);
    }
}

TEST(Generate, NoTwoFacesOfTheScenesLieOnEachOther) {
    for (const char* kind : {"powerplant", "city", "interior"}) {
        for (const uint64_t seed : {uint64_t{1}, uint64_t{2}}) {
            const Made made = make(kind, 250'000, seed);
            const CoplanarFaces found = findCoplanarFaces(made.scene.corners);
            EXPECT_EQ(found.triangles, 0u) << kind << " seed " << seed;
            for (size_t i = 0; i < std::min<size_t>(5, found.examples.size()); ++i) {
                const auto [a, b] = found.examples[i];
                const Vec3f at = made.scene.corners[3 * b];
                ADD_FAILURE() << made.scene.objects[made.scene.objectOf[a]].name << " and "
                              << made.scene.objects[made.scene.objectOf[b]].name << " near " << at.x
                              << ' ' << at.y << ' ' << at.z;
            }
        }
    }
}

TEST(Generate, InsideTheScenesAtMostOneTriangleInTwentyIsSeen) {
    for (const char* kind : {"powerplant", "interior"}) {
        const Made made = make(kind, 500'000);
        const SceneReport report = measureScene(made.scene, made.views);
        EXPECT_GE(report.views, 16u);
        EXPECT_GT(report.visible.medianVisible, 50) << kind << ": the eye is inside something";
        EXPECT_LE(report.visible.median, 0.05) << kind;
        EXPECT_GE(report.distinctShapes, 200u) << kind;
        EXPECT_GT(report.translucentTriangles, 0u) << kind;
        EXPECT_EQ(report.degenerateTriangles, 0u) << kind;
    }
}

TEST(Generate, ObjectsHaveNamesAndParents) {
    for (const char* kind : {"powerplant", "city", "interior"}) {
        const Made made = make(kind, 250'000);
        EXPECT_GT(made.scene.objects.size(), 50u);
        size_t withParent = 0;
        for (const ooc::ObjectInfo& object : made.scene.objects) {
            EXPECT_FALSE(object.name.empty());
            if (object.parent != ooc::ObjectInfo::kNoParent) ++withParent;
        }
        EXPECT_GT(withParent, made.scene.objects.size() / 2);
    }
}

// So that a .ply needs no doubles. By the bits: see ooc/writers/float_exact.h.
TEST(Generate, CoordinatesOfModelsUpTo500MetresAreFloats) {
    struct Check final : ooc::TriangleSink {
        uint32_t addObject(const ooc::ObjectInfo&) override { return 0; }
        uint32_t addMaterial(const ooc::MaterialInfo&) override { return 0; }
        void addTriangles(const ooc::TriangleBatch& batch) override {
            for (const Vec3d& p : batch.positions) {
                for (int axis = 0; axis < 3; ++axis)
                    inexact += ooc::isFloatExact(p[axis]) ? 0u : 1u;
            }
        }
        void dropped(ooc::DropReason, uint64_t) override {}
        void ignored(std::string_view, uint64_t) override {}
        void advance(uint64_t) override {}
        uint64_t inexact = 0;
    };
    for (const Generator& generator : generators()) {
        Check check;
        (void)generator.generate(check, {.triangles = 100'000, .seed = 1});
        EXPECT_EQ(check.inexact, 0u) << generator.name;
    }
}

// The checker itself, on planted pairs.
using Corners = std::vector<Vec3f>;

uint64_t coplanar(const Corners& corners) {
    return findCoplanarFaces(corners).triangles;
}

TEST(CoplanarFaces, AnOverlapInOnePlaneIsFoundFromEitherSide) {
    const Corners front{{0, 0, 0},       {2, 0, 0},    {0, 2, 0},
                        {0.1f, 0.1f, 0}, {1, 0.1f, 0}, {0.1f, 1, 0}};
    EXPECT_EQ(coplanar(front), 2u);
    Corners back = front;
    std::swap(back[4], back[5]);
    EXPECT_EQ(coplanar(back), 2u);
    Corners tilted = front;
    for (Vec3f& p : tilted) p = {p.x, p.y * 0.8f - 3, p.y * 0.6f + 7};
    EXPECT_EQ(coplanar(tilted), 2u);
}

TEST(CoplanarFaces, ASmallFaceOnALargeOneIsFoundAmongThousands) {
    Corners corners{{-50, -50, 1}, {50, -50, 1}, {0, 80, 1}};
    for (int i = 0; i < 5000; ++i) {  // a cloud of small faces above it
        const float x = static_cast<float>(i % 71), y = static_cast<float>(i % 53);
        const float z = 1.01f + 0.001f * static_cast<float>(i);
        corners.insert(corners.end(), {{x, y, z}, {x + 0.1f, y, z}, {x, y + 0.1f, z}});
    }
    EXPECT_EQ(coplanar(corners), 0u);
    corners.insert(corners.end(), {{3, 3, 1}, {3.02f, 3, 1}, {3, 3.02f, 1}});
    EXPECT_EQ(coplanar(corners), 2u);
}

TEST(CoplanarFaces, NeighboursAndParallelFacesAreFree) {
    const Corners shareAnEdge{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    EXPECT_EQ(coplanar(shareAnEdge), 0u);
    const Corners twoMillimetresApart{{0, 0, 0},      {1, 0, 0},      {0, 1, 0},
                                      {0, 0, 0.002f}, {1, 0, 0.002f}, {0, 1, 0.002f}};
    EXPECT_EQ(coplanar(twoMillimetresApart), 0u);
    const Corners crossing{{0, 0, 0},        {1, 0, 0},       {0, 1, 0},
                           {0.2f, 0.2f, -1}, {0.2f, 0.2f, 1}, {0.4f, 0.3f, 0}};
    EXPECT_EQ(coplanar(crossing), 0u);
}

// The item buffer, on scenes whose answer is plain.
CollectedScene wallBefore(float nearDistance, float farDistance, bool nearIsGlass) {
    CollectedScene scene;
    scene.addObject({});
    scene.addMaterial({.name = "solid"});
    scene.addMaterial({.name = "glass", .colour = 0x80FFFFFFu, .isTranslucent = true});
    for (const float x : {nearDistance, farDistance}) {
        ooc::TriangleBatch batch;
        batch.material = nearIsGlass && x == nearDistance ? 1 : 0;
        const double s = 10;
        batch.positions = {{x, -s, -s}, {x, s, -s}, {x, s, s}, {x, -s, -s}, {x, s, s}, {x, -s, s}};
        scene.addTriangles(batch);
    }
    return scene;
}

TEST(ItemBuffer, TheNearerWallHidesTheFartherUnlessItIsGlass) {
    ItemBuffer buffer(64, 48);
    const Viewpoint ahead{{0, 0, 0}, {1, 0, 0}};
    buffer.draw(wallBefore(2, 4, false), ahead);
    EXPECT_EQ(buffer.visibleCount(), 2u);
    EXPECT_EQ(buffer.inFrustumCount(), 4u);
    buffer.draw(wallBefore(2, 4, true), ahead);
    EXPECT_EQ(buffer.visibleCount(), 4u);
    buffer.draw(wallBefore(2, 4, false), {{0, 0, 0}, {-1, 0, 0}});
    EXPECT_EQ(buffer.inFrustumCount(), 0u);
    EXPECT_EQ(buffer.visibleCount(), 0u);
}

TEST(ItemBuffer, AFloorThatPassesBelowTheEyeIsClippedNotLost) {
    CollectedScene scene;
    scene.addObject({});
    scene.addMaterial({});
    ooc::TriangleBatch floor;
    floor.positions = {{-100, -100, -1}, {100, -100, -1}, {100, 100, -1},
                       {-100, -100, -1}, {100, 100, -1},  {-100, 100, -1}};
    scene.addTriangles(floor);
    ItemBuffer buffer(64, 48);
    buffer.draw(scene, {{0, 0, 0}, {1, 0, -0.0001}});
    // Below the horizon all is floor: at the bottom row's middle its distance is 1 / tan(30 deg).
    const size_t bottomMiddle = 47 * 64 + 32;
    ASSERT_NE(buffer.ids()[bottomMiddle], ItemBuffer::kNothing);
    EXPECT_NEAR(1 / buffer.inverseDepths()[bottomMiddle], 1 / (0.57735 * 47 / 48), 0.02);
    EXPECT_EQ(buffer.ids()[32], ItemBuffer::kNothing);
}

}  // namespace
}  // namespace pagoda::tools
