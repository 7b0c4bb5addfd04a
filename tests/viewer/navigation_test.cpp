// Drags and the wheel. What takes time: navigation_moves_test.cpp.
#include "viewer/navigation.h"

#include "tests/viewer/navigation_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>

namespace pagoda::viewer {
namespace {

using test::Dice;
using test::kPlaces;
using test::kUpZ;
using test::Place;
using test::project;

constexpr uint64_t kSeed = 11;

// Pixels that a point seen from `distance` moves by for rounding alone.
double tolerancePx(const Place& place, double depth) {
    return 1e-9 + 3e3 * place.roundingModelUnits() / depth;
}

struct Grab {
    Vec3d point;
    glm::dvec2 px;
};
// A point of the scene that is in front of the eye, and its pixel.
Grab grab(const Navigation& navigation, const Place& place, Dice& dice) {
    while (true) {
        const Vec3d point = dice.pointIn(place.box());
        if (test::depthOf(navigation.camera(), point) < 0.1 * place.scale) continue;
        return {point, project(navigation.camera(), point)};
    }
}

void drag(Navigation& navigation, DragKind kind, const Grab& at, glm::dvec2 to) {
    navigation.beginDrag(kind, at.px, at.point);
    navigation.dragTo(to);
    navigation.endDrag();
}

void expectSame(const hlod::Camera& a, const hlod::Camera& b) {
    const double size = std::max(glm::length(a.eye), glm::length(a.eye - a.target));
    EXPECT_LE(glm::length(a.eye - b.eye), 1e-12 * size);
    EXPECT_LE(glm::length(a.target - b.target), 1e-12 * size);
    EXPECT_LE(glm::length(test::axesOf(a).up - test::axesOf(b).up), 1e-9);
}

TEST(Navigation, BeginsAsTheHomeCamera) {
    for (const Place& place : kPlaces) {
        EXPECT_EQ(place.navigation().camera(), place.home());
    }
}

TEST(Navigation, PanKeepsTheGrabbedPointUnderTheCursor) {
    SCOPED_TRACE(kSeed);
    Dice dice(kSeed);
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        for (int i = 0; i < 100; ++i) {
            const Grab at = grab(navigation, place, dice);
            const double depth = test::depthOf(navigation.camera(), at.point);
            const glm::dvec2 to = dice.px();
            drag(navigation, DragKind::Pan, at, to);
            const double offPx = glm::length(project(navigation.camera(), at.point) - to);
            ASSERT_LE(offPx, tolerancePx(place, depth)) << place.scale;
            navigation.jumpTo(place.home());
            drag(navigation, DragKind::Orbit, grab(navigation, place, dice), dice.px());
        }
    }
}

TEST(Navigation, PannedOrTurnedThereAndBackIsTheSameCamera) {
    SCOPED_TRACE(kSeed);
    Dice dice(kSeed);
    for (const Place& place : kPlaces) {
        for (const DragKind kind :
             {DragKind::Pan, DragKind::Orbit, DragKind::Look, DragKind::Zoom}) {
            Navigation navigation = place.navigation();
            const hlod::Camera before = navigation.camera();
            for (int i = 0; i < 50; ++i) {
                const Grab at = grab(navigation, place, dice);
                navigation.beginDrag(kind, at.px, at.point);
                // Small moves: a turn beyond a pole is not meant to come back.
                for (int k = 0; k < 5; ++k) {
                    navigation.dragTo(at.px + glm::dvec2(dice.between(-90, 90)));
                }
                navigation.dragTo(at.px);
                navigation.endDrag();
            }
            expectSame(before, navigation.camera());
        }
    }
}

TEST(Navigation, OrbitKeepsThePivotAtItsPixelTheHorizonLevelAndNeverFlips) {
    SCOPED_TRACE(kSeed);
    Dice dice(kSeed);
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        const Vec3d up = glm::normalize(place.up);
        for (int i = 0; i < 200; ++i) {
            if (i % 10 == 0) navigation.jumpTo(place.home());
            const Grab at = grab(navigation, place, dice);
            const double distance = glm::length(at.point - navigation.camera().eye);
            const double depth = test::depthOf(navigation.camera(), at.point);
            navigation.beginDrag(DragKind::Orbit, at.px, at.point);
            for (int k = 0; k < 4; ++k) {
                navigation.dragTo(4.0 * dice.px() - glm::dvec2(1600, 1200));
                const hlod::Camera& camera = navigation.camera();
                ASSERT_LE(glm::length(project(camera, at.point) - at.px),
                          tolerancePx(place, depth * depth / distance) + 1e-12 * distance / depth);
                ASSERT_NEAR(glm::length(at.point - camera.eye), distance,
                            1e-9 * distance + place.roundingModelUnits());
                ASSERT_NEAR(glm::dot(test::axesOf(camera).right, up), 0, 1e-9);
                ASSERT_GE(glm::dot(test::axesOf(camera).up, up), -1e-9);
            }
            navigation.endDrag();
        }
    }
}

