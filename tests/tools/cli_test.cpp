// The program as a script sees it: exit codes, streams and the one line an error gets.
#include "tests/tools/run_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace {

using pagoda::tests::runPagoda;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST(CommandLine, PrintsItsVersionOnStandardOutputAndSucceeds) {
    const auto run = runPagoda("--version");
    EXPECT_EQ(run.exitCode, 0);
    EXPECT_THAT(run.out, StartsWith("pagoda "));
    EXPECT_THAT(run.err, IsEmpty());
}

TEST(CommandLine, HelpNamesTheCommandsAndTheExitCodes) {
    const auto run = runPagoda("--help");
    EXPECT_EQ(run.exitCode, 0);
    for (const char* command : {"build", "info", "verify", "extract", "generate"}) {
        EXPECT_THAT(run.out, HasSubstr(std::string("\n  ") + command + " ")) << command;
    }
    EXPECT_THAT(run.out, HasSubstr("130 interrupted"));
}

TEST(CommandLine, EveryCommandHasHelpWithAnExample) {
    for (const char* command : {"build", "info", "verify", "extract", "generate"}) {
        const auto run = runPagoda(std::string(command) + " --help");
        EXPECT_EQ(run.exitCode, 0) << command;
        EXPECT_THAT(run.out, HasSubstr(std::string("pagoda ") + command)) << command;
    }
}

TEST(CommandLine, WrongUsageIsOneLineOnStandardErrorAndExitCode2) {
    for (const char* arguments :
         {"", "nosuchcommand", "--nosuchoption", "info", "build --memory x"}) {
        const auto run = runPagoda(arguments);
        EXPECT_EQ(run.exitCode, 2) << arguments;
        EXPECT_THAT(run.out, IsEmpty()) << arguments;
        EXPECT_THAT(run.err, StartsWith("pagoda: ")) << arguments;
        EXPECT_THAT(run.err, HasSubstr("--help")) << arguments;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    }
}

TEST(CommandLine, AMissingFileIsOneLineWithItsNameAndExitCode1) {
    for (const char* command : {"info", "verify"}) {
        const auto run = runPagoda(std::string(command) + " nosuchfile.pagoda");
        EXPECT_EQ(run.exitCode, 1) << command;
        EXPECT_THAT(run.out, IsEmpty()) << command;
        EXPECT_THAT(run.err, StartsWith("pagoda: nosuchfile.pagoda:")) << command;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    }
}

TEST(CommandLine, ResultsThatCannotBePrintedAreAFailure) {
    const auto run = runPagoda("--version > /dev/full");
    EXPECT_EQ(run.exitCode, 1);
    EXPECT_THAT(run.err, HasSubstr("standard output"));
}

TEST(CommandLine, QuietMayStandBeforeOrBehindTheCommand) {
    EXPECT_EQ(runPagoda("--quiet info nosuchfile.pagoda").exitCode, 1);
    EXPECT_EQ(runPagoda("info nosuchfile.pagoda --quiet").exitCode, 1);
}

// The shell waits until the program has begun to write; the model would take minutes.
TEST(CommandLine, CtrlCEndsWith130AndLeavesNothingBehind) {
    const std::string folder = testing::TempDir() + "pagoda-interrupted";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    const auto run =
        runPagoda("generate torus --triangles 2000000000 -o " + folder +
                  "/t.ply & program=$!; until [ -n \"$(ls -A " + folder +
                  ")\" ]; do kill -0 $program || break; done; kill -INT $program; wait $program");
    EXPECT_EQ(run.exitCode, 130);
    EXPECT_THAT(run.err, HasSubstr("pagoda: interrupted\n"));
    EXPECT_TRUE(std::filesystem::is_empty(folder));
    std::filesystem::remove_all(folder);
}

}  // namespace
