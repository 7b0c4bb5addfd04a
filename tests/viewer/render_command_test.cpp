// `pagoda render` as a script sees it: files, exit codes, faults.
#include "hlod/build/build.h"
#include "ooc/base/file.h"
#include "ooc/store/database.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace pagoda::viewer {
namespace {

struct Outcome {
    int exitCode = -1;
    std::string out, err;
};

std::string contentOf(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

class RenderCommandTest : public ::testing::Test {
protected:
    RenderCommandTest() {
        std::filesystem::create_directories(folder_);
        writeBumps();
        hlod::BuildOptions options;
        options.inputs = hlod::expandInputs({(folder_ / "bumps.obj").string()});
        options.target = database_;
        options.nodeTriangles = 256;
        Progress quiet;
        static_cast<void>(hlod::buildDatabase(options, quiet));
    }
    ~RenderCommandTest() override { std::filesystem::remove_all(folder_); }

    // A hilly field of 2 * 60 * 60 triangles.
    void writeBumps() {
        std::ofstream obj(folder_ / "bumps.obj");
        constexpr int kSide = 61;
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                obj << "v " << x << ' ' << y << ' ' << 3 * std::sin(0.2 * x) * std::cos(0.3 * y)
                    << '\n';
            }
        }
        for (int y = 1; y < kSide; ++y) {
            for (int x = 1; x < kSide; ++x) {
                const int a = (y - 1) * kSide + x;
                obj << "f " << a << ' ' << a + 1 << ' ' << a + kSide + 1 << ' ' << a + kSide
                    << '\n';
            }
        }
    }
    Outcome run(const std::string& arguments) {
        const std::string out = folder_ / "out", err = folder_ / "err";
        const std::string command = std::string(PAGODA_BINARY) + " render " + database_.string() +
                                    ' ' + arguments + " >" + out + " 2>" + err;
        Outcome result;
        const int status = std::system(command.c_str());
        result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        result.out = contentOf(out);
        result.err = contentOf(err);
        return result;
    }
    void flipBit(uint64_t offset) {
        std::fstream file(database_, std::ios::in | std::ios::out | std::ios::binary);
        file.seekg(static_cast<std::streamoff>(offset));
        const char byte = static_cast<char>(file.get() ^ 16);
        file.seekp(static_cast<std::streamoff>(offset));
        file.put(byte);
    }

    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() /
        ("pagoda_render_" +
         std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::path database_ = folder_ / "bumps.pagoda";
};

TEST_F(RenderCommandTest, WritesPictureDepthIdsAndStats) {
    const std::string f = folder_;
    const Outcome result = run("-o " + f + "/a.png --size 200x100 --tau 0 --stats --depth " + f +
                               "/a.pfm --ids " + f + "/a.ids");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto stats = nlohmann::json::parse(result.out);
    for (const char* key :
         {"drawn_nodes", "drawn_triangles", "queries", "covered_pixels", "tau", "effective_tau"}) {
        EXPECT_TRUE(stats.contains(key)) << key;
    }
    EXPECT_EQ(stats["drawn_triangles"], 7200);
    EXPECT_GT(stats["covered_pixels"], 2000);
    EXPECT_EQ(contentOf(folder_ / "a.png").substr(1, 3), "PNG");
    EXPECT_EQ(contentOf(folder_ / "a.pfm").size(),
              std::string("Pf\n200 100\n-1.0\n").size() + 80000);
    EXPECT_EQ(contentOf(folder_ / "a.ids").size(), 160000u);
    EXPECT_TRUE(nlohmann::json::parse(contentOf(folder_ / "a.ids.json")).contains("nodes"));
}

TEST_F(RenderCommandTest, ReferenceDetailFullAndTauZeroAreOnePicture) {
    const std::string f = folder_;
    ASSERT_EQ(run("-o " + f + "/a.png --tau 0").exitCode, 0);
    ASSERT_EQ(run("-o " + f + "/b.png --reference --gpu-budget 1MiB --host-budget 0").exitCode, 0);
    ASSERT_EQ(run("-o " + f + "/c.png --detail full").exitCode, 0);
    EXPECT_TRUE(contentOf(folder_ / "a.png") == contentOf(folder_ / "b.png"));
    EXPECT_TRUE(contentOf(folder_ / "a.png") == contentOf(folder_ / "c.png"));
}

TEST_F(RenderCommandTest, APageWithAFlippedBitCostsDetailIsListedAndExitsWithOne) {
    const ooc::Database database = ooc::Database::open(database_);
    std::vector<ooc::NodeRecord> leaves;
    for (uint32_t block = 0; block < database.blockCount(); ++block) {
        const auto loaded = database.readBlock(block);
        ASSERT_TRUE(loaded.value);
        for (const ooc::NodeRecord& node : loaded.value->nodes) {
            if (node.isLeaf()) leaves.push_back(node);
        }
    }
    flipBit(leaves.front().pageOffset + leaves.front().pageBytes / 2);
    const Outcome result = run("-o " + folder_.string() + "/a.png --tau 0 --stats");
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_NE(result.err.find("page of node"), std::string::npos) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out)["stand_ins"], 1);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a.png"));
}