TEST(Navigation, OrbitFollowsTheCursorAndStopsAtThePoleWithoutADeadWayBack) {
    Navigation navigation = Place{}.navigation();
    navigation.jumpTo({.eye = {0, -5, 0}, .target = {0, 0, 0}, .up = test::kUpZ});
    const glm::dvec2 middle(400, 300);
    // The front of what is grabbed goes to the right: the eye goes to the left.
    navigation.beginDrag(DragKind::Orbit, middle, Vec3d(0.0));
    navigation.dragTo(middle + glm::dvec2(50, 0));
    EXPECT_LT(navigation.camera().eye.x, -0.1);
    navigation.dragTo(middle + glm::dvec2(0, 50));
    EXPECT_GT(navigation.camera().eye.z, 0.1);
    navigation.dragTo(middle + glm::dvec2(0, 5000));
    EXPECT_NEAR(navigation.camera().eye.z, 5, 1e-9);
    navigation.dragTo(middle + glm::dvec2(0, 4970));  // 30 of 600 pixels: 9 degrees
    EXPECT_NEAR(navigation.camera().eye.z, 5 * std::cos(std::numbers::pi * 30 / 600), 1e-9);
}

TEST(Navigation, OrbitWithoutASurfaceTurnsAboutTheLastPivotOrTheScene) {
    Navigation navigation = Place{}.navigation();
    const double distance = glm::length(navigation.camera().eye);
    navigation.beginDrag(DragKind::Orbit, {10, 10}, std::nullopt);
    navigation.dragTo({400, 100});
    EXPECT_NEAR(glm::length(navigation.camera().eye), distance, 1e-9);
    navigation.endDrag();
    const Vec3d pivot(0.3, 0.2, 0.1);
    drag(navigation, DragKind::Orbit, {pivot, project(navigation.camera(), pivot)}, {5, 5});
    const double toPivot = glm::length(navigation.camera().eye - pivot);
    navigation.beginDrag(DragKind::Orbit, {10, 10}, std::nullopt);
    navigation.dragTo({400, 100});
    EXPECT_NEAR(glm::length(navigation.camera().eye - pivot), toPivot, 1e-9);
}

TEST(Navigation, LookTurnsTheHeadAlone) {
    Navigation navigation = Place{}.navigation();
    navigation.beginDrag(DragKind::Look, {400, 300}, std::nullopt);
    navigation.dragTo({500, 200});
    EXPECT_EQ(navigation.camera().eye, Place{}.home().eye);
    // To the right and up.
    const auto before = test::axesOf(Place{}.home()), after = test::axesOf(navigation.camera());
    EXPECT_GT(glm::dot(after.forward, before.right), 0.05);
    EXPECT_GT(after.forward.z, before.forward.z + 0.05);
}

TEST(Navigation, AStepOfTheWheelIsAConstantFactorTowardsThePointUnderTheCursor) {
    SCOPED_TRACE(kSeed);
    Dice dice(kSeed);
    for (const Place& place : kPlaces) {
        for (int i = 0; i < 100; ++i) {
            Navigation navigation = place.navigation();
            const Grab at = grab(navigation, place, dice);
            const double before = glm::length(at.point - navigation.camera().eye);
            const double steps = dice.between(-10, 10);
            navigation.wheel(steps, at.px, at.point);
            const double after = glm::length(at.point - navigation.camera().eye);
            ASSERT_NEAR(after / before, std::pow(0.85, steps),
                        1e-9 + 10 * place.roundingModelUnits() / before);
            ASSERT_LE(glm::length(project(navigation.camera(), at.point) - at.px),
                      tolerancePx(place, 0.5 * std::min(before, after)));
        }
    }
}

