#include "hlod/strategies/coherent.h"

#include "hlod/strategies/bias.h"
#include "hlod/view/screen_box.h"

#include <algorithm>

namespace pagoda::hlod {
namespace {

constexpr uint32_t kNoParent = UINT32_MAX;
// Hidden for so long, it will probably be hidden in the next frame too.
constexpr uint8_t kLongHiddenFrames = 4;

// The relative visibility mu.
double shareOf(uint64_t visiblePx, double outlinePx) {
    return outlinePx > 1.0 ? std::min(static_cast<double>(visiblePx) / outlinePx, 1.0) : 1.0;
}

}  // namespace

// The next frame may be of another device: what this one was asked stays unanswered.
void CoherentStrategy::forget() {
    memory_.clear();
    lateQueries_.clear();
}

void CoherentStrategy::traverse(FrameContext& frame) {
    frame_ = &frame;
    counting_ = frame.sink.counting();
    late_ = nullptr;
    if (rules_.usesPyramid && frame.sink.pyramid() != nullptr) {
        pyramidAnswers_.beginFrame(*frame.sink.pyramid(), frame.record);
        if (rules_.takesLateAnswers) late_ = counting_;
        counting_ = &pyramidAnswers_;
    }
    ++frameNumber_;
    // In a still view nothing gets coarser, whatever is learnt about it.
    mayCoarsen_ = rules_.options.isAsPublished || !frame.isSameView || frame.tauPx > lastTauPx_;
    lastTauPx_ = frame.tauPx;
    visits_.clear();
    gathered_.clear();
    askedGathered_ = 0;
    const auto root = frame.tree.root();
    if (!root) return;
    memory_.fit(frame.tree);
    takeLateAnswers();
    familyOf_ = kNoParent;
    push(*root, kNoParent, 0);
    const bool doesPoll = counting_ != nullptr && counting_->isPollFree();
    while (!queue_.empty() || !pending_.empty() || askedGathered_ < gathered_.size()) {
        // The last of all: behind as much as can be, and with as many as there are.
        if (queue_.empty() && pending_.empty()) askGathered();
        takeAnswers(doesPoll);
        if (!queue_.empty()) visit(pop());
    }
}

// In order, as far as they have come; waits for them when nothing is left to visit.
void CoherentStrategy::takeAnswers(bool doesPoll) {
    while (!pending_.empty()) {
        const Asked oldest = pending_.front();
        std::optional<uint64_t> visiblePx;
        if (doesPoll) visiblePx = counting_->poll(oldest.ticket);
        if (!visiblePx) {
            if (!queue_.empty()) return;
            ++frame_->record.waits;
            visiblePx = counting_->wait(oldest.ticket);
        }
        pending_.pop_front();
        if (oldest.together == 0) {
            answer(oldest.visit, *visiblePx);
            continue;
        }
        for (uint32_t i = 0; i < oldest.together; ++i) {
            const uint32_t index = gathered_[oldest.visit + i];
            if (*visiblePx == 0) {
                answer(index, 0);
            } else {
                ask(index);
            }
        }
    }
}

// Is `a` taken after `b`? Nearest first; ties by id.
bool CoherentStrategy::isLater(const Queued& a, const Queued& b) const {
    if (a.distance != b.distance) return a.distance > b.distance;
    return visits_[a.visit].node.page() > visits_[b.visit].node.page();
}

// A family lies side by side in memory: what its visits need of it is taken here, once.
void CoherentStrategy::push(const Node& node, uint32_t parent, uint32_t probeLevel) {
    const View& view = frame_->view;
    const auto index = static_cast<uint32_t>(visits_.size());
    Visit& visit = visits_.emplace_back();
    visit.node = node;
    visit.parent = parent;
    visit.probeLevel = probeLevel;
    if (view.intersectsFrustum(*node.boxModel)) {
        visit.memory = &memory_[node];
        visit.ssePx = view.ssePx(node.record->errorModelUnits, *node.boxModel);
    }
    queue_.push_back({static_cast<float>(view.distanceTo(*node.boxModel)), index});
    std::push_heap(queue_.begin(), queue_.end(),
                   [this](const Queued& a, const Queued& b) { return isLater(a, b); });
}

uint32_t CoherentStrategy::pop() {
    std::pop_heap(queue_.begin(), queue_.end(),
                  [this](const Queued& a, const Queued& b) { return isLater(a, b); });
    const uint32_t index = queue_.back().visit;
    queue_.pop_back();
    return index;
}

const NodeRange& CoherentStrategy::children(uint32_t index, double priority) {
    if (familyOf_ != index || family_.empty()) {
        family_ = frame_->tree.children(visits_[index].node, priority);
        familyOf_ = index;
    }
    return family_;
}

bool CoherentStrategy::isFine(const Visit& visit, double bias) const {
    if (visit.node.isLeaf()) return true;
    const double weight = rules_.doesWeighError ? bias : 1.0;
    return frame_->tauPx > 0.0 && weight * visit.ssePx <= frame_->tauPx;
}

double CoherentStrategy::biasOf(uint64_t visiblePx, double outlinePx) const {
    const StrategyOptions& options = rules_.options;
    const double share = shareOf(visiblePx, outlinePx);
    return std::max(sigmoidBias(share, options.biasS, options.biasT), options.biasFloor);
}

double CoherentStrategy::priorityOf(const Visit& visit) const {
    // Of the parent's error: how badly the node is missed.
    const bool hasExcess = visit.parent != kNoParent && frame_->tauPx > 0.0;
    const double excess = hasExcess ? visits_[visit.parent].ssePx / frame_->tauPx : 1.0;
    return requestPriority(static_cast<double>(visit.visiblePx), excess);
}

void CoherentStrategy::visit(uint32_t index) {
    Visit& visit = visits_[index];
    ++frame_->record.visitedNodes;
    if (visit.memory == nullptr) {
        ++frame_->record.culledNodes;
        return;
    }
    visit.prediction = predict(index);
    Memory& memory = *visit.memory;
    memory.wasRefined = memory.isRefined && wasVisitedBefore(memory);
    memory.isRefined = memory.isVisible = false;
    if (!wasVisitedBefore(memory)) memory.hiddenFrames = 0;
    memory.isStop = visit.prediction != Prediction::Refine;
    memory.visitedFrame = frameNumber_;
    if (NodeWatch* const watch = watchOf(visit)) {
        watch->predictedFrame = frame_->frameIndex;
        watch->prediction = visit.prediction == Prediction::Refine ? NodeWatch::Prediction::Refine
                            : visit.prediction == Prediction::Stop ? NodeWatch::Prediction::Stop
                                                                   : NodeWatch::Prediction::Delay;
    }
    if (counting_ == nullptr || crossesNear(frame_->view, *visit.node.boxModel)) {
        seeUnasked(index);
        return;
    }
    PredictionCounts& counts = frame_->record.predictions;
    if (visit.prediction == Prediction::Refine) {
        ++counts.refine;
        emit(index);
        return;
    }
    ++(visit.prediction == Prediction::Stop ? counts.stop : counts.delay);
    if (isTrusted(visit)) return trust(index);
    if (!isGathered(visit)) return ask(index);
    gathered_.push_back(index);
    if (gathered_.size() - askedGathered_ >= rules_.options.hiddenBatch) askGathered();
}

bool CoherentStrategy::isTrusted(const Visit& visit) const {
    const uint32_t every = rules_.options.retestEvery;
    if (every <= 1 || visit.prediction != Prediction::Stop || frame_->isSameView) return false;
    const auto ownTime = static_cast<uint32_t>(cache::PageIdHash{}(visit.node.page()) >> 32);
    return (ownTime + frameNumber_) % every != 0;
}

void CoherentStrategy::trust(uint32_t index) {
    Visit& visit = visits_[index];
    visit.visiblePx =
        static_cast<uint64_t>(visit.memory->bias * boxPixels(frame_->view, *visit.node.boxModel));
    markVisible(index);
    emit(index);
}

bool CoherentStrategy::isGathered(const Visit& visit) const {
    // A still view comes to rest: nothing changes in it because something was hidden for long.
    return rules_.options.hiddenBatch > 1 && !frame_->isSameView && !rules_.usesPyramid &&
           !rules_.doesWaitAtOnce && visit.prediction == Prediction::Delay &&
           visit.memory->hiddenFrames >= kLongHiddenFrames;
}

void CoherentStrategy::askGathered() {
    const auto begin = static_cast<uint32_t>(askedGathered_);
    const auto count = static_cast<uint32_t>(gathered_.size()) - begin;
    askedGathered_ = gathered_.size();
    if (count == 0) return;
    if (count == 1) return ask(gathered_[begin]);
    std::vector<Box3d> boxes;
    boxes.reserve(count);
    for (uint32_t i = 0; i < count; ++i) {
        boxes.push_back(*visits_[gathered_[begin + i]].node.boxModel);
    }
    pending_.push_back({begin, counting_->query(boxes), count});
}

void CoherentStrategy::ask(uint32_t index) {
    if (late_ != nullptr && visits_[index].prediction == Prediction::Stop) return askLate(index);
    const QueryTicket ticket = counting_->query(*visits_[index].node.boxModel);
    if (rules_.doesWaitAtOnce) {
        ++frame_->record.waits;
        answer(index, counting_->wait(ticket));
        return;
    }
    pending_.push_back({index, ticket});
    if (visits_[index].prediction == Prediction::Stop) emit(index);
}

// Until its answer comes, what was last known holds: it is seen.
void CoherentStrategy::askLate(uint32_t index) {
    Visit& visit = visits_[index];
    const double outlinePx = boxPixels(frame_->view, *visit.node.boxModel);
    lateQueries_.push_back(
        {visit.node.page(), visit.node.slot, outlinePx, late_->query(*visit.node.boxModel)});
    visit.visiblePx = static_cast<uint64_t>(outlinePx);
    markVisible(index);
    emit(index);
}

// In order, as far as they have come. What has not been visited since is unknown all the same.
void CoherentStrategy::takeLateAnswers() {
    if (late_ == nullptr) return;
    while (!lateQueries_.empty()) {
        const LateQuery& query = lateQueries_.front();
        const std::optional<uint64_t> visiblePx = late_->poll(query.ticket);
        if (!visiblePx) break;
        Memory* memory = memory_.find(query.slot, query.page);
        if (memory != nullptr && wasVisitedBefore(*memory) && memory->isStop) {
            memory->isDoubted = *visiblePx == 0;
            memory->isVisible = !memory->isDoubted;
            if (memory->isVisible) memory->bias = biasOf(*visiblePx, query.outlinePx);
            if (frame_->watch != nullptr && frame_->watch->page == query.page) {
                noteAnswer(*frame_->watch, *visiblePx, query.outlinePx, false);
            }
        }
        lateQueries_.pop_front();
    }
}

CoherentStrategy::Prediction CoherentStrategy::predict(uint32_t index) {
    if (rules_.predict == CoherentRules::Predict::Never) return Prediction::Delay;
    const Visit& visit = visits_[index];
    const Memory& memory = *visit.memory;
    // New, back in the frustum, or hidden.
    if (!wasVisitedBefore(memory) || !memory.isVisible) return Prediction::Delay;
    // Asked again from the same place it would come and go.
    if (memory.isDoubted && frame_->isSameView) return Prediction::Delay;
    if (rules_.predict == CoherentRules::Predict::InOrder) {
        return isFine(visit, lastBias_) ? Prediction::Stop : Prediction::Refine;
    }
    if (!memory.isStop && !rules_.options.isAsPublished &&
        hasHiddenChildrenOnly(children(index, 0.0))) {
        return Prediction::Delay;
    }
    if (memory.isStop || !rules_.doesWeighError) {
        if (!isFine(visit, memory.bias)) return Prediction::Refine;
        const bool isSure = isFine(visit, memory.bias * (1.0 + rules_.options.caution));
        return isSure || !rules_.doesWeighError ? Prediction::Stop : Prediction::Delay;
    }
    if (!mayCoarsen_) return Prediction::Refine;
    return mayRise(visit, children(index, 0.0)) ? Prediction::Delay : Prediction::Refine;
}

// Its own box was seen and nothing below it: it goes on waiting for its answer. Refined at once,
// its children would be asked about before what hides them is drawn, be seen, and hidden again when
// it waits: a still view would never rest.
bool CoherentStrategy::hasHiddenChildrenOnly(const NodeRange& children) {
    bool hasHidden = false;
    for (uint32_t i = 0; i < children.size(); ++i) {
        const Memory& memory = memory_[children[i]];
        if (!wasVisitedBefore(memory)) continue;
        if (memory.isVisible) return false;
        hasHidden = true;
    }
    return hasHidden;
}

// Would the node do in place of its children, by what they answered? A hidden child weighs nothing;
// one that was out of the frustum does not count.
bool CoherentStrategy::mayRise(const Visit& visit, const NodeRange& children) {
    double biasSum = 0.0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < children.size(); ++i) {
        const Node child = children[i];
        const Memory& memory = memory_[child];
        if (!wasVisitedBefore(memory)) continue;
        ++count;
        // The listing asks all children, the hidden ones as well, whether they stopped.
        if (rules_.options.isAsPublished && !memory.isStop) return false;
        if (!memory.isVisible) continue;
        const double ssePx = frame_->view.ssePx(child.record->errorModelUnits, *child.boxModel);
        const bool isChildFine = memory.bias * ssePx <= frame_->tauPx;
        if (!memory.isStop || !(child.isLeaf() || isChildFine)) return false;
        biasSum += memory.bias;
    }
    return count > 0 && isFine(visit, biasSum / count * (1.0 + rules_.options.hysteresis));
}

