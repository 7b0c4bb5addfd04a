#include "tools/console_progress.h"
#include "tools/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <sstream>

namespace pagoda::tools {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Console {
    explicit Console(ProgressStyle style) : progress(text, style, [this] { return seconds; }) {}
    double seconds = 0;
    std::ostringstream text;
    ConsoleProgress progress;
};

TEST(ConsoleProgress, LinesSayWhatAStageDidWhenItEnds) {
    Console console(ProgressStyle::Lines);
    console.progress.beginStage("read", 4'000'000, "bytes");
    console.progress.advance(4'000'000);
    console.seconds = 2;
    console.progress.finish();
    EXPECT_EQ(console.text.str(), "read: 4.0 MB in 2.0 s, 2.0 MB/s\n");
}

TEST(ConsoleProgress, LinesComeEveryTenSecondsOfALongStage) {
    Console console(ProgressStyle::Lines);
    console.progress.beginStage("merge", 100, "nodes");
    for (int i = 1; i <= 50; ++i) {
        console.seconds = i;
        console.progress.advance(1);
    }
    const std::string text = console.text.str();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5) << text;
    EXPECT_THAT(text, HasSubstr("50 nodes of 100 nodes, 1 nodes/s, 50.0 s left\n"));
}

TEST(ConsoleProgress, LinesHoldNoControlCharacters) {
    Console console(ProgressStyle::Lines);
    console.progress.beginStage("read", 10, "bytes");
    console.progress.note("one stray vertex");
    console.seconds = 11;
    console.progress.advance(10);
    console.progress.warn("file cut short");
    console.progress.finish();
    const std::string text = console.text.str();
    EXPECT_THAT(text, Not(HasSubstr("\r")));
    EXPECT_THAT(text, Not(HasSubstr("\x1b")));
    EXPECT_THAT(text, HasSubstr("one stray vertex\n"));
    EXPECT_THAT(text, HasSubstr("warning: file cut short\n"));
}

TEST(ConsoleProgress, ABarIsDrawnAtMostTenTimesASecondAndErasedAtTheEnd) {
    Console console(ProgressStyle::Bar);
    console.progress.beginStage("read", 1000, "bytes");
    for (int i = 1; i <= 1000; ++i) {
        console.seconds = i / 1000.0;
        console.progress.advance(1);
    }
    const std::string bars = console.text.str();
    EXPECT_LE(std::count(bars.begin(), bars.end(), '\r'), 11);
    EXPECT_GE(std::count(bars.begin(), bars.end(), '\r'), 9);
    console.progress.finish();
    EXPECT_THAT(console.text.str(), EndsWith("\r\x1b[Kread: 1.0 kB in 1.0 s, 1.0 kB/s\n"));
}

TEST(ConsoleProgress, ANoteStandsAboveTheBar) {
    Console console(ProgressStyle::Bar);
    console.progress.beginStage("read", 1000, "bytes");
    console.text.str("");
    console.progress.note("step refined");
    EXPECT_THAT(console.text.str(), testing::StartsWith("\r\x1b[Kstep refined\n\rread "));
}

TEST(ConsoleProgress, AnUnfinishedStageLeavesNoBarAndClaimsNothing) {
    std::ostringstream text;
    {
        ConsoleProgress progress(text, ProgressStyle::Bar, [] { return 0.0; });
        progress.beginStage("read", 1000, "bytes");
    }
    EXPECT_THAT(text.str(), EndsWith("\r\x1b[K"));
    EXPECT_THAT(text.str(), Not(HasSubstr("read:")));
}

TEST(ConsoleProgress, QuietSaysNothing) {
    Console console(ProgressStyle::Silent);
    console.progress.beginStage("read", 10, "bytes");
    console.progress.advance(10);
    console.progress.note("note");
    console.progress.warn("warning");
    console.progress.finish();
    EXPECT_THAT(console.text.str(), IsEmpty());
}

TEST(Formats, DurationsBytesAndCountsReadWell) {
    EXPECT_EQ(formatDuration(3.14), "3.1 s");
    EXPECT_EQ(formatDuration(59.97), "1 min 0 s");
    EXPECT_EQ(formatDuration(75.2), "1 min 15 s");
    EXPECT_EQ(formatDuration(7384), "2 h 3 min");
    EXPECT_EQ(formatBytes(0), "0 B");
    EXPECT_EQ(formatBytes(999), "999 B");
    EXPECT_EQ(formatBytes(999'960), "1.0 MB");
    EXPECT_EQ(formatBytes(1'234'567), "1.2 MB");
    EXPECT_EQ(formatBytes(UINT64_MAX), "18.4 EB");
    EXPECT_EQ(formatCount(0), "0");
    EXPECT_EQ(formatCount(999), "999");
    EXPECT_EQ(formatCount(1'234'567), "1,234,567");
}

TEST(Formats, SizesAreReadWithTheirUnits) {
    EXPECT_EQ(parseBytes("1048576"), 1'048'576u);
    EXPECT_EQ(parseBytes("512MiB"), uint64_t{512} << 20);
    EXPECT_EQ(parseBytes("4GB"), 4'000'000'000u);
    for (const char* wrong : {"", "MiB", "-1", "1.5GB", "4 GB", "4gb!", "99999999999TiB"}) {
        EXPECT_THROW((void)parseBytes(wrong), CLI::ValidationError) << wrong;
    }
}

}  // namespace
}  // namespace pagoda::tools
