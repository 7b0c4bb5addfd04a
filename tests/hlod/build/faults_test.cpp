// What may go wrong in mid-build: inputs that change, Ctrl-C, kill -9. A Progress that acts at a
// given stage makes each of them happen at the same place every time.
#include "hlod/build/build.h"
#include "ooc/base/error.h"
#include "ooc/store/verify.h"
#include "tests/hlod/build/test_meshes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>

namespace pagoda::hlod {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

// Acts when a stage begins, or at the first advance() within it.
class StagedProgress : public Progress {
public:
    std::function<void(const std::string&stage)> atStage, atAdvance;
    std::vector<std::string> stages, notes;

    void beginStage(std::string_view name, uint64_t, std::string_view) override {
        stages.emplace_back(name);
        if (atStage) atStage(stages.back());
    }
    void advance(uint64_t) override {
        if (atAdvance) atAdvance(stages.back());
    }
    void note(std::string_view line) override { notes.emplace_back(line); }
};

BuildOptions optionsFor(const fs::path& input, const fs::path& target) {
    BuildOptions options;
    options.inputs = expandInputs({input.string()});
    options.target = target;
    options.threads = 1;
    return options;
}

std::vector<std::string> namesIn(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

// The message of the Error that `work` ends with.
std::string errorOf(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

class InputThatChanges : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(InputThatChanges, BetweenTheReadingsIsRefusedByNameAndNothingIsLeft) {
    const auto [seed, name] = GetParam();
    const TemporaryFolder folder;
    const fs::path input = folder / name;
    fs::copy_file(fs::path(PAGODA_SOURCE_DIR "/tests/fuzz/corpus") / seed, input);
    ASSERT_EQ(errorOf([&] {
                  Progress silent;
                  (void)buildDatabase(optionsFor(input, folder / "whole.pagoda"), silent);
              }),
              "no error");
    fs::remove(folder / "whole.pagoda");

    for (const bool isCut : {true, false}) {
        SCOPED_TRACE(isCut ? "cut in half" : "written again, as long as before");
        StagedProgress progress;
        progress.atStage = [&](const std::string& stage) {
            if (stage != "read and snap") return;
            if (isCut) {
                fs::resize_file(input, fs::file_size(input) / 2);
            } else {
                fs::last_write_time(input, fs::last_write_time(input) + std::chrono::seconds(2));
            }
        };
        const std::string error = errorOf(
            [&] { (void)buildDatabase(optionsFor(input, folder / "out.pagoda"), progress); });
        EXPECT_THAT(error, HasSubstr(input.string()));
        EXPECT_THAT(error, HasSubstr("written while it was read"));
        EXPECT_THAT(namesIn(folder / "."), ElementsAre(name));
        fs::copy_file(fs::path(PAGODA_SOURCE_DIR "/tests/fuzz/corpus") / seed, input,
                      fs::copy_options::overwrite_existing);
    }
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, InputThatChanges,
    testing::Values(std::pair("ply/binary_little_endian", "a.ply"), std::pair("ply/ascii", "b.ply"),
                    std::pair("obj/plain", "a.obj"), std::pair("stl/binary", "a.stl"),
                    std::pair("stl/ascii", "b.stl"), std::pair("off/plain", "a.off"),
                    std::pair("gltf/binary", "a.glb"), std::pair("gltf/embedded", "a.gltf"),
                    std::pair("drc/edgebreaker", "a.drc")),
    [](const auto& test) {
        std::string name = test.param.first;
        std::replace(name.begin(), name.end(), '/', '_');
        return name;
    });

TEST(BuildFaults, CtrlCAtAnyStageEndsTheBuildAndLeavesNothing) {
    const TemporaryFolder folder;
    writePly(test::roughTorus(100, 60), folder / "torus.ply");
    StagedProgress whole;
    (void)buildDatabase(optionsFor(folder / "torus.ply", folder / "out.pagoda"), whole);
    fs::remove(folder / "out.pagoda");
    ASSERT_GE(whole.stages.size(), 4u);

    for (const std::string& last : whole.stages) {
        StagedProgress progress;
        progress.atStage = [&](const std::string& stage) {
            if (stage == last) progress.requestStop();
        };
        EXPECT_THROW(
            (void)buildDatabase(optionsFor(folder / "torus.ply", folder / "out.pagoda"), progress),
            Interrupted)
            << last;
        EXPECT_THAT(namesIn(folder / "."), ElementsAre("torus.ply")) << last;
    }
}

TEST(BuildFaults, WhatAKilledBuildLeftIsSaidAndRemovedByTheNext) {
    const TemporaryFolder folder;
    writePly(test::roughTorus(100, 60), folder / "torus.ply");
    const BuildOptions options = optionsFor(folder / "torus.ply", folder / "out.pagoda");
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {  // kill -9 while it writes
        StagedProgress progress;
        progress.atAdvance = [](const std::string& stage) {
            if (stage == "write") ::raise(SIGKILL);
        };
        (void)buildDatabase(options, progress);
        ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    const std::vector<std::string> left = namesIn(folder / ".");
    ASSERT_EQ(left.size(), 2u) << "the input and one temporary file";
    EXPECT_FALSE(fs::exists(folder / "out.pagoda"));

    StagedProgress progress;
    (void)buildDatabase(options, progress);
    ASSERT_EQ(progress.notes.size(), 1u);
    EXPECT_THAT(progress.notes[0], HasSubstr(left[0]));
    EXPECT_THAT(namesIn(folder / "."), ElementsAre("out.pagoda", "torus.ply"));
}

TEST(BuildFaults, AnInputWithoutUsableTrianglesIsRefusedWithWhatWasInIt) {
    const TemporaryFolder folder;
    const auto refusal = [&](const test::Mesh& mesh) {
        writePly(mesh, folder / "bad.ply");
        return errorOf([&] {
            Progress silent;
            (void)buildDatabase(optionsFor(folder / "bad.ply", folder / "bad.pagoda"), silent);
        });
    };
    const std::string path = (folder / "bad.ply").string();
    EXPECT_THAT(refusal({{{0, 0, 0}}, {}}), HasSubstr(path + ": no triangles"));
    EXPECT_THAT(refusal({{{0, 0, 0}}, {{0, 1, 2}, {0, 5, 6}}}),
                HasSubstr("no triangle of 2 can be used: 2 index out of range"));
    EXPECT_THAT(refusal({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {NAN, 0, 0}}, {{0, 1, 2}, {0, 1, 3}}}),
                HasSubstr("no triangle of 2 can be used: 1 degenerate, 1 non-finite"));
    EXPECT_FALSE(fs::exists(folder / "bad.pagoda"));
}

TEST(BuildFaults, CoordinatesThatNoLatticeCanHoldNameTheFileAndWhereTheDetailIs) {
    const TemporaryFolder folder;
    test::Mesh mesh = test::roughTorus(200, 100);
    mesh.positions.emplace_back(1e12, 0, 0);
    mesh.triangles.push_back({0, 1, static_cast<uint32_t>(mesh.positions.size() - 1)});
    writePly(mesh, folder / "stray.ply");
    const auto refusal = [&] {
        return errorOf([&] {
            Progress silent;
            (void)buildDatabase(optionsFor(folder / "stray.ply", folder / "out.pagoda"), silent);
        });
    };
    EXPECT_THAT(refusal(), HasSubstr("stray.ply: 40000 of 40001 triangles"));
    EXPECT_THAT(refusal(), HasSubstr("to (1e+12 "));
    mesh.positions.back() = {1e308, -1e308, 0};
    mesh.positions[0] = {-1e308, 0, 0};
    writePly(mesh, folder / "stray.ply");
    EXPECT_THAT(refusal(), HasSubstr("stray.ply: coordinates up to 1e308"));
}

// The target is written last, but what forbids it is said first: the input here is broken too.
TEST(BuildFaults, ATargetThatCannotBeWrittenIsRefusedBeforeAnythingIsRead) {
    const TemporaryFolder folder, scratch;
    std::ofstream(folder / "broken.ply") << "not a ply";
    BuildOptions options = optionsFor(folder / "broken.ply", folder / "no" / "out.pagoda");
    options.scratchFolder = scratch / ".";
    const auto refusal = [&] {
        return errorOf([&] {
            Progress silent;
            (void)buildDatabase(options, silent);
        });
    };
    EXPECT_THAT(refusal(), HasSubstr("out.pagoda: cannot create: no folder"));
    options.target = folder / ".";
    EXPECT_THAT(refusal(), HasSubstr("is a folder"));
    options.force = true;
    EXPECT_THAT(refusal(), HasSubstr("is a folder"));
    options.target = folder / "broken.ply" / "out.pagoda";
    EXPECT_THAT(refusal(), HasSubstr("out.pagoda: cannot create"));
    EXPECT_THAT(namesIn(folder / "."), ElementsAre("broken.ply"));
}

}  // namespace
}  // namespace pagoda::hlod
