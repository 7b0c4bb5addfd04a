// Keys that move, transitions, framing.
#include "viewer/navigation.h"

#include "tests/viewer/navigation_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace pagoda::viewer {
namespace {

using test::Dice;
using test::kPlaces;
using test::kUpY;
using test::kUpZ;
using test::Place;

constexpr uint64_t kSeed = 12;
constexpr double kFrameS = 0.01;

void runTransition(Navigation& navigation) {
    for (int i = 0; i < 36; ++i) navigation.update(kFrameS);
    EXPECT_FALSE(navigation.isInTransition());
}

// Two seconds of flight with turns, cut into frames.
hlod::Camera flown(NavigationMode mode, int framesPerTurn, const Place& place) {
    Navigation navigation = place.navigation();
    navigation.setMode(mode);
    navigation.setDistanceSeen(place.scale);
    for (int i = 0; i < 50; ++i) {
        navigation.setKeys({.forward = i % 20 < 15,
                            .left = i % 7 < 3,
                            .right = i > 30,
                            .up = i % 11 < 4,
                            .fast = i > 40,
                            .slow = i < 5});
        navigation.beginDrag(DragKind::Look, {400, 300}, std::nullopt);
        navigation.dragTo({400.0 + i, 290});
        navigation.endDrag();
        for (int k = 0; k < framesPerTurn; ++k) navigation.update(0.04 / framesPerTurn);
    }
    return navigation.camera();
}

TEST(NavigationMoves, TheWayDoesNotDependOnTheFrameRate) {
    for (const Place& place : kPlaces) {
        for (const NavigationMode mode : {NavigationMode::Fly, NavigationMode::Walk}) {
            const hlod::Camera slow = flown(mode, 1, place), fast = flown(mode, 4, place);
            const double way = glm::length(slow.eye - place.home().eye);
            EXPECT_GT(way, 0.1 * place.scale);
            EXPECT_LE(glm::length(slow.eye - fast.eye),
                      1e-9 * way + 100 * place.roundingModelUnits());
        }
    }
}

TEST(NavigationMoves, KeysMoveRelativeToTheViewAndWalkingStaysLevel) {
    const auto moved = [](NavigationMode mode, const MoveKeys& keys) {
        Navigation navigation = Place{}.navigation();
        navigation.setMode(mode);
        navigation.setKeys(keys);
        for (int i = 0; i < 10; ++i) navigation.update(0.1);
        return navigation.camera().eye - Place{}.home().eye;
    };
    const auto axes = test::axesOf(Place{}.home());
    const Vec3d ahead = moved(NavigationMode::Fly, {.forward = true});
    EXPECT_LE(glm::length(glm::normalize(ahead) - axes.forward), 1e-9);
    EXPECT_LE(glm::length(moved(NavigationMode::Fly, {.back = true}) + ahead), 1e-9);
    EXPECT_LE(glm::length(glm::normalize(moved(NavigationMode::Fly, {.right = true})) - axes.right),
              1e-9);
    EXPECT_LE(glm::length(glm::normalize(moved(NavigationMode::Fly, {.up = true})) - kUpZ), 1e-9);
    // Two keys are not faster than one; opposite ones cancel.
    EXPECT_NEAR(glm::length(moved(NavigationMode::Fly, {.forward = true, .right = true})),
                glm::length(ahead), 1e-9);
    EXPECT_EQ(moved(NavigationMode::Fly, {.left = true, .right = true}), Vec3d(0.0));
    const Vec3d walked = moved(NavigationMode::Walk, {.forward = true});
    EXPECT_NEAR(walked.z, 0, 1e-12);
    EXPECT_NEAR(glm::length(walked), glm::length(ahead), 1e-9);
    EXPECT_GT(glm::dot(walked, axes.forward), 0);
    EXPECT_EQ(moved(NavigationMode::Orbit, {.forward = true}), Vec3d(0.0));
}

TEST(NavigationMoves, OneMovesOnWhileOneLooksRound) {
    Navigation still = Place{}.navigation();
    still.setMode(NavigationMode::Walk);
    still.setKeys({.up = true});
    Navigation looking = still;
    looking.beginDrag(DragKind::Look, {400, 300}, std::nullopt);
    for (int i = 0; i < 50; ++i) {
        looking.dragTo({400.0 + 3 * i, 300.0 + i});
        still.update(kFrameS);
        looking.update(kFrameS);
        EXPECT_LE(glm::length(still.camera().eye - looking.camera().eye), 1e-12);
    }
}

TEST(NavigationMoves, WalkingGoesOnWhenOneLooksStraightDown) {
    Navigation navigation = Place{}.navigation();
    navigation.setMode(NavigationMode::Walk);
    navigation.beginDrag(DragKind::Look, {400, 300}, std::nullopt);
    navigation.dragTo({400, 9000});
    navigation.setKeys({.forward = true});
    const Vec3d before = navigation.camera().eye;
    EXPECT_LT(test::axesOf(navigation.camera()).forward.z, -0.999);
    for (int i = 0; i < 10; ++i) navigation.update(0.1);
    EXPECT_GT(glm::length(navigation.camera().eye - before), 0.05);
    EXPECT_NEAR(navigation.camera().eye.z, before.z, 1e-12);
}

TEST(NavigationMoves, TheSpeedFollowsWhatIsSeenWithinBoundsAndTheKeysAndFactor) {
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        const double diagonal = glm::length(place.box().max - place.box().min);
        const auto speedAt = [&](double distance) {
            navigation.setDistanceSeen(distance);
            return navigation.speedModelUnitsPerSecond();
        };
        EXPECT_NEAR(speedAt(0.2 * diagonal) / speedAt(0.1 * diagonal), 2, 1e-9);
        EXPECT_GT(speedAt(0), 1e-5 * diagonal);
        EXPECT_LT(speedAt(1e9 * diagonal), 10 * diagonal);
        EXPECT_GT(speedAt(std::numeric_limits<double>::infinity()), 0.01 * diagonal);
        EXPECT_LT(speedAt(std::numeric_limits<double>::infinity()), diagonal);
        const double plain = speedAt(0.1 * diagonal);
        navigation.setKeys({.fast = true});
        EXPECT_NEAR(navigation.speedModelUnitsPerSecond(), 4 * plain, 1e-9 * plain);
        navigation.setKeys({.slow = true});
        EXPECT_NEAR(navigation.speedModelUnitsPerSecond(), plain / 4, 1e-9 * plain);
        navigation.setKeys({});
        navigation.setSpeedFactor(3);
        EXPECT_NEAR(navigation.speedModelUnitsPerSecond(), 3 * plain, 1e-9 * plain);
        // It is what one moves by, once up to speed.
        navigation.setMode(NavigationMode::Fly);
        navigation.setKeys({.forward = true});
        for (int i = 0; i < 20; ++i) navigation.update(0.1);
        const Vec3d before = navigation.camera().eye;
        navigation.update(0.1);
        EXPECT_NEAR(glm::length(navigation.camera().eye - before), 0.3 * plain,
                    1e-6 * plain + place.roundingModelUnits());
    }
}