// A box that reaches the eye's side of the near plane is visible, whatever a query would say.
void CoherentStrategy::seeUnasked(uint32_t index) {
    Visit& visit = visits_[index];
    Memory& memory = *visit.memory;
    visit.visiblePx = static_cast<uint64_t>(frame_->view.camera().widthPx) *
                      static_cast<uint64_t>(frame_->view.camera().heightPx);
    memory.bias = 1.0;
    memory.isStop = isFine(visit, 1.0);
    if (NodeWatch* const watch = watchOf(visit)) noteAnswer(*watch, visit.visiblePx, 0.0, true);
    markVisible(index);
    emit(index);
}

void CoherentStrategy::answer(uint32_t index, uint64_t visiblePx) {
    Visit& visit = visits_[index];
    Memory& memory = *visit.memory;
    PredictionCounts& counts = frame_->record.predictions;
    const bool wasStop = visit.prediction == Prediction::Stop;
    visit.visiblePx = visiblePx;
    if (NodeWatch* const watch = watchOf(visit)) {
        noteAnswer(*watch, visiblePx, boxPixels(frame_->view, *visit.node.boxModel), false);
    }
    if (visiblePx == 0) {
        if (memory.hiddenFrames < UINT8_MAX) ++memory.hiddenFrames;
        ++(wasStop ? counts.stopHidden : counts.delayHidden);
        if (!wasStop && visit.probeLevel == 0) frame_->sink.hide(visit.node);
        return;
    }
    markVisible(index);
    memory.bias = lastBias_ = biasOf(visiblePx, boxPixels(frame_->view, *visit.node.boxModel));
    const bool staysRefined = !mayCoarsen_ && memory.wasRefined;
    memory.isStop = isFine(visit, memory.bias) && !staysRefined;
    if (!wasStop) {
        ++counts.delayVisible;
        if (memory.isStop && visit.probeLevel == 0) ++frame_->record.delayedNodes;
    } else if (!memory.isStop && visit.isDrawn) {
        ++frame_->record.rarnNodes;
    }
    emit(index);
}

