// `path` on generated scenes: what the eye does, checked against all triangles by brute force.
#include "tests/tools/run_program.h"

#include "hlod/view/camera_path.h"
#include "ooc/base/file.h"
#include "ooc/readers/reader.h"
#include "tools/generate/collected_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace pagoda::tests {
namespace {

namespace fs = std::filesystem;
using hlod::Camera;
using hlod::CameraPath;

// Moller and Trumbore, 1997: where along the ray, in lengths of `way`; no hit: infinite.
double hitAt(const Vec3d& from, const Vec3d& way, const Vec3f* t) {
    const Vec3d a(t[0]), e1 = Vec3d(t[1]) - a, e2 = Vec3d(t[2]) - a;
    const Vec3d p = glm::cross(way, e2);
    const double det = glm::dot(e1, p);
    if (std::abs(det) < 1e-14) return INFINITY;
    const Vec3d s = from - a, q = glm::cross(s, e1);
    const double u = glm::dot(s, p) / det, v = glm::dot(way, q) / det;
    const double at = glm::dot(e2, q) / det;
    return u < 0 || v < 0 || u + v > 1 || at < 0 ? INFINITY : at;
}

// Ericson, Real-Time Collision Detection, 5.1.5.
double distanceTo(const Vec3d& p, const Vec3f* t) {
    const Vec3d a(t[0]), b(t[1]), c(t[2]), ab = b - a, ac = c - a, ap = p - a;
    const auto away = [&](const Vec3d& q) { return glm::length(p - q); };
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return away(a);
    const Vec3d bp = p - b, cp = p - c;
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return away(b);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return away(a + ab * (d1 / (d1 - d3)));
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return away(c);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return away(a + ac * (d2 / (d2 - d6)));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) {
        return away(b + (c - b) * ((d4 - d3) / (d4 - d3 + d5 - d6)));
    }
    return away(a + (ab * vb + ac * vc) / (va + vb + vc));
}

// An interior as .glb: y up, with glass.
class Path : public testing::Test {
protected:
    static void SetUpTestSuite() {
        std::string name = (fs::temp_directory_path() / "pagoda-path-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        ASSERT_EQ(runPagoda("generate interior --triangles 60000 -o " + file("in.glb")).exitCode,
                  0);
        build("in.glb", "in.pagoda");
        ooc::openReader(file("in.glb"), {})->read(scene_);
        for (const Vec3f& corner : scene_.corners) box_.extend(Vec3d(corner));
    }
    static void TearDownTestSuite() {
        fs::remove_all(folder_);
        scene_ = {};
    }

    static std::string file(const std::string& name) { return (folder_ / name).string(); }
    static void build(const std::string& mesh, const std::string& database) {
        const ProgramRun run =
            runPagoda("build --threads 1 " + file(mesh) + " -o " + file(database));
        ASSERT_EQ(run.exitCode, 0) << run.err;
    }
    static std::string text(const std::string& name) {
        const auto bytes = readWholeFile(file(name), hlod::kMaxPathBytes);
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    }
    static CameraPath make(const std::string& options, const std::string& database = "in.pagoda") {
        const ProgramRun run =
            runPagoda("path " + file(database) + " --force -o " + file("p.json") + " " + options);
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return hlod::parseCameraPath(text("p.json"), Camera{}, file("p.json"));
    }

    // The nearest hit, in lengths of `way`.
    static double hit(const Vec3d& from, const Vec3d& way) {
        double nearest = INFINITY;
        for (size_t t = 0; t < scene_.triangleCount(); ++t) {
            if (scene_.isTranslucent(t)) continue;
            nearest = std::min(nearest, hitAt(from, way, &scene_.corners[3 * t]));
        }
        return nearest;
    }
    static double distanceToModel(const Vec3d& eye) {
        double nearest = INFINITY;
        for (size_t t = 0; t < scene_.triangleCount(); ++t) {
            nearest = std::min(nearest, distanceTo(eye, &scene_.corners[3 * t]));
        }
        return nearest;
    }
    static double diagonal() { return glm::length(box_.max - box_.min); }

    static void expectClear(const CameraPath& path) {
        for (size_t i = 1; i < path.frames.size(); ++i) {
            const Vec3d from = path.frames[i - 1].eye, to = path.frames[i].eye;
            if (from == to) continue;
            EXPECT_GT(hit(from, to - from), 1.0) << "frame " << i;
        }
    }
    static void expectSteps(const CameraPath& path, double mostTurn, double mostMove) {
        for (size_t i = 1; i < path.frames.size(); ++i) {
            const hlod::PathStep step = hlod::stepBetween(path.frames[i - 1], path.frames[i]);
            EXPECT_TRUE(step.turnDegrees >= 1 || step.moveModelUnits >= 0.002 * diagonal())
                << path.kind << " frame " << i << ": " << step.turnDegrees << " degrees, "
                << step.moveModelUnits;
            EXPECT_LE(step.turnDegrees, mostTurn * 1.0001) << path.kind << " frame " << i;
            EXPECT_LE(step.moveModelUnits, mostMove * 1.0001) << path.kind << " frame " << i;
        }
    }

