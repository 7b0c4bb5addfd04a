#include "tools/opening/preview_maker.h"

#include <gtest/gtest.h>

namespace pagoda::tools {
namespace {

// `count` triangles beside each other, from the `first` on.
void add(PreviewMaker& maker, int first, int count) {
    ooc::TriangleBatch batch;
    for (int i = first; i < first + count; ++i) {
        batch.positions.insert(batch.positions.end(),
                               {Vec3d(i, 0, 0), Vec3d(i + 1, 0, 0), Vec3d(i, 1, 0)});
    }
    maker.addTriangles(batch);
}

TEST(PreviewMaker, WhatASampleHasMetCountsOnce) {
    PreviewMaker maker;
    maker.beginSample(ooc::UpAxis::Z);
    add(maker, 0, 30);
    maker.endSample();
    auto preview = maker.take();
    ASSERT_NE(preview, nullptr);
    EXPECT_EQ(preview->trianglesSeen, 30u);
    maker.beginSurvey(ooc::UpAxis::Z);
    add(maker, 0, 100);
    maker.endSurvey();
    preview = maker.take();
    ASSERT_NE(preview, nullptr);
    EXPECT_EQ(preview->trianglesSeen, 100u);
    EXPECT_TRUE(preview->isWhole);
}

}  // namespace
}  // namespace pagoda::tools
