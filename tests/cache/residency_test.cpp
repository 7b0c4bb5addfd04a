#include "cache/residency.h"
#include "cache/index_cache.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace pagoda::cache {
namespace {

// Pages of one triangle with `vertices` vertices, numbered by their node id.
class ScriptedPages final : public PageSource {
public:
    ooc::Loaded<ooc::Page> loadPage(const ooc::NodeRecord& node) override {
        ++loads;
        if (failing.contains(node.id)) return {std::nullopt, "page is cut short"};
        ooc::Page page;
        page.mesh.positions.resize(node.vertexCount);
        return {std::move(page), ""};
    }
    ooc::Loaded<ooc::IndexBlock> loadBlock(uint32_t block) override {
        ++blockLoads;
        if (block == 13) return {std::nullopt, "checksum is wrong"};
        return {ooc::IndexBlock{std::vector<ooc::NodeRecord>(2)}, ""};
    }
    std::set<ooc::NodeId> failing;
    int loads = 0, blockLoads = 0;
};

class CountingGpu final : public GpuPages {
public:
    uint64_t sizeBytes(const ooc::Page& page) const override { return page.mesh.positions.size(); }
    Upload upload(PageId id, const ooc::Page& page) override {
        if (page.mesh.positions.size() > 500) return Upload::Refused;
        if (fragmented > 0) {
            --fragmented;
            return Upload::NoRoom;
        }
        EXPECT_TRUE(resident.emplace(id, sizeBytes(page)).second);
        return Upload::Done;
    }
    void drop(PageId id) override { EXPECT_EQ(resident.erase(id), 1u); }
    uint64_t usedBytes() const {
        uint64_t sum = 0;
        for (const auto& [id, bytes] : resident) sum += bytes;
        return sum;
    }
    std::map<PageId, uint64_t> resident;
    int fragmented = 0;
};

struct Fixture {
    ScriptedPages pages;
    CountingGpu gpu;
    std::map<uint64_t, ooc::NodeRecord> records;

