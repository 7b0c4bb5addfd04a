// Camera paths as JSON: what is written is read back, what is malformed is refused with its place.
#include "hlod/view/camera_path.h"

#include "ooc/base/error.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace pagoda::hlod {
namespace {

CameraPath someCameras(size_t frames) {
    CameraPath path;
    path.kind = "walk";
    path.seed = 18446744073709551615ull;
    path.framesPerSecond = 23.976;
    path.modelName = "h\"all\n\xC3\xA9.pagoda";
    path.modelDiagonalModelUnits = 1.0 / 3.0;
    for (size_t i = 0; i < frames; ++i) {
        const double t = static_cast<double>(i);
        Camera camera;
        camera.eye = {std::sqrt(t + 2), -1e-300 * t, 1e17 / (t + 1)};
        camera.target = {0.1 + 0.2, t, 5e-324};
        camera.up = {0, 0, 1};
        camera.fovyDegrees = 60 + 1e-13 * t;
        if (i % 3 == 1) camera.nearModelUnits = 1e-9;
        path.frames.push_back(camera);
    }
    return path;
}

CameraPath parse(const std::string& text) {
    return parseCameraPath(text, Camera{}, "p.json");
}

// Place and problem of the error, or "no error".
std::pair<std::string, std::string> faultOf(const std::string& text) {
    try {
        (void)parse(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.path(), "p.json");
        EXPECT_NE(error.remedy(), "");
        return {error.place(), error.problem()};
    }
    return {"", "no error"};
}

TEST(CameraPath, WhatIsWrittenIsReadBackBitForBit) {
    const CameraPath path = someCameras(50);
    const std::string text = cameraPathToJson(path);
    EXPECT_EQ(parse(text), path);
    EXPECT_EQ(cameraPathToJson(parse(text)), text);
}

TEST(CameraPath, ASizeCommonToAllFramesReachesEachOfThem) {
    CameraPath path = someCameras(3);
    path.widthPx = 640;
    path.heightPx = 480;
    const CameraPath again = parse(cameraPathToJson(path));
    EXPECT_EQ(again.widthPx, 640);
    for (const Camera& camera : again.frames) {
        EXPECT_EQ(camera.widthPx, 640);
        EXPECT_EQ(camera.heightPx, 480);
    }
}

TEST(CameraPath, AnotherJsonReaderFindsTheSameNumbers) {
    const CameraPath path = someCameras(5);
    const auto json = nlohmann::json::parse(cameraPathToJson(path));
    ASSERT_EQ(json["frames"].size(), 5u);
    EXPECT_EQ(json["kind"], "walk");
    EXPECT_EQ(json["seed"].get<uint64_t>(), path.seed);
    EXPECT_EQ(json["model"]["name"], path.modelName);
    EXPECT_EQ(json["frames"][4]["eye"][0].get<double>(), path.frames[4].eye.x);
}

TEST(CameraPath, WhatAFrameLeavesOutKeepsTheDefault) {
    Camera defaults;
    defaults.fovyDegrees = 33;
    defaults.up = {0, 0, 1};
    const CameraPath path =
        parseCameraPath(R"({"frames":[{"eye":[1,2,3],"target":[0,0,0]}]})", defaults, "p.json");
    ASSERT_EQ(path.frames.size(), 1u);
    EXPECT_EQ(path.frames[0].fovyDegrees, 33);
    EXPECT_EQ(path.frames[0].up, Vec3d(0, 0, 1));
    EXPECT_EQ(path.frames[0].eye, Vec3d(1, 2, 3));
    EXPECT_EQ(path.framesPerSecond, 30);
}

TEST(CameraPath, MalformedTextIsRefusedWithItsPlace) {
    const std::string frame = R"({"eye":[1,2,3],"target":[0,0,0]})";
    const auto with = [&](const std::string& more) {
        return "{\"frames\":[" + frame + "]," + more + "}";
    };
    EXPECT_EQ(faultOf("").first, "byte 1");
    EXPECT_EQ(faultOf("{\"frames\":[" + frame).second, "not JSON");
    EXPECT_EQ(faultOf("[1]").second, "not a JSON object");
    EXPECT_EQ(faultOf("{}").second, "has no 'frames'");
    EXPECT_EQ(faultOf(R"({"frames":[]})").second, "'frames' is not a list of cameras");
    EXPECT_EQ(faultOf(R"({"frames":7})").second, "'frames' is not a list of cameras");
    EXPECT_EQ(faultOf("{\"frames\":[" + frame + ",7]}").first, "frame 1");
    EXPECT_EQ(faultOf("{\"frames\":[" + frame + R"(,{"eye":[1,2,3]}]})").first, "frame 1");
    const std::string huge = R"(,{"eye":[1,2,3],"target":[0,0,1e308],"fovy":1e999}]})";
    EXPECT_NE(faultOf("{\"frames\":[" + frame + huge).second, "no error");
    EXPECT_EQ(faultOf("{\"frames\":[" + frame + R"(,{"eye":[1,2],"target":[0,0,0]}]})"),
              (std::pair<std::string, std::string>("frame 1", "'eye' is not [x,y,z]")));
    EXPECT_EQ(faultOf("{\"frames\":[" + frame + R"(,{"eye":[1,2,3],"target":[1,2,3]}]})").first,
              "frame 1");
    EXPECT_EQ(
        faultOf(R"({"frames":[{"eye":[1,2,3],"target":[0,0,0],"width":64,"height":48}]})").first,
        "frame 0");
    EXPECT_EQ(faultOf(with(R"("colour":1)")).second, "a path has no 'colour'");
    EXPECT_EQ(faultOf(with(R"("width":64)")).second, "'width' and 'height' go together");
    EXPECT_NE(faultOf(with(R"("width":64,"height":0)")).second, "no error");
    EXPECT_NE(faultOf(with(R"("seed":-1)")).second, "no error");
    EXPECT_NE(faultOf(with(R"("fps":0)")).second, "no error");
    EXPECT_NE(faultOf(with(R"("kind":["walk"])")).second, "no error");
    EXPECT_NE(faultOf(with(R"("model":{"name":1})")).second, "no error");
    EXPECT_NE(faultOf(with(R"("model":{"size":1})")).second, "no error");
}

TEST(CameraPath, DeepAndHugeTextIsRefusedWithoutHarm) {
    EXPECT_NE(faultOf(std::string(1'000'000, '[')).second, "no error");
    EXPECT_NE(faultOf(std::string(kMaxPathBytes + 1, ' ')).second, "no error");
    std::string many = "{\"frames\":[0";
    for (size_t i = 0; i < kMaxPathFrames; ++i) many += ",0";
    EXPECT_EQ(faultOf(many + "]}").second, "more than 200000 frames");
}

TEST(CameraPath, AtASpeedOnlyEveryFactorthFrameStays) {
    const CameraPath path = someCameras(10);
    const CameraPath fast = atSpeed(path, 4);
    ASSERT_EQ(fast.frames.size(), 3u);
    EXPECT_EQ(fast.frames[0], path.frames[0]);
    EXPECT_EQ(fast.frames[1], path.frames[4]);
    EXPECT_EQ(fast.frames[2], path.frames[8]);
    EXPECT_EQ(atSpeed(path, 1), path);
    EXPECT_EQ(atSpeed(path, 2.5).frames[1], path.frames[2]);
    EXPECT_EQ(atSpeed(path, 2.5).frames[3], path.frames[7]);
    EXPECT_EQ(atSpeed(path, 100).frames.size(), 1u);
}

TEST(CameraPath, AStepIsTheAngleOfTheGazesAndTheWayOfTheEyes) {
    Camera from, to;
    from.eye = {0, 0, 0};
    from.target = {1, 0, 0};
    to.eye = {3, 4, 0};
    to.target = to.eye + 7.0 * Vec3d(std::cos(0.5), 0, std::sin(0.5));
    const PathStep step = stepBetween(from, to);
    EXPECT_NEAR(step.turnDegrees, 0.5 * 180 / 3.14159265358979323846, 1e-12);
    EXPECT_DOUBLE_EQ(step.moveModelUnits, 5);
}

}  // namespace
}  // namespace pagoda::hlod