NodeWatch* CoherentStrategy::watchOf(const Visit& visit) const {
    const bool isWatched = frame_->watch != nullptr && frame_->watch->page == visit.node.page();
    return isWatched ? frame_->watch : nullptr;
}

void CoherentStrategy::noteAnswer(NodeWatch& watch, uint64_t visiblePx, double outlinePx,
                                  bool isUnasked) const {
    watch.answeredFrame = frame_->frameIndex;
    watch.isUnasked = isUnasked;
    watch.visiblePx = visiblePx;
    watch.outlinePx = outlinePx;
    watch.relativeVisibility = shareOf(visiblePx, outlinePx);
    watch.bias = isUnasked ? 1.0 : biasOf(visiblePx, outlinePx);
}

void CoherentStrategy::markVisible(uint32_t index) {
    for (; index != kNoParent; index = visits_[index].parent) {
        Memory& memory = *visits_[index].memory;
        if (memory.isVisible) return;
        memory.isVisible = true;
        memory.hiddenFrames = 0;
    }
}

void CoherentStrategy::emit(uint32_t index) {
    if (visits_[index].memory->isStop) {
        draw(index);
    } else {
        refine(index);
    }
}

void CoherentStrategy::draw(uint32_t index) {
    Visit& visit = visits_[index];
    if (visit.isDrawn) return;
    const cache::PageState state = frame_->sink.want(visit.node, priorityOf(visit), Use::Cut);
    if (visit.probeLevel > 0) return;
    if (state != cache::PageState::Resident) return standInFor(index);
    visit.isDrawn = true;
    frame_->record.risenNodes += visit.memory->wasRefined;
    frame_->sink.draw(visit.node, Use::Cut);
}