TEST(NavigationMoves, NothingIsDrawnAnewWhenNothingChanges) {
    Navigation navigation = Place{}.navigation();
    EXPECT_TRUE(navigation.update(kFrameS));  // the first picture
    EXPECT_FALSE(navigation.update(kFrameS));
    navigation.wheel(1, {400, 300}, std::nullopt);
    EXPECT_TRUE(navigation.update(kFrameS));
    EXPECT_FALSE(navigation.update(kFrameS));
    navigation.setMode(NavigationMode::Fly);
    navigation.setKeys({.forward = true});
    EXPECT_TRUE(navigation.update(kFrameS));
    navigation.setKeys({});
    int frames = 0;
    while (navigation.update(kFrameS)) ASSERT_LT(++frames, 100);  // comes to rest within a second
    EXPECT_GT(frames, 5);                                         // and not at once
    navigation.frameAll();
    runTransition(navigation);
    EXPECT_FALSE(navigation.update(kFrameS));
}

TEST(NavigationMoves, TransitionsEndAtTheCameraByTheShortWayWithoutRoll) {
    SCOPED_TRACE(kSeed);
    Dice dice(kSeed);
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        const Vec3d up = glm::normalize(place.up);
        for (int i = 0; i < 50; ++i) {
            hlod::Camera end = place.home();
            end.eye = place.origin + 4 * place.scale * dice.direction();
            end.target = dice.pointIn(place.box());
            const auto heading = [&](const hlod::Camera& camera) {
                const Vec3d forward = test::axesOf(camera).forward;
                return glm::normalize(forward - glm::dot(forward, up) * up);
            };
            const auto angle = [](const Vec3d& a, const Vec3d& b) {
                return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
            };
            const double wholeTurn = angle(heading(navigation.camera()), heading(end));
            double turned = 0;
            navigation.goTo(end);
            for (int k = 0; k < 36; ++k) {
                const hlod::Camera before = navigation.camera();
                ASSERT_TRUE(k == 35 || navigation.isInTransition());
                navigation.update(kFrameS);
                turned += angle(heading(before), heading(navigation.camera()));
                ASSERT_NEAR(glm::dot(test::axesOf(navigation.camera()).right, up), 0, 1e-9);
                ASSERT_LT(glm::length(navigation.camera().eye - place.origin), 30 * place.scale);
            }
            EXPECT_NEAR(turned, wholeTurn, 1e-6);
            EXPECT_EQ(navigation.camera(), end);
        }
    }
}