TEST_F(RenderCommandTest, ABrokenRootBlockIsRefusedAndWritesNothing) {
    const ooc::Database database = ooc::Database::open(database_);
    flipBit(database.indexRanges().front().offset + 20);
    const Outcome result = run("-o " + folder_.string() + "/a.png");
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_NE(result.err.find("index block 0"), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png"));
}

TEST_F(RenderCommandTest, TakesACameraFromTheLineOrAFile) {
    const std::string f = folder_;
    const std::string camera =
        R"({"eye":[30,-40,50],"target":[30,30,0],"up":[0,0,1],"fovy":50,"width":90,"height":60})";
    std::ofstream(folder_ / "camera.json") << camera;
    ASSERT_EQ(run("-o " + f + "/a.png --camera '" + camera + "'").exitCode, 0);
    ASSERT_EQ(run("-o " + f + "/b.png --camera " + f + "/camera.json").exitCode, 0);
    EXPECT_TRUE(contentOf(folder_ / "a.png") == contentOf(folder_ / "b.png"));
}

TEST_F(RenderCommandTest, ThePyramidsPlaceAndWhatIsPushedChangeNoByteOfTheFullModelsPicture) {
    const std::string f = folder_, common = " --strategy hzb --tau 0 --size 200x100";
    ASSERT_EQ(run("-o " + f + "/a.png --pyramid cpu" + common).exitCode, 0);
    ASSERT_EQ(run("-o " + f + "/b.png --pyramid gpu --push-occluders on" + common).exitCode, 0);
    EXPECT_TRUE(contentOf(folder_ / "a.png") == contentOf(folder_ / "b.png"));
}

TEST_F(RenderCommandTest, RefusesWhatMakesNoSense) {
    const std::string o = "-o " + folder_.string() + "/a.png ";
    for (const char* wrong :
         {"--size 0x5", "--size big", "--strategy none", "--background blue", "--tau -1", "--fov 0",
          "--pyramid disk", "--strategy coh --push-occluders on",
          "--strategy auto --push-occluders on"}) {
        EXPECT_EQ(run(o + wrong).exitCode, 2) << wrong;
    }
    const std::string refusal = run(o + "--strategy bool --push-occluders on").err;
    EXPECT_NE(refusal.find("strategy bool has no depth pyramid"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("--strategy hzb or late"), std::string::npos) << refusal;
    for (const char* wrong :
         {"--view above", "--camera '{\"eye\":1}'", "--camera missing.json", "--size 99999x9"}) {
        EXPECT_EQ(run(o + wrong).exitCode, 1) << wrong;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png"));
}

}  // namespace
}  // namespace pagoda::viewer
