#include "hlod/strategies/pyramid_answers.h"

namespace pagoda::hlod {

void PyramidAnswers::beginFrame(PyramidVisibility& pyramid, FrameRecord& record) {
    pyramid_ = &pyramid;
    record_ = &record;
    boxes_.clear();
    isBuilt_ = false;
}

QueryTicket PyramidAnswers::query(const QueryShape& shape) {
    boxes_.push_back(std::get<Box3d>(shape));
    ++record_->queries;
    return {boxes_.size() - 1};
}

uint64_t PyramidAnswers::wait(QueryTicket ticket) {
    if (!isBuilt_) pyramid_->build();
    isBuilt_ = true;
    return pyramid_->visiblePixels(boxes_[ticket.value]);
}

}  // namespace pagoda::hlod
