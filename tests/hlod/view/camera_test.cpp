#include "hlod/view/camera.h"

#include "ooc/base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace pagoda::hlod {
namespace {

Camera towards(const Vec3d& eye, const Vec3d& target) {
    Camera camera;
    camera.eye = eye;
    camera.target = target;
    return camera;
}

// Where a point falls in the picture: x and y in [-1, 1] inside, z its distance along the view.
Vec3d projected(const View& view, const Vec3d& point) {
    const Vec3d p = point - view.eye();
    const double z = glm::dot(view.forward(), p);
    return {glm::dot(view.right(), p) / (z * view.tanX()),
            glm::dot(view.up(), p) / (z * view.tanY()), z};
}

TEST(Camera, ScreenSpaceErrorFollowsTheFormula) {
    Camera camera = towards({0, 0, 10}, {0, 0, 0});
    camera.fovyDegrees = 90;  // tan of half is 1
    camera.heightPx = 800;
    const View view(camera, {});
    // The box's nearest point is 8 away: 0.02 * 800 / (2 * 1 * 8) = 1.
    EXPECT_NEAR(view.ssePx(0.02, {{-1, -1, -2}, {1, 1, 2}}), 1.0, 1e-12);
    // Beside the box: nearest point (1, 0, 10) is 0 away in y and z, so 3 away along x.
    EXPECT_NEAR(view.ssePx(0.03, {{3, -1, 9}, {4, 1, 11}}), 0.03 * 800 / (2 * 3), 1e-12);
    // Around the eye: as at the near plane.
    EXPECT_NEAR(view.ssePx(0.02, {{-1, -1, 9}, {1, 1, 11}}),
                0.02 * 800 / (2 * view.nearModelUnits()), 1e-9);
    EXPECT_EQ(view.ssePx(0.0, {{-1, -1, 9}, {1, 1, 11}}), 0.0);
}

TEST(Camera, LooksWhereItIsTold) {
    const View view(towards({1, 2, 3}, {1, 2, -5}), {});
    EXPECT_EQ(view.forward(), Vec3d(0, 0, -1));
    EXPECT_EQ(view.right(), Vec3d(1, 0, 0));
    EXPECT_EQ(view.up(), Vec3d(0, 1, 0));
    // 45 degrees at 4:3: a point at the upper right corner.
    const double tanY = std::tan(3.14159265358979323846 / 8);
    const Vec3d corner(1 + 4 * tanY * 4.0 / 3, 2 + 4 * tanY, -1);
    EXPECT_NEAR(projected(view, corner).x, 1.0, 1e-12);
    EXPECT_NEAR(projected(view, corner).y, 1.0, 1e-12);
}

TEST(Camera, LooksAlongItsUpVectorToo) {
    for (const Vec3d& direction : {Vec3d(0, 1, 0), Vec3d(0, -1, 0)}) {
        const View view(towards({0, 0, 0}, direction), {});
        EXPECT_NEAR(glm::length(view.right()), 1.0, 1e-12);
        EXPECT_NEAR(glm::dot(view.right(), view.forward()), 0.0, 1e-12);
        EXPECT_NEAR(glm::dot(view.right(), view.up()), 0.0, 1e-12);
    }
}

TEST(Camera, FrustumKeepsEveryBoxThatAPointOfThePictureProves) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-30, 30), size(0, 8), share(0, 1);
    const View view(towards({3, -2, 8}, {-1, 4, -6}), Box3d{{-40, -40, -40}, {40, 40, 40}});
    int kept = 0, culled = 0, seen = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3d corner(place(random), place(random), place(random));
        const Box3d box{corner, corner + Vec3d(size(random), size(random), size(random))};
        bool isSeen = false;
        for (int sample = 0; sample < 200 && !isSeen; ++sample) {
            const Vec3d inBox(share(random), share(random), share(random));
            const Vec3d p = projected(view, box.min + inBox * (box.max - box.min));
            isSeen = p.z > view.nearModelUnits() && std::abs(p.x) <= 1 && std::abs(p.y) <= 1;
        }
        const bool isKept = view.intersectsFrustum(box);
        EXPECT_TRUE(isKept || !isSeen);
        (isKept ? kept : culled) += 1;
        seen += isSeen ? 1 : 0;
    }
    // It culls: of what no sample proves, only boxes that span several planes' outsides remain.
    EXPECT_GT(culled, 2000);
    EXPECT_LT(kept - seen, kept / 4);
}

