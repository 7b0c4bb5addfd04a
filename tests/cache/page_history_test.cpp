// What is remembered of a page: when it came, and for whom it went.
#include "cache/page_history.h"

#include "ooc/codecs/mesh_codec.h"
#include "tests/cache/scripted_world.h"

#include <gtest/gtest.h>

namespace pagoda::cache {
namespace {

using test::pageOf;
using test::Tree;
using test::World;

TEST(PageHistory, TellsWhenAPageCameAndForWhomItWent) {
    const Tree tree;
    World world({.budgets = {uint64_t{1} << 20, 25, 0}});  // two pages of 10 bytes fit
    world.frames(3, {&tree.root(), &tree.child(0)});
    const PageStory* story = world.residency.history().find(pageOf(tree.child(0)));
    ASSERT_NE(story, nullptr);
    EXPECT_EQ(story->reads, 1u);
    EXPECT_EQ(story->readFrame, 1u);  // asked for in it, there before the next
    EXPECT_EQ(story->uploadedFrame, 2u);
    EXPECT_EQ(story->evictedFrame, 0u);
    world.frames(8, {&tree.root(), &tree.child(3)});
    ASSERT_TRUE(world.isResident(tree.child(3)));
    story = world.residency.history().find(pageOf(tree.child(0)));
    EXPECT_EQ(story->evictedFor, pageOf(tree.child(3)));
    EXPECT_EQ(story->evictedFrame,
              world.residency.history().find(pageOf(tree.child(3)))->uploadedFrame);
    EXPECT_EQ(world.residency.history().find(pageOf(tree.child(5))), nullptr);
}

TEST(PageHistory, ForgetsTheOldestPages) {
    PageHistory history;
    const auto page = [](uint64_t i) { return PageId{0, ooc::NodeId{i}}; };
    for (uint64_t i = 0; i < PageHistory::kMaxPages + 10; ++i) history.noteRead(page(i), i + 1, 0);
    EXPECT_EQ(history.find(page(9)), nullptr);
    ASSERT_NE(history.find(page(10)), nullptr);
    EXPECT_EQ(history.find(page(10))->readFrame, 11u);
    for (int i = 0; i < 100; ++i) history.noteUploaded(page(10), 5);  // of a known one: none goes
    EXPECT_NE(history.find(page(11)), nullptr);
}

TEST(CodecStatistics, SumUpWhatArrived) {
    const Tree tree;
    World world;
    world.frames(3, {&tree.root(), &tree.child(0), &tree.child(1)});
    const CodecSums& sums =
        world.residency.codecs()[static_cast<size_t>(ooc::Codec::Raw)];  // scripts have none
    EXPECT_EQ(sums.pages, 3u);
    EXPECT_EQ(sums.encodedBytes, world.residency.counters().bytesRead);
    EXPECT_EQ(sums.vertices, 30u);
    EXPECT_EQ(sums.decodedBytes, 3 * (sizeof(ooc::Page) + 10 * sizeof(Vec3i)));
}

TEST(CodecStatistics, ThePagesTableNamesItsCodec) {
    ooc::Page page;
    page.mesh.positions = {Vec3i(0), Vec3i(1, 0, 0), Vec3i(0, 1, 0)};
    page.mesh.indices = {0, 1, 2};
    page.mesh.runs = {{1, 0, 0}};
    page.mesh.partStart.fill(1);
    page.mesh.partStart[0] = 0;
    for (const ooc::Codec codec : {ooc::Codec::Raw, ooc::Codec::Meshopt, ooc::Codec::Draco}) {
        const std::vector<std::byte> bytes = ooc::encodePage(page, codec);
        EXPECT_EQ(ooc::meshCodecOf(bytes), codec);
        for (size_t size = 0; size < 20; ++size) {
            EXPECT_FALSE(ooc::meshCodecOf(std::span(bytes).first(size)));
        }
    }
}

}  // namespace
}  // namespace pagoda::cache
