// Ratios, figures and the page, from runs made by hand.
#include "tools/bench/gnuplot.h"
#include "tools/bench/plot_legend.h"
#include "tools/bench/plot_scripts.h"
#include "tools/bench/ratios.h"
#include "tools/bench/report_html.h"
#include "tools/bench/truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>

namespace pagoda::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

BenchRun run(const std::string& strategy, std::vector<double> cpuMs, double tauPx = 1) {
    BenchRun made;
    made.strategy = strategy;
    made.pathName = "walk";
    made.tauPx = tauPx;
    made.widthPx = 640;
    made.heightPx = 480;
    made.frames = cpuMs.size();
    made.repeats = 1;
    made.truthFrames = cpuMs.size();
    made.psnrLuma = made.psnrCb = made.psnrCr = kEqualDb;
    made.cpuMs = spreadOf(cpuMs);
    made.drawnNodesSeries = cpuMs;
    made.frameMsSeries = made.cpuMsSeries = std::move(cpuMs);
    made.bytesRead = made.pageBytesRead = 300;
    made.bytesExact = 200;
    return made;
}

RunGroup pointersTo(const std::vector<BenchRun>& runs) {
    RunGroup group;
    for (const BenchRun& one : runs) group.push_back(&one);
    return group;
}

class WithoutPrograms {
public:
    WithoutPrograms() : path_(std::getenv("PATH")) { setenv("PATH", "/nowhere", 1); }
    ~WithoutPrograms() { setenv("PATH", path_.c_str(), 1); }

private:
    std::string path_;
};

TEST(Ratios, AreOfEveryRunOverEveryOtherOneOfItsConfiguration) {
    const std::vector<BenchRun> runs = {run("bool", {4, 4}), run("coh", {2, 2}),
                                        run("bool", {9, 9}, 2)};
    const std::vector<CpuRatio> ratios = cpuRatios(runs);
    ASSERT_EQ(ratios.size(), 2u);
    EXPECT_EQ(ratios[0].numerator, 0u);
    EXPECT_EQ(ratios[0].denominator, 1u);
    EXPECT_DOUBLE_EQ(ratios[0].ratio.value, 2);
    EXPECT_DOUBLE_EQ(ratios[1].ratio.value, 0.5);
}

TEST(Ratios, TheHardestFramesAreTheTenthThatCostsFrustumMost) {
    std::vector<double> frustum(40, 10.0), coh(40, 5.0);  // two passes of 20 frames
    frustum[3] = frustum[23] = 100;
    frustum[17] = frustum[37] = 80;
    coh[3] = coh[23] = 10;
    std::vector<BenchRun> runs = {run("frustum", frustum), run("coh", coh)};
    for (BenchRun& one : runs) one.frames = 20;
    for (const CpuRatio& ratio : cpuRatios(runs)) {
        if (!ratio.isHardest) continue;
        EXPECT_EQ(ratio.numerator, 0u);
        EXPECT_EQ(ratio.ratio.pairs, 4u);
        EXPECT_DOUBLE_EQ(ratio.ratio.value, 360.0 / 30.0);
        return;
    }
    FAIL() << "no ratio of the hardest frames";
}