TEST(Camera, FramesABoxFromEveryDirectionWithoutCuttingOrWastingThePicture) {
    const Box3d box{{500000, -3, 20}, {500040, 7, 26}};
    for (const UpAxis up : {UpAxis::Y, UpAxis::Z}) {
        for (const char* name : {"front", "back", "left", "right", "top", "bottom", "iso", "+x+y+z",
                                 "-x+y-z", "+z", "-y+x"}) {
            const Camera camera = frameBox({}, box, viewDirection(name, up), up);
            const View view(camera, box);
            double widest = 0;
            for (int i = 0; i < 8; ++i) {
                const Vec3d corner((i & 1) != 0 ? box.max.x : box.min.x,
                                   (i & 2) != 0 ? box.max.y : box.min.y,
                                   (i & 4) != 0 ? box.max.z : box.min.z);
                const Vec3d p = projected(view, corner);
                EXPECT_GT(p.z, view.nearModelUnits()) << name;
                EXPECT_LT(std::abs(p.x), 0.95) << name;
                EXPECT_LT(std::abs(p.y), 0.95) << name;
                widest = std::max({widest, std::abs(p.x), std::abs(p.y)});
            }
            EXPECT_GT(widest, 0.93) << name;
        }
    }
}

TEST(Camera, FramesNothingAndAPointFromSomewhere) {
    EXPECT_TRUE(std::isfinite(frameBox({}, Box3d{}, {0, 0, 1}, UpAxis::Y).eye.z));
    const Camera camera = frameBox({}, Box3d{{1, 2, 3}, {1, 2, 3}}, {0, 0, 1}, UpAxis::Y);
    EXPECT_EQ(camera.eye, Vec3d(1, 2, 4));
}

TEST(Camera, FrontIsPlusZWithYUpAndMinusYWithZUp) {
    EXPECT_EQ(viewDirection("front", UpAxis::Y), Vec3d(0, 0, 1));
    EXPECT_EQ(viewDirection("front", UpAxis::Z), Vec3d(0, -1, 0));
    EXPECT_EQ(viewDirection("top", UpAxis::Z), Vec3d(0, 0, 1));
    EXPECT_NEAR(viewDirection("+x-y+z", UpAxis::Y).y, -1 / std::sqrt(3.0), 1e-12);
    for (const char* name : {"", "above", "+x+x", "+w", "x", "+x-x", "+x+"}) {
        EXPECT_THROW(static_cast<void>(viewDirection(name, UpAxis::Y)), Error) << name;
    }
}

TEST(Camera, ComesBackFromItsJson) {
    Camera camera = towards({1e7 + 0.125, -2, 1e-9}, {0.1, 0.2, 0.3});
    camera.fovyDegrees = 33.3;
    camera.nearModelUnits = 0.01;
    EXPECT_EQ(parseCamera(cameraToJson(camera), {}), camera);
    // Keys that are left out keep their value.
    EXPECT_EQ(parseCamera(R"({"fovy":33.3,"near":0.01})", towards(camera.eye, camera.target)),
              camera);
}

TEST(Camera, RefusesWhatIsNoCamera) {
    for (const char* text :
         {"", "[]", "{", R"({"eye":[1,2]})", R"({"eye":[1,2,"3"]})",
          R"({"eye":[0,0,0],"target":[0,0,0]})", R"({"fovy":0})", R"({"fovy":180})",
          R"({"up":[0,0,0]})", R"({"width":0})", R"({"width":1.5})", R"({"height":99999})",
          R"({"near":-1})", R"({"zoom":2})", R"({"eye":[1e999,0,0]})"}) {
        EXPECT_THROW(static_cast<void>(parseCamera(text, {})), Error) << text;
    }
}

TEST(Camera, UpIsWhatTheMetadataSaysWhateverElseStandsThere) {
    EXPECT_EQ(upAxisOf(R"({"up": "y"})"), UpAxis::Y);
    for (const char* text :
         {R"({"up": "z"})", R"({"up": 5})", R"({"up": null})", "{}", "[]", "no"}) {
        EXPECT_EQ(upAxisOf(text), UpAxis::Z) << text;
    }
}

TEST(Camera, PutsTheNearPlaneBeforeTheWholeScene) {
    const Box3d box{{-1, -1, -1}, {1, 1, 1}};
    std::mt19937 random(9);
    std::uniform_real_distribution<double> place(-6, 6);
    for (int i = 0; i < 500; ++i) {
        Camera camera = towards({place(random), place(random), place(random)},
                                {place(random), place(random), place(random)});
        camera.fovyDegrees = 100;
        const View view(camera, box);
        for (int sample = 0; sample < 50; ++sample) {
            const Vec3d point = Vec3d(place(random), place(random), place(random)) / 6.0;
            const Vec3d p = projected(view, point);
            if (p.z <= 0 || std::abs(p.x) > 1 || std::abs(p.y) > 1) continue;
            if (box.contains(view.eye())) continue;
            EXPECT_GT(p.z, view.nearModelUnits());
        }
    }
}

}  // namespace
}  // namespace pagoda::hlod
