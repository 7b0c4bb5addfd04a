// `extract` on a generated scene that was built: the leaves are the scene, cuts keep their word.
#include "tests/tools/run_program.h"

#include "ooc/readers/reader.h"
#include "tools/generate/collected_scene.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace pagoda::tests {
namespace {

namespace fs = std::filesystem;

class Extract : public testing::Test {
protected:
    static void SetUpTestSuite() {
        std::string name = (fs::temp_directory_path() / "pagoda-extract-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        ASSERT_EQ(runPagoda("generate interior --triangles 60000 -o " + file("in.glb")).exitCode,
                  0);
        const ProgramRun build =
            runPagoda("build --threads 1 " + file("in.glb") + " -o " + file("in.pagoda"));
        ASSERT_EQ(build.exitCode, 0) << build.err;
    }
    static void TearDownTestSuite() { fs::remove_all(folder_); }

    static std::string file(const std::string& name) { return (folder_ / name).string(); }

    // Triangles written, as the program says.
    static uint64_t extract(const std::string& target, const std::string& options) {
        const ProgramRun run = runPagoda("extract --force --json " + file("in.pagoda") + " -o " +
                                         file(target) + " " + options);
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return nlohmann::json::parse(run.out).at("triangles").get<uint64_t>();
    }
    static tools::CollectedScene read(const std::string& name) {
        tools::CollectedScene scene;
        ooc::openReader(file(name), {})->read(scene);
        return scene;
    }

    static fs::path folder_;
};

fs::path Extract::folder_;

TEST_F(Extract, FullResolutionIsTheInputInEveryFormat) {
    const ProgramRun info = runPagoda("info --json " + file("in.pagoda"));
    const uint64_t leaves = nlohmann::json::parse(info.out).at("triangles").get<uint64_t>();
    for (const char* name : {"all.ply", "all.obj", "all.glb", "all.stl"}) {
        EXPECT_EQ(extract(name, ""), leaves);
        EXPECT_EQ(read(name).triangleCount(), leaves) << name;
    }
}

TEST_F(Extract, NamesMaterialsAndGlassSurvive) {
    const tools::CollectedScene before = read("in.glb");
    (void)extract("named.glb", "");
    const tools::CollectedScene after = read("named.glb");
    std::set<std::string> namesBefore, namesAfter;
    for (const uint32_t object : before.objectOf) namesBefore.insert(before.objects[object].name);
    for (const uint32_t object : after.objectOf) namesAfter.insert(after.objects[object].name);
    EXPECT_EQ(namesBefore, namesAfter);
    const auto glass = [](const tools::CollectedScene& scene) {
        uint64_t count = 0;
        for (size_t t = 0; t < scene.triangleCount(); ++t)
            count += scene.isTranslucent(t) ? uint64_t{1} : 0;
        return count;
    };
    EXPECT_GT(glass(before), 0u);
    EXPECT_EQ(glass(before), glass(after));
}

TEST_F(Extract, ATriangleBudgetIsKeptAndAGreaterErrorGivesFewerTriangles) {
    const uint64_t all = extract("all.stl", "");
    const uint64_t some = extract("some.stl", "--triangles 30000");
    EXPECT_LE(some, 30000u);
    EXPECT_GT(some, 0u);
    EXPECT_EQ(extract("most.stl", "--triangles 1000000"), all);
    EXPECT_LE(extract("coarse.stl", "--error 1"), extract("fine.stl", "--error 0.01"));
    EXPECT_LE(extract("root.stl", "--level 0"), 4096u);
    EXPECT_EQ(runPagoda("extract --force " + file("in.pagoda") + " -o " + file("no.stl") +
                        " --triangles 1")
                  .exitCode,
              1);
    EXPECT_FALSE(fs::exists(file("no.stl")));
}

TEST_F(Extract, ABoxKeepsWhatTouchesItAndNothingElse) {
    (void)extract("all.stl", "");
    const tools::CollectedScene all = read("all.stl");
    const Box3d box{{2, -1, -6}, {6, 2, 0}};  // y up in a database made of a .glb
    uint64_t expected = 0;
    for (size_t t = 0; t < all.triangleCount(); ++t) {
        Box3d own;
        for (size_t i = 0; i < 3; ++i) own.extend(Vec3d(all.corners[3 * t + i]));
        expected += glm::all(glm::lessThanEqual(own.min, box.max)) &&
                            glm::all(glm::lessThanEqual(box.min, own.max))
                        ? uint64_t{1}
                        : 0;
    }
    EXPECT_GT(expected, 0u);
    EXPECT_LT(expected, all.triangleCount());
    // Corners in the .stl are floats; a triangle that just touches may fall either way.
    EXPECT_NEAR(static_cast<double>(extract("box.stl", "--box 2,-1,-6,6,2,0")),
                static_cast<double>(expected), 3.0);
}

}  // namespace
}  // namespace pagoda::tests
