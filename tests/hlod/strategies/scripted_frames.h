// scripted_frames.h: frames of a strategy over records without pages: the test says what each box
// query answers and when, and hears in order what the strategy asked, drew, refined and hid.
#pragma once

#include "hlod/strategies/strategies.h"
#include "tests/hlod/made_tree.h"

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace pagoda::hlod::test {

struct Answer {
    static constexpr int kOnlyByWaiting = -1;
    uint64_t visiblePx = 0;
    int readyAtPoll = kOnlyByWaiting;  // 0: there at the first
};

using Answers = std::function<Answer(ooc::NodeId)>;
using Events = std::vector<std::string>;  // "query A", "wait A", "draw A", "refine A", "hide A";
                                          // "query A+B" of boxes together

inline Box3d boxModelOf(const MadeRecords& records, size_t node) {
    return records.lattice.toModel(records.nodes()[node].box);
}

// Every page is resident. Boxes of the records differ, so that a box names its node.
class ScriptedFrames final : public FrameSink, public CountingVisibility {
public:
    using NameOf = std::function<std::string(ooc::NodeId)>;
    ScriptedFrames(const MadeRecords& records, NameOf nameOf)
        : tree_(records), nameOf_(std::move(nameOf)) {
        for (size_t node = 0; node < records.nodes().size(); ++node) {
            byBox_[keyOf(boxModelOf(records, node))] = records.nodes()[node].id;
        }
    }

    FrameRecord run(Strategy& strategy, const View& view, double tauPx, Answers answers,
                    const std::function<void(FrameContext&)>& change = {}) {
        answers_ = std::move(answers);
        asked_.clear();
        events_.clear();
        tree_.beginFrame();
        FrameRecord record;
        FrameContext frame{view, tree_.tree(), tauPx, tree_.frameIndex(), *this, record};
        if (change) change(frame);
        strategy.traverse(frame);
        return record;
    }
    [[nodiscard]] const Events& events() const { return events_; }

    cache::PageState state(const Node&) const override { return cache::PageState::Resident; }
    cache::PageState want(const Node&, double, Use) override { return cache::PageState::Resident; }
    void keep(const Node&) override {}
    void refine(const Node& node) override { note("refine", node.record->id); }
    void draw(const Node& node, Use use) override {
        note(use == Use::Cut ? "draw" : "stand in", node.record->id);
    }
    void hide(const Node& node) override { note("hide", node.record->id); }
    CountingVisibility* counting() override { return this; }
    PyramidVisibility* pyramid() override { return depths; }
    PyramidVisibility* depths = nullptr;

    QueryTicket query(const QueryShape& shape) override {
        Asked asked;
        if (const auto* const together = std::get_if<std::vector<Box3d>>(&shape)) {
            for (const Box3d& box : *together) asked.nodes.push_back(byBox_.at(keyOf(box)));
        } else {
            asked.nodes.push_back(byBox_.at(keyOf(std::get<Box3d>(shape))));
        }
        note("query", asked.nodes);
        asked_.push_back(std::move(asked));
        return {asked_.size() - 1};
    }
    std::optional<uint64_t> poll(QueryTicket ticket) override {
        Asked& asked = asked_.at(ticket.value);
        const int readyAtPoll = answers_(asked.nodes.front()).readyAtPoll;
        const bool isReady = readyAtPoll != Answer::kOnlyByWaiting && asked.polls++ >= readyAtPoll;
        return isReady ? std::optional(visiblePx(asked)) : std::nullopt;
    }
    uint64_t wait(QueryTicket ticket) override {
        const Asked& asked = asked_.at(ticket.value);
        note("wait", asked.nodes);
        return visiblePx(asked);
    }
    bool isPollFree() const override { return true; }

private:
    struct Asked {
        std::vector<ooc::NodeId> nodes;
        int polls = 0;
    };
    uint64_t visiblePx(const Asked& asked) const {
        uint64_t pixels = 0;
        for (const ooc::NodeId node : asked.nodes) pixels += answers_(node).visiblePx;
        return pixels;
    }
    using BoxKey = std::array<double, 6>;
    static BoxKey keyOf(const Box3d& box) {
        return {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z};
    }
    void note(const char* what, ooc::NodeId node) { note(what, std::vector{node}); }
    void note(const char* what, const std::vector<ooc::NodeId>& nodes) {
        std::string names;
        for (const ooc::NodeId node : nodes) {
            if (!names.empty()) names += '+';
            names += nameOf_(node);
        }
        events_.push_back(std::string(what) + ' ' + names);
    }

    MadeTree tree_;
    NameOf nameOf_;
    std::map<BoxKey, ooc::NodeId> byBox_;
    Answers answers_;
    std::vector<Asked> asked_;
    Events events_;
};

}  // namespace pagoda::hlod::test
