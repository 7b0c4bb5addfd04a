#include "hlod/strategies/pyramid_answers.h"

namespace pagoda::hlod {

void PyramidAnswers::beginFrame(PyramidVisibility& pyramid, FrameRecord& record) {
    pyramid_ = &pyramid;
    record_ = &record;
    boxes_.clear();
    answers_.clear();
    isBuilt_ = false;
}

QueryTicket PyramidAnswers::query(const QueryShape& shape) {
    boxes_.push_back(std::get<Box3d>(shape));
    ++record_->queries;
    return {boxes_.size() - 1};
}

uint64_t PyramidAnswers::wait(QueryTicket ticket) {
    if (ticket.value >= answers_.size()) testAsked();
    return answers_[ticket.value];
}

void PyramidAnswers::testAsked() {
    if (!isBuilt_) pyramid_->build();
    isBuilt_ = true;
    const size_t answered = answers_.size();
    answers_.resize(boxes_.size());
    pyramid_->visiblePixels(std::span(boxes_).subspan(answered),
                            std::span(answers_).subspan(answered));
}

}  // namespace pagoda::hlod