    PageRequest request(uint64_t node, uint32_t vertices) {
        ooc::NodeRecord& record = records[node];
        record.id = ooc::NodeId{node};
        record.vertexCount = vertices;
        record.pageBytes = vertices * 3;
        return {{0, record.id}, record};
    }
};

TEST(Residency, LoadsAPageOnceAndKeepsIt) {
    Fixture f;
    Residency residency({.hostBytes = 0, .gpuBytes = 100}, f.pages, f.gpu);
    residency.beginFrame(1);
    EXPECT_EQ(residency.want(f.request(1, 50)), PageState::Resident);
    EXPECT_EQ(residency.want(f.request(1, 50)), PageState::Resident);
    EXPECT_EQ(f.pages.loads, 1);
    EXPECT_EQ(residency.counters().bytesRead, 150u);
}

TEST(Residency, APageThatCannotBeReadCostsThatPageAloneAndIsCountedOnce) {
    Fixture f;
    f.pages.failing.insert(ooc::NodeId{3});
    Residency residency({.hostBytes = 0, .gpuBytes = 100}, f.pages, f.gpu);
    residency.beginFrame(1);
    EXPECT_EQ(residency.want(f.request(2, 10)), PageState::Resident);
    EXPECT_EQ(residency.want(f.request(3, 10)), PageState::Failed);
    EXPECT_EQ(residency.want(f.request(3, 10)), PageState::Failed);
    EXPECT_EQ(residency.want(f.request(4, 10)), PageState::Resident);
    EXPECT_EQ(f.pages.loads, 3);
    EXPECT_EQ(residency.counters().failedPages, 1u);
    ASSERT_EQ(residency.faults().size(), 1u);
    EXPECT_EQ(residency.faults().front().what, "page is cut short");
}

TEST(Residency, SaysNoRoomWhenTheFramesOwnPagesFillTheBudget) {
    Fixture f;
    Residency residency({.hostBytes = 0, .gpuBytes = 100}, f.pages, f.gpu);
    residency.beginFrame(1);
    EXPECT_EQ(residency.want(f.request(1, 60)), PageState::Resident);
    EXPECT_EQ(residency.want(f.request(2, 60)), PageState::NoRoom);
    EXPECT_TRUE(residency.isResident({0, ooc::NodeId{1}}));
    residency.beginFrame(2);
    EXPECT_EQ(residency.want(f.request(2, 60)), PageState::Resident);
    EXPECT_FALSE(residency.isResident({0, ooc::NodeId{1}}));
    EXPECT_TRUE(residency.faults().empty());
}

TEST(Residency, DropsMorePagesWhenGapsAreTooShort) {
    Fixture f;
    Residency residency({.hostBytes = 0, .gpuBytes = 100}, f.pages, f.gpu);
    residency.beginFrame(1);
    for (uint64_t node = 1; node <= 4; ++node) {
        EXPECT_EQ(residency.want(f.request(node, 20)), PageState::Resident);
    }
    residency.beginFrame(2);
    f.gpu.fragmented = 2;
    EXPECT_EQ(residency.want(f.request(9, 20)), PageState::Resident);
    EXPECT_EQ(f.gpu.resident.size(), 3u);
    EXPECT_EQ(residency.counters().evictedPages, 2u);
}

TEST(Residency, UploadsADecodedPageAgainWithoutReadingIt) {
    Fixture f;
    Residency residency({.hostBytes = 1 << 20, .gpuBytes = 100}, f.pages, f.gpu);
    residency.beginFrame(1);
    EXPECT_EQ(residency.want(f.request(1, 80)), PageState::Resident);
    residency.beginFrame(2);
    EXPECT_EQ(residency.want(f.request(2, 80)), PageState::Resident);
    residency.beginFrame(3);
    EXPECT_EQ(residency.want(f.request(1, 80)), PageState::Resident);
    EXPECT_EQ(f.pages.loads, 2);
    EXPECT_EQ(residency.counters().uploadedPages, 3u);
}

TEST(Residency, APageThatCannotBeDrawnIsAFault) {
    Fixture f;
    Residency residency({.hostBytes = 0, .gpuBytes = 1000}, f.pages, f.gpu);
    residency.beginFrame(1);
    EXPECT_EQ(residency.want(f.request(1, 501)), PageState::Failed);
    EXPECT_EQ(residency.faults().size(), 1u);
}

TEST(Residency, NeverExceedsItsBudgetsAndRepeatsItself) {
    const auto play = [](std::vector<uint64_t>& history) {
        std::mt19937_64 random(11);
        Fixture f;
        Residency residency({.hostBytes = 20000, .gpuBytes = 400}, f.pages, f.gpu);
        for (uint64_t frame = 1; frame <= 400; ++frame) {
            residency.beginFrame(frame);
            uint64_t wantedBytes = 0;
            for (int i = 0; i < 12; ++i) {
                const uint64_t node = 1 + random() % 80;
                const auto vertices = static_cast<uint32_t>(5 + node % 90);
                const PageState state = residency.want(f.request(node, vertices));
                if (state == PageState::Resident) wantedBytes += vertices;
                ASSERT_LE(f.gpu.usedBytes(), 400u);
                ASSERT_EQ(f.gpu.usedBytes(), residency.gpuUsedBytes());
                ASSERT_LE(residency.hostUsedBytes(), 20000u);
                history.push_back(static_cast<uint64_t>(state));
            }
            for (const auto& [id, bytes] : f.gpu.resident) history.push_back(id.node.value);
        }
        ASSERT_GT(residency.counters().evictedPages, 100u);
    };
    std::vector<uint64_t> first, second;
    play(first);
    play(second);
    EXPECT_EQ(first, second);
}

TEST(IndexCache, ReadsABlockOnceAndListsABrokenOneOnce) {
    ScriptedPages pages;
    IndexCache index(pages);
    EXPECT_NE(index.block(0), nullptr);
    EXPECT_EQ(index.block(0), index.block(0));
    EXPECT_EQ(pages.blockLoads, 1);
    EXPECT_EQ(index.block(13), nullptr);
    EXPECT_EQ(index.block(13), nullptr);
    EXPECT_EQ(pages.blockLoads, 2);
    ASSERT_EQ(index.faults().size(), 1u);
    EXPECT_EQ(index.faults().front().block, 13u);
}

}  // namespace
}  // namespace pagoda::cache