TEST(Navigation, TheWheelNeverGoesThroughTheSurfaceAndIsNeverStuckBeforeIt) {
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        const Vec3d surface = place.origin + 0.4 * place.scale * Vec3d(0.2, 0.1, 0.3);
        const glm::dvec2 px = project(navigation.camera(), surface);
        const Vec3d towards = glm::normalize(surface - navigation.camera().eye);
        for (int i = 0; i < 2000; ++i) {
            navigation.wheel(i % 3 == 0 ? 1000 : 1, px, surface);
            ASSERT_GT(glm::dot(surface - navigation.camera().eye, towards), 0) << i;
        }
        // What View draws from so near is not cut off by its near plane.
        const hlod::View view(navigation.camera(), place.box());
        EXPECT_GE(test::depthOf(navigation.camera(), surface), view.nearModelUnits());
        EXPECT_LE(glm::length(surface - navigation.camera().eye), 1e-4 * place.scale);
        const double closest = glm::length(surface - navigation.camera().eye);
        navigation.wheel(-1, px, surface);
        EXPECT_GE(glm::length(surface - navigation.camera().eye), 1.1 * closest);
        for (int i = 0; i < 100; ++i) navigation.wheel(-1, px, surface);
        EXPECT_GE(glm::length(surface - navigation.camera().eye), place.scale);
    }
}

TEST(Navigation, TheWheelComesAwayFromASurfaceThatTheEyeTouches) {
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        const Vec3d eye = navigation.camera().eye;
        const Vec3d ahead = test::axesOf(navigation.camera()).forward;
        const Vec3d surface = eye + (1e-9 * place.scale + 3 * place.roundingModelUnits()) * ahead;
        navigation.wheel(2, {400, 300}, surface);
        EXPECT_LE(glm::length(navigation.camera().eye - eye), glm::length(surface - eye));
        for (int i = 0; i < 60; ++i) navigation.wheel(-1, {400, 300}, surface);
        EXPECT_GT(glm::length(navigation.camera().eye - eye), 1e-3 * place.scale);
    }
}

TEST(Navigation, ATargetBesideTheEyeFarFromTheOriginDoesNotMakeThePictureShake) {
    const Place place{1, Vec3d(1e7), kUpZ};
    hlod::Camera near = place.home();
    near.target = near.eye + 1e-7 * Vec3d(0.6, 0.8, 0);
    Navigation navigation = place.navigation();
    navigation.jumpTo(near);
    EXPECT_EQ(navigation.camera(), near);
    navigation.beginDrag(DragKind::Look, {400, 300}, std::nullopt);
    navigation.dragTo({401, 300});
    const Vec3d ahead = test::axesOf(navigation.camera()).forward;
    for (int i = 0; i < 100; ++i) {
        const double turnedPx = 0.01 * i;
        navigation.dragTo({401 + turnedPx, 300});
        const Vec3d now = test::axesOf(navigation.camera()).forward;
        const double radiansPerPx = std::numbers::pi / 600 / 4;  // 45 of 180 degrees
        EXPECT_NEAR(glm::length(now - ahead), turnedPx * radiansPerPx, 1e-6);
    }
}

TEST(Navigation, TheWheelGoesOnThroughEmptySpaceAndEndsSomewhereFarOut) {
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        const Vec3d eye = navigation.camera().eye;
        for (int i = 0; i < 3000; ++i) navigation.wheel(1, {400, 300}, std::nullopt);
        const double way = glm::length(navigation.camera().eye - eye);
        EXPECT_GT(way, 5 * place.scale);  // beyond the scene
        for (int i = 0; i < 3000; ++i) navigation.wheel(-50, {400, 300}, std::nullopt);
        EXPECT_LT(glm::length(navigation.camera().eye - place.origin), 1e5 * place.scale);
        navigation.wheel(3, {400, 300}, std::nullopt);
        EXPECT_TRUE(navigation.update(0));  // still moves
    }
}

TEST(Navigation, AZoomingDragIsSmoothTheSamePixelsAndNearerUpwards) {
    Navigation navigation = Place{}.navigation();
    const Vec3d point(0.3, -0.2, 0.4);
    const glm::dvec2 px = project(navigation.camera(), point);
    const double before = glm::length(point - navigation.camera().eye);
    navigation.beginDrag(DragKind::Zoom, px, point);
    navigation.dragTo(px - glm::dvec2(0, 600));
    EXPECT_NEAR(glm::length(point - navigation.camera().eye), before / 20, 1e-9);
    EXPECT_LE(glm::length(project(navigation.camera(), point) - px), 1e-8);
    navigation.dragTo(px - glm::dvec2(0, 1e6));
    EXPECT_GT(test::depthOf(navigation.camera(), point), 0);
    navigation.dragTo(px + glm::dvec2(0, 300));
    EXPECT_NEAR(glm::length(point - navigation.camera().eye), before * std::sqrt(20.0), 1e-9);
}