void CoherentStrategy::refine(uint32_t index) {
    const Visit visit = visits_[index];  // push() moves them
    const double priority = priorityOf(visit);
    const NodeRange family = children(index, priority);
    const bool canBe = canRefine(*visit.memory, family);
    if (visit.probeLevel > 0) {
        frame_->sink.want(visit.node, priority, Use::StandIn);
        if (visit.probeLevel >= frame_->probeLevels) return;
    } else if (canBe) {
        visit.memory->isRefined = true;
        frame_->sink.refine(visit.node);
        frame_->sink.keep(visit.node);
    } else if (!drawStandIn(index)) {
        standInFor(index);
    }
    const uint32_t below = visit.probeLevel > 0 || !canBe ? visit.probeLevel + 1 : 0;
    for (uint32_t i = 0; i < family.size(); ++i) push(family[i], index, below);
}

// A node may be left for its children when all that are not known to be hidden are there, or when
// it was left for them in the last frame: then nothing gets coarser, and a missing one has a
// stand-in beside the others.
bool CoherentStrategy::canRefine(const Memory& memory, const NodeRange& children) {
    if (children.empty()) return false;
    bool isWhole = true;
    for (uint32_t i = 0; i < children.size(); ++i) {
        const Node child = children[i];
        const cache::PageState state = frame_->sink.state(child);
        if (state == cache::PageState::Resident) continue;
        const Memory& known = memory_[child];
        const bool isHidden = wasVisitedBefore(known) && !known.isVisible;
        if (isHidden || !frame_->view.intersectsFrustum(*child.boxModel)) continue;
        if (state == cache::PageState::Failed) return false;
        isWhole = false;
    }
    return isWhole || memory.wasRefined;
}