TEST(NavigationMoves, ATransitionIsEasedAndGoesRoundTheSceneRatherThanThroughIt) {
    Navigation navigation = Place{}.navigation();
    navigation.axisView(AxisView::Front);
    runTransition(navigation);
    navigation.axisView(AxisView::Right);
    Vec3d before = navigation.camera().eye;
    double first = 0, most = 0;
    for (int i = 0; i < 36; ++i) {
        navigation.update(kFrameS);
        const double step = glm::length(navigation.camera().eye - before);
        if (i == 0) first = step;
        most = std::max(most, step);
        before = navigation.camera().eye;
        EXPECT_GT(glm::length(navigation.camera().eye), 2);
        // What is looked at stays where it is.
        const glm::dvec2 px = test::project(navigation.camera(), Vec3d(0.0));
        EXPECT_LE(glm::length(px - glm::dvec2(400, 300)), 1);
    }
    EXPECT_LT(first, 0.2 * most);
}

TEST(NavigationMoves, ADragOrAKeyEndsATransitionWhereItIs) {
    const auto inTransition = [] {
        Navigation navigation = Place{}.navigation();
        navigation.setMode(NavigationMode::Fly);
        navigation.axisView(AxisView::Back);
        for (int i = 0; i < 10; ++i) navigation.update(kFrameS);
        return navigation;
    };
    Navigation navigation = inTransition();
    const hlod::Camera half = navigation.camera();
    navigation.beginDrag(DragKind::Pan, {400, 300}, std::nullopt);
    EXPECT_FALSE(navigation.isInTransition());
    EXPECT_EQ(navigation.camera(), half);
    navigation.endDrag();
    navigation.update(1);
    EXPECT_EQ(navigation.camera(), half);
    navigation = inTransition();
    navigation.setKeys({.fast = true});
    EXPECT_TRUE(navigation.isInTransition());
    navigation.setKeys({.back = true});
    EXPECT_FALSE(navigation.isInTransition());
    navigation = inTransition();
    navigation.wheel(1, {400, 300}, std::nullopt);
    EXPECT_FALSE(navigation.isInTransition());
}

