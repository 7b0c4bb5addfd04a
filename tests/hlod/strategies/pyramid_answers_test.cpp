// When a pyramid is built, and how many boxes are tested at once.
#include "hlod/strategies/pyramid_answers.h"

#include <gtest/gtest.h>

namespace pagoda::hlod {
namespace {

// A box answers with its own least x.
class CountingPyramid final : public PyramidVisibility {
public:
    void build() override { ++builds; }
    void visiblePixels(std::span<const Box3d> boxes, std::span<uint64_t> pixels) override {
        batches.push_back(boxes.size());
        for (size_t i = 0; i < boxes.size(); ++i) pixels[i] = static_cast<uint64_t>(boxes[i].min.x);
    }
    int builds = 0;
    std::vector<size_t> batches;
};

Box3d boxAt(double x) {
    return {Vec3d(x, 0, 0), Vec3d(x + 1, 1, 1)};
}

TEST(PyramidAnswers, TestsAllThatWasAskedAtOnceWheneverAnAnswerIsNotThere) {
    CountingPyramid pyramid;
    FrameRecord record;
    PyramidAnswers answers;
    for (int frame = 1; frame <= 2; ++frame) {
        pyramid.batches.clear();
        answers.beginFrame(pyramid, record);
        const QueryTicket a = answers.query(boxAt(7)), b = answers.query(boxAt(8));
        EXPECT_EQ(pyramid.builds, frame - 1);  // more may be drawn before it is needed
        EXPECT_EQ(answers.wait(a), 7u);
        const QueryTicket c = answers.query(boxAt(9));
        EXPECT_EQ(answers.wait(b), 8u);
        const QueryTicket d = answers.query(boxAt(0));
        EXPECT_EQ(answers.wait(c), 9u);
        EXPECT_EQ(answers.wait(d), 0u);
        EXPECT_EQ(pyramid.builds, frame);
        EXPECT_EQ(pyramid.batches, (std::vector<size_t>{2, 2}));
    }
    EXPECT_EQ(record.queries, 8u);
}

}  // namespace
}  // namespace pagoda::hlod
