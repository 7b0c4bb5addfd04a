// What `auto` chooses when each candidate's frames cost what the test says.
#include "tests/hlod/strategies/scripted_frames.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace pagoda::hlod {
namespace {

using test::Answer;
using test::MadeRecords;

// Sees all boxes.
class OpenDepths final : public PyramidVisibility {
public:
    void build() override {}
    void visiblePixels(std::span<const Box3d>, std::span<uint64_t> pixels) override {
        std::fill(pixels.begin(), pixels.end(), uint64_t{100});
    }
};

// A root over four leaves, with an error that has it refined.
class AutoTest : public testing::Test {
protected:
    AutoTest() : records_({.extentBits = 12}, {{0, 0, 0}, {4000, 1000, 4000}}, 1000.0) {
        for (uint32_t i = 0; i < 4; ++i) {
            const auto x = static_cast<int32_t>(1000 * i);
            records_.add(0, i, {{x, 0, 0}, {x + 900, 1000, 900}}, 0.0);
        }
        records_.finish();
        frames_.emplace(records_, [](ooc::NodeId) { return std::string("node"); });
        frames_->depths = &depths_;
    }

    static View view() {
        Camera camera{.eye = {2000, 500, -5000}, .target = {2000, 500, 0}, .fovyDegrees = 60};
        camera.widthPx = 640;
        camera.heightPx = 480;
        camera.nearModelUnits = 1.0;
        return {camera, {}};
    }

    // One frame; the name of who ran it. It costs what `costMs` says of that one.
    std::string frame(const std::map<std::string, double>& costMs, bool isSameView = false) {
        before_ = last_;
        last_ = frames_->run(
            *strategy_, view(), 1.0,
            [](ooc::NodeId) {
                return Answer{100, 0};
            },
            [&](FrameContext& context) {
                context.lastCostMs = lastCostMs_;
                context.isSameView = isSameView;
                if (hasLast_) context.lastRecord = &before_;
            });
        hasLast_ = true;
        last_.drawnTriangles = 400;
        std::string name = last_.choice.substr(0, last_.choice.find(':'));
        lastCostMs_ = costMs.at(name);
        return name;
    }
    std::map<std::string, int> run(int frames, const std::map<std::string, double>& costMs) {
        std::map<std::string, int> times;
        for (int i = 0; i < frames; ++i) ++times[frame(costMs)];
        return times;
    }

    MadeRecords records_;
    OpenDepths depths_;
    std::optional<test::ScriptedFrames> frames_;
    std::unique_ptr<Strategy> strategy_ = makeStrategy("auto");
    FrameRecord last_, before_;
    bool hasLast_ = false;
    double lastCostMs_ = 0;
};

TEST_F(AutoTest, TriesQueriesAndPyramidInTurnsAndKeepsTheCheaper) {
    for (const char* cheaper : {"coh", "hzb"}) {
        strategy_ = makeStrategy("auto");
        hasLast_ = false;
        std::map<std::string, double> costs = {{"coh", 10}, {"hzb", 10}, {"frustum", 1000}};
        costs[cheaper] = 8;
        std::vector<std::string> names;
        names.reserve(8);
        for (int i = 0; i < 8; ++i) names.push_back(frame(costs));
        EXPECT_EQ(std::count(names.begin(), names.end(), "coh"), 4);
        EXPECT_EQ(std::count(names.begin(), names.end(), "hzb"), 4);
        for (size_t i = 1; i < names.size(); ++i) EXPECT_NE(names[i], names[i - 1]);
        run(4, costs);  // frustum may be looked at
        EXPECT_EQ(run(40, costs)[cheaper], 40);
    }
}

TEST_F(AutoTest, LeavesQueriesOutWhereNothingIsHidden) {
    const auto times = run(60, {{"coh", 10}, {"hzb", 11}, {"frustum", 8}});
    EXPECT_EQ(times.at("frustum"), 60 - 8);
    EXPECT_NE(last_.choice.find("8.0 ms"), std::string::npos) << last_.choice;
}

TEST_F(AutoTest, LooksAgainAndChangesItsMind) {
    EXPECT_EQ(run(60, {{"coh", 10}, {"hzb", 20}, {"frustum", 30}}).count("frustum"), 1u);
    const auto later = run(300, {{"coh", 20}, {"hzb", 10}, {"frustum", 30}});
    EXPECT_GT(later.at("hzb"), 200);
    EXPECT_EQ(frame({{"coh", 20}, {"hzb", 10}, {"frustum", 30}}), "hzb");
}

TEST_F(AutoTest, AStillViewKeepsWhatDrewIt) {
    const std::map<std::string, double> costs = {{"coh", 10}, {"hzb", 5}, {"frustum", 7}};
    for (int i = 0; i < 20; ++i) {
        const std::string name = frame(costs);
        for (int still = 0; still < 5; ++still) EXPECT_EQ(frame(costs, true), name) << i;
    }
    EXPECT_EQ(frame(costs), "hzb");
}

TEST_F(AutoTest, WithoutAPyramidItIsNotTried) {
    frames_->depths = nullptr;
    const auto times = run(30, {{"coh", 10}, {"hzb", 1}, {"frustum", 1000}});
    EXPECT_EQ(times.count("hzb"), 0u);
    EXPECT_GE(times.at("coh"), 26);
}

}  // namespace
}  // namespace pagoda::hlod
