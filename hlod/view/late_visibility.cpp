#include "hlod/view/late_visibility.h"

#include <cassert>

namespace pagoda::hlod {

void LateVisibility::beginFrame(CountingVisibility* inner) {
    inner_ = inner;
    ++frame_;
    queries_ = stalledFrames_ = 0;
}

QueryTicket LateVisibility::query(const QueryShape& shape) {
    const QueryTicket ticket = inner_->query(shape);
    ++queries_;
    if (latencyFrames_ > 0) asked_[ticket.value] = {frame_};
    return ticket;
}

std::optional<uint64_t> LateVisibility::poll(QueryTicket ticket) {
    if (latencyFrames_ == 0) return inner_->poll(ticket);
    const auto found = asked_.find(ticket.value);
    assert(found != asked_.end());
    if (frame_ - found->second.frame < latencyFrames_) return std::nullopt;
    asked_.erase(found);
    return inner_->wait(ticket);
}

void LateVisibility::abandonAll() {
    asked_.clear();
    if (inner_ != nullptr) inner_->abandonAll();
}

uint64_t LateVisibility::wait(QueryTicket ticket) {
    if (latencyFrames_ > 0) {
        const auto found = asked_.find(ticket.value);
        assert(found != asked_.end());
        const uint64_t age = frame_ - found->second.frame;
        if (age < latencyFrames_) stalledFrames_ += latencyFrames_ - age;
        asked_.erase(found);
    }
    return inner_->wait(ticket);
}

}  // namespace pagoda::hlod