    static fs::path folder_;
    static tools::CollectedScene scene_;
    static Box3d box_;
};

fs::path Path::folder_;
tools::CollectedScene Path::scene_;
Box3d Path::box_;

TEST_F(Path, AWalkCrossesNoTriangleAndKeepsItsDistance) {
    const CameraPath path = make("--kind walk --frames 300");
    ASSERT_EQ(path.frames.size(), 300u);
    expectClear(path);
    for (size_t i = 0; i < path.frames.size(); i += 3) {
        EXPECT_GT(distanceToModel(path.frames[i].eye), 0.08) << "frame " << i;
    }
}

TEST_F(Path, AWalkHasAFloorUnderItAndACeilingAboveIt) {
    for (const Camera& camera : make("--kind walk --frames 150 --seed 5").frames) {
        const double floor = hit(camera.eye, {0, -1, 0});
        EXPECT_GT(floor, 1.35);
        EXPECT_LT(floor, 2.0);
        EXPECT_LT(hit(camera.eye, {0, 1, 0}), 3.0);
        EXPECT_EQ(camera.up, Vec3d(0, 1, 0));
    }
}

TEST_F(Path, AWalkComesThroughSeveralRooms) {
    for (const int seed : {1, 2, 3}) {
        // Rooms of the generator: 6.2 m wide, 6.4 m deep, on both sides of a corridor.
        std::set<std::pair<int, int>> rooms;
        const CameraPath path = make("--kind walk --frames 600 --seed " + std::to_string(seed));
        for (const Camera& camera : path.frames) {
            const double y = -camera.eye.z;
            const int row = y < 6.4 ? 0 : y > 9.0 ? 2 : 1;
            rooms.emplace(row == 1 ? 0 : static_cast<int>(camera.eye.x / 6.2), row);
        }
        EXPECT_GE(rooms.size(), 3u) << "seed " << seed;
    }
}

TEST_F(Path, EveryStepChangesThePictureAndNoneJumps) {
    const double walked = std::max(0.17, 0.002 * diagonal());
    expectSteps(make("--kind walk --frames 300"), 4, walked);
    expectSteps(make("--kind walk --frames 100 --speed 4"), 16, 4 * walked);
    expectSteps(make("--kind walk --frames 100 --speed 0.01"), 1.001, 0.0021 * diagonal());
    expectSteps(make("--kind fly --frames 300"), 3, 0.02 * diagonal());
    expectSteps(make("--kind orbit --frames 200"), 1.8, 0.1 * diagonal());
    expectSteps(make("--kind orbit --frames 720"), 1.2, 0.1 * diagonal());
}

TEST_F(Path, TheSameSeedGivesTheSameBytesAndAnotherSeedOthers) {
    for (const std::string kind : {"orbit", "walk", "fly", "teleport"}) {
        const std::string options = "--frames 90 --kind " + kind;
        (void)make(options + " --seed 4");
        const std::string first = text("p.json");
        (void)make(options + " --seed 4");
        EXPECT_EQ(text("p.json"), first) << kind;
        (void)make(options + " --seed 5");
        EXPECT_NE(text("p.json"), first) << kind;
    }
}

TEST_F(Path, TeleportsStandStillBetweenJumpsInside) {
    const CameraPath path = make("--kind teleport --frames 100 --hold 20");
    ASSERT_EQ(path.frames.size(), 100u);
    for (size_t i = 1; i < path.frames.size(); ++i) {
        const Camera &before = path.frames[i - 1], &camera = path.frames[i];
        if (i % 20 != 0) {
            EXPECT_EQ(camera, before) << "frame " << i;
            continue;
        }
        EXPECT_GT(glm::length(camera.eye - before.eye), 0.5) << "frame " << i;
        EXPECT_LT(hit(camera.eye, {0, -1, 0}), 2.0);
        EXPECT_LT(hit(camera.eye, {0, 1, 0}), 3.0);
    }
}