TEST(NavigationMoves, FramingSeesTheWholeBoxAtAnyAspect) {
    SCOPED_TRACE(kSeed);
    Dice dice(kSeed);
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        for (int i = 0; i < 100; ++i) {
            const int width = 1 << dice.below(12), height = 1 << dice.below(12);
            navigation.setSize(width, height);
            const glm::dvec2 px(0.5 * width, 0.5 * height);
            navigation.beginDrag(DragKind::Look, px, std::nullopt);
            navigation.dragTo(px + dice.between(-1, 1) * glm::dvec2(height, -height));
            const auto before = test::axesOf(navigation.camera());
            Box3d box;
            box.extend(dice.pointIn(place.box()));
            box.extend(dice.pointIn(place.box()));
            i % 2 == 0 ? navigation.frame(box) : navigation.frameAll();
            if (i % 2 == 1) box = place.box();
            runTransition(navigation);
            const hlod::Camera& camera = navigation.camera();
            EXPECT_LE(glm::length(test::axesOf(camera).forward - before.forward), 1e-9);
            double closest = 1;  // to an edge of the picture, as a share of it
            for (int corner = 0; corner < 8; ++corner) {
                const Vec3d point((corner & 1) ? box.min.x : box.max.x,
                                  (corner & 2) ? box.min.y : box.max.y,
                                  (corner & 4) ? box.min.z : box.max.z);
                ASSERT_GT(test::depthOf(camera, point), 0);
                const glm::dvec2 at = test::project(camera, point) / glm::dvec2(width, height);
                closest = std::min({closest, at.x, at.y, 1 - at.x, 1 - at.y});
            }
            ASSERT_GT(closest, 0);
            ASSERT_LT(closest, 0.05);  // and fills the picture
        }
    }
}

TEST(NavigationMoves, FramingAPointGoesNearItAsTheScenesSizeHasIt) {
    for (const Place& place : kPlaces) {
        Navigation navigation = place.navigation();
        const Vec3d point = place.origin + Vec3d(0.5 * place.scale);
        navigation.frame({point, point});
        runTransition(navigation);
        const double distance = glm::length(navigation.camera().eye - point);
        EXPECT_GT(distance, 1e-4 * place.scale);
        EXPECT_LT(distance, 0.1 * place.scale);
        navigation.frame({});  // nothing: the scene
        runTransition(navigation);
        EXPECT_GT(glm::length(navigation.camera().eye - place.origin), place.scale);
    }
}

TEST(NavigationMoves, AxisViewsAreThoseOfTheCommandLine) {
    const std::pair<AxisView, const char*> views[] = {
        {AxisView::Front, "front"},  {AxisView::Back, "back"}, {AxisView::Left, "left"},
        {AxisView::Right, "right"},  {AxisView::Top, "top"},   {AxisView::Bottom, "bottom"},
        {AxisView::Isometric, "iso"}};
    for (const hlod::UpAxis up : {hlod::UpAxis::Z, hlod::UpAxis::Y}) {
        Place place;
        place.up = up == hlod::UpAxis::Z ? kUpZ : kUpY;
        Navigation navigation = place.navigation();
        for (const auto& [view, name] : views) {
            navigation.axisView(view);
            runTransition(navigation);
            const auto expected =
                hlod::frameBox(place.home(), place.box(), hlod::viewDirection(name, up), up);
            const auto wanted = test::axesOf(expected), got = test::axesOf(navigation.camera());
            EXPECT_LE(glm::length(wanted.forward - got.forward), 1e-9) << name;
            EXPECT_LE(glm::length(wanted.up - got.up), 1e-9) << name;
            EXPECT_LE(glm::length(expected.eye - navigation.camera().eye), 1e-9) << name;
        }
    }
}

TEST(NavigationMoves, HomeIsTheFirstCameraInTheSizeOfNow) {
    Navigation navigation = Place{}.navigation();
    navigation.wheel(3, {10, 10}, std::nullopt);
    navigation.setSize(300, 200);
    navigation.goHome();
    runTransition(navigation);
    hlod::Camera expected = Place{}.home();
    expected.widthPx = 300;
    expected.heightPx = 200;
    EXPECT_EQ(navigation.camera(), expected);
}

TEST(NavigationMoves, AfterAChangeOfUpTheNextFramingIsLevelAgain) {
    Navigation navigation = Place{}.navigation();
    navigation.setWorldUp(5.0 * kUpY);
    EXPECT_EQ(navigation.camera(), Place{}.home());
    navigation.frameAll();
    runTransition(navigation);
    EXPECT_NEAR(test::axesOf(navigation.camera()).right.y, 0, 1e-9);
    EXPECT_GT(test::axesOf(navigation.camera()).up.y, 0);
}

}  // namespace
}  // namespace pagoda::viewer
