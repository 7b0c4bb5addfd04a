// pyramid_answers.h: a depth pyramid that answers as queries do.
#pragma once

#include "hlod/view/frame_record.h"
#include "hlod/view/visibility.h"

#include <vector>

namespace pagoda::hlod {

// Answers from a depth pyramid, which is built when the first one is waited for: every box of the
// frame is tested against what was drawn by then.
class PyramidAnswers final : public CountingVisibility {
public:
    void beginFrame(PyramidVisibility& pyramid, FrameRecord& record);
    [[nodiscard]] QueryTicket query(const QueryShape& shape) override;
    [[nodiscard]] std::optional<uint64_t> poll(QueryTicket ticket) override { return wait(ticket); }
    [[nodiscard]] uint64_t wait(QueryTicket ticket) override;

private:
    PyramidVisibility* pyramid_ = nullptr;
    FrameRecord* record_ = nullptr;
    std::vector<Box3d> boxes_;
    bool isBuilt_ = false;
};

}  // namespace pagoda::hlod
