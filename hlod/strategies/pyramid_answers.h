// pyramid_answers.h: a depth pyramid that answers as queries do.
#pragma once

#include "hlod/view/frame_record.h"
#include "hlod/view/visibility.h"

#include <vector>

namespace pagoda::hlod {

// Answers from a depth pyramid, which is built when the first one is waited for: every box of the
// frame is tested against what was drawn by then. Whenever one is waited for that is not there, all
// that were asked by then are tested at once; since a walk goes on until nothing is left to do but
// wait, that is about once for each level of the tree.
class PyramidAnswers final : public CountingVisibility {
public:
    void beginFrame(PyramidVisibility& pyramid, FrameRecord& record);
    [[nodiscard]] QueryTicket query(const QueryShape& shape) override;
    [[nodiscard]] std::optional<uint64_t> poll(QueryTicket ticket) override { return wait(ticket); }
    [[nodiscard]] uint64_t wait(QueryTicket ticket) override;

private:
    void testAsked();

    PyramidVisibility* pyramid_ = nullptr;
    FrameRecord* record_ = nullptr;
    std::vector<Box3d> boxes_;       // by ticket
    std::vector<uint64_t> answers_;  // of the first boxes: those that were tested
    bool isBuilt_ = false;
};

}  // namespace pagoda::hlod
