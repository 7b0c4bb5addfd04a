// seven_nodes.h: a tree of seven nodes whose errors and shares are chosen, and frames of a strategy
// over it, to be compared with sequences that were derived by hand.
#pragma once

#include "hlod/view/screen_box.h"
#include "tests/hlod/strategies/scripted_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pagoda::hlod::test {

// Errors in pixels from where the eye is: R 8, A 4, B 4; the others are leaves. From near to far:
// R, A, A1, A2, B, B1, B2. A lies to the left, B to the right.
class SevenNodes : public testing::Test {
protected:
    SevenNodes() : records_({.extentBits = 12}, {{0, 0, 0}, {4000, 1000, 2000}}, 0.0) {
        const View view = lookingAhead();
        add("A", 0, 0, {{0, 0, 0}, {1000, 1000, 1000}}, 4.0, view);
        add("B", 0, 1, {{3000, 0, 1000}, {4000, 1000, 2000}}, 4.0, view);
        add("A1", 1, 0, {{0, 0, 0}, {400, 1000, 400}}, 0.0, view);
        add("A2", 1, 1, {{600, 0, 500}, {1000, 1000, 1000}}, 0.0, view);
        add("B1", 2, 0, {{3000, 0, 1000}, {3400, 1000, 1400}}, 0.0, view);
        add("B2", 2, 1, {{3600, 0, 1600}, {4000, 1000, 2000}}, 0.0, view);
        records_.setError(0, errorOf(8.0, 0, view));
        records_.finish();
        frames_.emplace(records_, [this](ooc::NodeId id) {
            for (size_t i = 0; i < records_.nodes().size(); ++i) {
                if (records_.nodes()[i].id == id) return names_[i];
            }
            return std::string("?");
        });
        strategy_ = makeStrategy("coh", kPaperOptions);
    }

    // The eye stays where it is, and with it every distance and error.
    static View lookingTo(double targetX) {
        Camera camera{.eye = {2000, 500, -3000}, .target = {targetX, 500, 0}, .fovyDegrees = 60};
        camera.widthPx = 640;
        camera.heightPx = 480;
        camera.nearModelUnits = 1.0;
        return {camera, {}};
    }
    static View lookingAhead() { return lookingTo(2000); }
    static View withoutB() { return lookingTo(-100); }

    struct Seen {
        double share = 0;
        int readyAtPoll = Answer::kOnlyByWaiting;
    };
    // What is not in `seen` must not be asked about.
    const Events& frame(const View& view, double tauPx, std::map<std::string, Seen> seen,
                        bool isSameView = false) {
        const auto answers = [&](ooc::NodeId id) {
            const auto& nodes = records_.nodes();
            const auto at = std::find_if(nodes.begin(), nodes.end(),
                                         [&](const auto& node) { return node.id == id; });
            const auto i = static_cast<size_t>(at - nodes.begin());
            const Seen answer = seen.at(names_[i]);
            const double pixels = answer.share * boxPixels(view, boxModelOf(records_, i));
            return Answer{static_cast<uint64_t>(std::lround(pixels)), answer.readyAtPoll};
        };
        record_ = frames_->run(*strategy_, view, tauPx, answers,
                               [&](FrameContext& frame) { frame.isSameView = isSameView; });
        return frames_->events();
    }
    const Events& frame(double tauPx, std::map<std::string, Seen> seen) {
        return frame(lookingAhead(), tauPx, std::move(seen));
    }

    FrameRecord record_;
    std::unique_ptr<Strategy> strategy_;

private:
    double errorOf(double ssePx, size_t node, const View& view) const {
        return ssePx / view.ssePx(1.0, boxModelOf(records_, node));
    }
    void add(const char* name, size_t parent, uint32_t octant, const Box3i& box, double ssePx,
             const View& view) {
        const size_t node = records_.add(parent, octant, box, 0.0);
        records_.setError(node, errorOf(ssePx, node, view));
        names_.emplace_back(name);
    }

    MadeRecords records_;
    std::vector<std::string> names_ = {"R"};
    std::optional<test::ScriptedFrames> frames_;
};

}  // namespace pagoda::hlod::test