// The nearest resident ancestor covers a node that is seen and not there.
void CoherentStrategy::standInFor(uint32_t index) {
    for (index = visits_[index].parent; index != kNoParent; index = visits_[index].parent) {
        if (visits_[index].isDrawn || drawStandIn(index)) return;
    }
}

bool CoherentStrategy::drawStandIn(uint32_t index) {
    Visit& visit = visits_[index];
    if (visit.isDrawn) return true;
    if (frame_->sink.want(visit.node, priorityOf(visit), Use::StandIn) !=
        cache::PageState::Resident) {
        return false;
    }
    visit.isDrawn = true;
    frame_->sink.draw(visit.node, Use::StandIn);
    return true;
}

namespace {

std::unique_ptr<Strategy> make(CoherentRules rules, const StrategyOptions& options) {
    rules.options = options;
    return std::make_unique<CoherentStrategy>(rules);
}

}  // namespace

std::unique_ptr<Strategy> makeBoolStrategy(const StrategyOptions& options) {
    return make({.doesWeighError = false}, options);
}

std::unique_ptr<Strategy> makeSwStrategy(const StrategyOptions& options) {
    return make({.predict = CoherentRules::Predict::Never, .doesWaitAtOnce = true}, options);
}

std::unique_ptr<Strategy> makeSimpStrategy(const StrategyOptions& options) {
    return make({.predict = CoherentRules::Predict::InOrder}, options);
}

std::unique_ptr<Strategy> makeCohStrategy(const StrategyOptions& options) {
    return make({}, options);
}

std::unique_ptr<Strategy> makeLateStrategy(const StrategyOptions& options) {
    return make({.usesPyramid = true, .takesLateAnswers = true}, options);
}

std::unique_ptr<Strategy> makeHzbStrategy(const StrategyOptions& options) {
    return make({.usesPyramid = true}, options);
}

}  // namespace pagoda::hlod