TEST(Navigation, ACameraWithRollKeepsItUntilItIsTurnedAndLevelsWithoutAJump) {
    Navigation navigation = Place{}.navigation();
    hlod::Camera rolled = Place{}.home();
    rolled.up = {0.5, 0.2, 0.8};
    navigation.jumpTo(rolled);
    EXPECT_EQ(navigation.camera(), rolled);
    const double rollBefore = test::axesOf(rolled).right.z;
    ASSERT_GT(std::abs(rollBefore), 0.1);
    drag(navigation, DragKind::Pan, {Vec3d(0.0), {400, 300}}, {450, 350});
    EXPECT_NEAR(test::axesOf(navigation.camera()).right.z, rollBefore, 1e-9);
    const hlod::Camera before = navigation.camera();
    navigation.beginDrag(DragKind::Orbit, {400, 300}, Vec3d(0.0));
    navigation.dragTo({401, 300});
    EXPECT_LE(glm::length(test::axesOf(before).right - test::axesOf(navigation.camera()).right),
              0.02);
    navigation.dragTo({650, 300});
    EXPECT_NEAR(test::axesOf(navigation.camera()).right.z, 0, 1e-12);
}

// Every call in any order on scenes that are none, with numbers that are none.
TEST(Navigation, StaysFiniteWhateverIsCalledOnWhateverScene) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInf = std::numeric_limits<double>::infinity();
    const Vec3d point(1e7, 2, -3);
    const Box3d boxes[] = {{},
                           {point, point},
                           {Vec3d(0.0), Vec3d(1, 0, 0)},
                           {Vec3d(kNan), Vec3d(1.0)},
                           {Vec3d(-kInf), Vec3d(kInf)},
                           {Vec3d(-1e300), Vec3d(1e300)},
                           {Vec3d(-1e-300), Vec3d(1e-300)}};
    const double numbers[] = {0, 1, -3, 1e-3, 1e9, -1e9, 300, 47.5, kNan, kInf, -kInf};
    SCOPED_TRACE(kSeed);
    Dice dice(kSeed);
    const auto number = [&] { return numbers[dice.below(std::size(numbers))]; };
    const auto px = [&] { return dice.below(4) == 0 ? glm::dvec2(number(), number()) : dice.px(); };
    const auto surface = [&]() -> std::optional<Vec3d> {
        if (dice.below(2) == 0) return std::nullopt;
        return dice.below(3) == 0 ? Vec3d(number(), number(), number())
                                  : dice.pointIn({Vec3d(-5.0), Vec3d(5.0)});
    };
    for (const Box3d& box : boxes) {
        Navigation navigation(Place{}.home(), box, Vec3d(number(), number(), number()));
        for (int i = 0; i < 3000; ++i) {
            switch (dice.below(14)) {
                case 0:
                    navigation.beginDrag(DragKind(dice.below(4)), px(), surface());
                    break;
                case 1:
                case 2:
                    navigation.dragTo(px());
                    break;
                case 3:
                    navigation.endDrag();
                    break;
                case 4:
                    navigation.wheel(number(), px(), surface());
                    break;
                case 5:
                    navigation.update(number());
                    break;
                case 6:
                    navigation.setDistanceSeen(number());
                    break;
                case 7:
                    navigation.setSpeedFactor(number());
                    break;
                case 8:
                    navigation.setMode(NavigationMode(dice.below(3)));
                    break;
                case 9:
                    navigation.setKeys({.forward = dice.below(2) == 0, .up = dice.below(2) == 0});
                    break;
                case 10:
                    navigation.frame(boxes[dice.below(std::size(boxes))]);
                    break;
                case 11:
                    navigation.axisView(AxisView(dice.below(7)));
                    break;
                case 12:
                    navigation.setSize(int(dice.below(3)) - 1, 200);
                    break;
                case 13:
                    navigation.setWorldUp({number(), number(), number()});
                    hlod::Camera camera = Place{}.home();
                    camera.eye = {number(), 1, number()};
                    dice.below(2) == 0 ? navigation.goTo(camera) : navigation.jumpTo(camera);
                    break;
            }
            ASSERT_TRUE(test::isFinite(navigation.camera())) << i;
        }
    }
}

}  // namespace
}  // namespace pagoda::viewer