TEST(Report, EscapesWhatHtmlWouldRead) {
    EXPECT_EQ(escapedHtml("<a href=\"x\">&'\x01"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39; ");
}

TEST(Report, NamesFromOutsideStayText) {
    BenchPlan plan;
    plan.database = "folder/<script>alert(1)</script>.pagoda";
    plan.command = "pagoda bench '<b>.pagoda'";
    std::vector<BenchRun> runs = {run("bool", {1, 2})};
    runs[0].pathName = "<img src=x>";
    runs[0].faults = {"<i>broken</i>"};
    const std::string html = benchToHtml(plan, runs, "<device>", {});
    for (const char* tag : {"<script", "<b>", "<img", "<i>", "<device>"}) {
        EXPECT_THAT(html, Not(HasSubstr(tag)));
    }
    EXPECT_THAT(html, HasSubstr("&lt;img src=x&gt;"));
    EXPECT_THAT(html, HasSubstr("&lt;i&gt;broken&lt;/i&gt;"));
}

TEST(Report, EqualPicturesAreCalledEqualAndUncomparedOnesNothing) {
    std::vector<BenchRun> runs = {run("bool", {1, 2}), run("coh", {1, 2})};
    EXPECT_THAT(benchToHtml({}, runs, "", {}), HasSubstr("<td>equal</td>"));
    for (BenchRun& one : runs) one.truthFrames = 0;
    EXPECT_THAT(benchToHtml({}, runs, "", {}), Not(HasSubstr("<td>equal</td>")));
}

TEST(Report, SaysHowToGetTheFiguresThatAreMissing) {
    const WithoutPrograms none;
    const Figures figures = drawFigures({run("bool", {1, 2}), run("coh", {1, 2})});
    EXPECT_TRUE(figures.figures.empty());
    EXPECT_THAT(figures.problem, HasSubstr("install gnuplot-nox"));
    EXPECT_THAT(benchToHtml({}, {}, "", figures), HasSubstr("install gnuplot-nox"));
}

TEST(Gnuplot, QuotedTextIsNotInterpreted) {
    EXPECT_EQ(gnuplotQuoted("it's `date`\n"), "'it''s `date` '");
}

TEST(Gnuplot, DrawsWhatStandsInsideAPageAndSaysWhatItDidNotUnderstand) {
    Gnuplot gnuplot;
    const std::string svg = gnuplot.svg("plot x title 'slope'\n", {320, 200}, "f7");
    if (gnuplot.problem().find("install gnuplot-nox") != std::string::npos && svg.empty()) {
        GTEST_SKIP() << "SKIPPED: " << gnuplot.problem();
    }
    EXPECT_EQ(svg.rfind("<svg", 0), 0u);
    EXPECT_THAT(svg, HasSubstr("slope"));
    EXPECT_FALSE(std::regex_search(svg, std::regex("id=['\"]gp"))) << "ids of two drawings clash";
    EXPECT_EQ(gnuplot.svg("plot (\n", {320, 200}, "f8"), "");
    EXPECT_THAT(gnuplot.problem(), HasSubstr("line"));
    EXPECT_EQ(gnuplot.svg("plot x\n", {320, 200}, "f9"), "") << "a problem stays";
}

TEST(PlotScripts, EqualPicturesHaveAPlaceAboveAllDecibels) {
    std::vector<BenchRun> runs = {run("bool", {1}), run("coh", {1}), run("sw", {1})};
    runs[1].psnrLuma = 41.5;
    runs[2].psnrLuma = 37.2;
    const std::string script = errorScript(pointersTo(runs));
    std::smatch found;
    ASSERT_TRUE(std::regex_search(script, found, std::regex("'equal' ([0-9.]+)"))) << script;
    EXPECT_GT(std::stod(found[1]), 41.5);
    EXPECT_LT(std::stod(found[1]), 60);
}

TEST(PlotScripts, LongPathsAreThinnedToMeans) {
    const std::string script = linesScript({{"coh", {1, 3, 5, 7, 9}}}, 2, "ms");
    EXPECT_THAT(script, HasSubstr("0.5 2\n2.5 6\n4 9\nEOD"));
}

TEST(PlotLegend, StaysInsideTheFigure) {
    std::vector<LegendEntry> entries;
    for (const char* name :
         {"frustum", "bool", "sw", "simp", "coh", "hzb", "late", "slabs", "auto"}) {
        entries.push_back({name, "#000000", LegendEntry::Mark::Line, 1});
    }
    const std::string commands = legendCommands(entries, kFigureWidthPx);
    const std::regex place("screen ([-0-9.]+),");
    for (std::sregex_iterator i(commands.begin(), commands.end(), place), end; i != end; ++i) {
        EXPECT_GT(std::stod((*i)[1]), 0);
        EXPECT_LT(std::stod((*i)[1]), 0.95);
    }
}

}  // namespace
}  // namespace pagoda::tools
