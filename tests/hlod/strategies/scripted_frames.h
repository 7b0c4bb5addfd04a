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
using Events = std::vector<std::string>;  // "query A", "wait A", "draw A", "refine A", "hide A"

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

    FrameRecord run(Strategy& strategy, const View& view, double tauPx, Answers answers) {
        answers_ = std::move(answers);
        asked_.clear();
        events_.clear();
        tree_.beginFrame();
        FrameRecord record;
        FrameContext frame{view, tree_.tree(), tauPx, tree_.frameIndex(), *this, record};
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
    PyramidVisibility* pyramid() override { return nullptr; }

    QueryTicket query(const QueryShape& shape) override {
        const ooc::NodeId node = byBox_.at(keyOf(std::get<Box3d>(shape)));
        note("query", node);
        asked_.push_back({node, 0});
        return {asked_.size() - 1};
    }
    std::optional<uint64_t> poll(QueryTicket ticket) override {
        Asked& asked = asked_.at(ticket.value);
        const Answer answer = answers_(asked.node);
        const bool isReady =
            answer.readyAtPoll != Answer::kOnlyByWaiting && asked.polls++ >= answer.readyAtPoll;
        return isReady ? std::optional(answer.visiblePx) : std::nullopt;
    }
    uint64_t wait(QueryTicket ticket) override {
        const ooc::NodeId node = asked_.at(ticket.value).node;
        note("wait", node);
        return answers_(node).visiblePx;
    }
    bool isPollFree() const override { return true; }

private:
    struct Asked {
        ooc::NodeId node;
        int polls;
    };
    using BoxKey = std::array<double, 6>;
    static BoxKey keyOf(const Box3d& box) {
        return {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z};
    }
    void note(const char* what, ooc::NodeId node) {
        events_.push_back(std::string(what) + ' ' + nameOf_(node));
    }

    MadeTree tree_;
    NameOf nameOf_;
    std::map<BoxKey, ooc::NodeId> byBox_;
    Answers answers_;
    std::vector<Asked> asked_;
    Events events_;
};

}  // namespace pagoda::hlod::test