TEST_F(Path, AnOrbitTurnsFullyWithAllOfTheModelInView) {
    const CameraPath path = make("--kind orbit --frames 200");
    double turned = 0;
    const Vec3d centre = 0.5 * (box_.min + box_.max);
    for (size_t i = 0; i < path.frames.size(); ++i) {
        const hlod::View view(path.frames[i], box_);
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d at(corner & 1 ? box_.max.x : box_.min.x,
                           corner & 2 ? box_.max.y : box_.min.y,
                           corner & 4 ? box_.max.z : box_.min.z);
            const Vec3d from = at - view.eye();
            const double depth = glm::dot(from, view.forward());
            EXPECT_LE(std::abs(glm::dot(from, view.right())), depth * view.tanX());
            EXPECT_LE(std::abs(glm::dot(from, view.up())), depth * view.tanY());
        }
        if (i == 0) continue;
        const Vec3d a = path.frames[i - 1].eye - centre, b = path.frames[i].eye - centre;
        turned += std::atan2(a.z * b.x - a.x * b.z, a.x * b.x + a.z * b.z);
    }
    EXPECT_NEAR(turned, 2 * 3.14159265 * 199 / 200, 1e-3);
    const CameraPath zoomed = make("--kind orbit --frames 200 --zoom 2");
    EXPECT_EQ(zoomed.frames[7].eye, path.frames[7].eye);
    const double tangent = std::tan(path.frames[0].fovyDegrees * 3.14159265358979 / 360);
    EXPECT_NEAR(std::tan(zoomed.frames[0].fovyDegrees * 3.14159265358979 / 360), tangent / 2, 1e-9);
}

TEST_F(Path, AFlightComesCloseAndGoesAwayWithoutTouching) {
    const CameraPath path = make("--kind fly --frames 250");
    expectClear(path);
    double nearest = INFINITY, farthest = 0;
    for (size_t i = 0; i < path.frames.size(); i += 5) {
        const double away = distanceToModel(path.frames[i].eye) / diagonal();
        nearest = std::min(nearest, away);
        farthest = std::max(farthest, away);
    }
    EXPECT_GT(nearest, 0.005);
    EXPECT_LT(nearest, 0.06);
    EXPECT_GT(farthest, 0.12);
}

TEST_F(Path, AModelInMillimetresNeedsTheEyeHeightInMillimetres) {
    std::ofstream mesh(file("mm.ply"), std::ios::binary);
    mesh << "ply\nformat binary_little_endian 1.0\nelement vertex " << scene_.corners.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
         << scene_.triangleCount() << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3f& corner : scene_.corners) {
        const Vec3f upright = 1000.0f * Vec3f(corner.x, -corner.z, corner.y);
        mesh.write(reinterpret_cast<const char*>(&upright), sizeof upright);
    }
    for (int t = 0; t < static_cast<int>(scene_.triangleCount()); ++t) {
        const int corners[3] = {3 * t, 3 * t + 1, 3 * t + 2};
        mesh.put(3).write(reinterpret_cast<const char*>(corners), sizeof corners);
    }
    mesh.close();
    build("mm.ply", "mm.pagoda");
    const CameraPath path = make("--kind walk --frames 60 --eye-height 1700", "mm.pagoda");
    for (const Camera& camera : path.frames) {
        const Vec3d metres = 0.001 * Vec3d(camera.eye.x, camera.eye.z, -camera.eye.y);
        EXPECT_NEAR(hit(metres, {0, -1, 0}), 1.7, 0.35);
        EXPECT_EQ(camera.up, Vec3d(0, 0, 1));
    }
    const ProgramRun guessed = runPagoda("path " + file("mm.pagoda") +
                                         " --kind walk --frames 5 "
                                         "--force -o " +
                                         file("p.json"));
    EXPECT_NE(guessed.err.find("hardly in metres"), std::string::npos) << guessed.err;
}

TEST_F(Path, AModelWithoutRoomsIsToldToFly) {
    std::ofstream(file("field.off")) << "OFF\n4 2 0\n0 0 0\n90 0 0\n90 90 0\n0 90 1\n3 0 1 2\n"
                                        "3 0 2 3\n";
    build("field.off", "field.pagoda");
    const ProgramRun walk =
        runPagoda("path " + file("field.pagoda") + " --kind walk --force -o " + file("p.json"));
    EXPECT_EQ(walk.exitCode, 1);
    EXPECT_NE(walk.err.find("no indoor floor"), std::string::npos) << walk.err;
    EXPECT_NE(walk.err.find("--kind fly"), std::string::npos) << walk.err;
    for (const std::string kind : {"fly", "orbit", "teleport"}) {
        EXPECT_EQ(make("--frames 50 --kind " + kind, "field.pagoda").frames.size(), 50u) << kind;
    }
}

TEST_F(Path, AnExistingFileStaysWithoutForce) {
    (void)make("--frames 3");
    const std::string before = text("p.json");
    const ProgramRun again =
        runPagoda("path " + file("in.pagoda") + " --frames 4 -o " + file("p.json"));
    EXPECT_EQ(again.exitCode, 1);
    EXPECT_NE(again.err.find("exists already"), std::string::npos) << again.err;
    EXPECT_EQ(text("p.json"), before);
}

}  // namespace
}  // namespace pagoda::tests
