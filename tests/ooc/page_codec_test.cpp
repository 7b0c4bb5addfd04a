#include "ooc/codecs/page_codec.h"

#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace pagoda::ooc {
namespace {

using test::MeshOptions;
using test::randomMesh;
using test::sortedTriangles;

class EveryCodec : public testing::TestWithParam<Codec> {};

void expectSameTriangles(const PageMesh& mesh, Codec codec) {
    const DecodeResult result = decodePage(encodePage({mesh, {}}, codec));
    ASSERT_TRUE(result.page) << result.fault;
    const PageMesh& back = result.page->mesh;
    EXPECT_EQ(back.runs, mesh.runs);
    EXPECT_EQ(back.partStart, mesh.partStart);
    EXPECT_EQ(back.constantColour, mesh.constantColour);
    EXPECT_EQ(back.colours.empty(), mesh.colours.empty());
    EXPECT_EQ(back.normals.empty(), mesh.normals.empty());
    EXPECT_EQ(back.vertexCount(), mesh.vertexCount());
    EXPECT_EQ(sortedTriangles(back), sortedTriangles(mesh));
}

TEST_P(EveryCodec, KeepsTrianglesOfRandomMeshesWithAllTheyCarry) {
    for (uint32_t seed = 0; seed < 200; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        const bool isWide = seed % 3 == 0;
        expectSameTriangles(
            randomMesh(random, {.triangleCount = 1 + seed * 3,
                                .extent = isWide ? 1 << 30 : 1 + static_cast<int32_t>(seed * 300),
                                .origin = isWide ? Vec3i(0) : Vec3i(5, 1 << 29, 77),
                                .hasColours = seed % 2 == 0,
                                .hasNormals = seed % 4 < 2,
                                .hasTranslucent = seed % 5 < 3}),
            GetParam());
    }
}

TEST_P(EveryCodec, KeepsAGridAsScansHaveThemInFewBytes) {
    PageMesh mesh;
    constexpr uint32_t kSide = 40;
    for (uint32_t i = 0; i <= kSide; ++i) {
        for (uint32_t j = 0; j <= kSide; ++j) {
            mesh.positions.emplace_back(i * 16, j * 16, (i * j) % 7);
        }
    }
    for (uint32_t i = 0; i < kSide; ++i) {
        for (uint32_t j = 0; j < kSide; ++j) {
            const uint32_t a = i * (kSide + 1) + j, b = a + kSide + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
        }
    }
    mesh.runs = {{.triangleCount = 2 * kSide * kSide, .object = 9, .material = 4}};
    mesh.partStart.fill(2 * kSide * kSide);
    std::fill_n(mesh.partStart.begin(), 4, 0u);  // all of octant 3
    expectSameTriangles(mesh, GetParam());
    const size_t bytes = encodePage({mesh, {}}, GetParam()).size();
    const size_t rawBytes = encodePage({mesh, {}}, Codec::Raw).size();
    EXPECT_TRUE(GetParam() == Codec::Raw || bytes < rawBytes / 3) << bytes << " of " << rawBytes;
}

TEST_P(EveryCodec, KeepsMeshesThatAreHardToCode) {
    PageMesh empty;
    expectSameTriangles(empty, GetParam());

    PageMesh mesh;  // repeated corners, the same triangle twice and flipped, a vertex of none
    mesh.positions = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}, {0, 0, 0}, {7, 7, 7}};
    mesh.indices = {0, 1, 2, 0, 1, 2, 2, 1, 0, 0, 0, 1, 3, 3, 3, 4, 1, 2};
    mesh.runs = {{.triangleCount = 6}};
    mesh.partStart.fill(6);
    mesh.partStart[0] = 0;
    expectSameTriangles(mesh, GetParam());

    mesh.positions[5] = {1 << 30, 0, 1 << 30};
    expectSameTriangles(mesh, GetParam());
}

TEST_P(EveryCodec, KeepsIndicesBeyond16Bits) {
    std::mt19937 random(5);
    const PageMesh mesh =
        randomMesh(random, {.triangleCount = 80000, .extent = 60000, .hasTranslucent = false});
    ASSERT_GT(mesh.vertexCount(), 65536u);
    expectSameTriangles(mesh, GetParam() == Codec::Draco ? Codec::Meshopt : GetParam());
}

TEST_P(EveryCodec, KeepsZippers) {
    std::mt19937 random(6);
    Page page{randomMesh(random, {.triangleCount = 10}), {}};
    page.zippers = {{.neighbour = 0x1234567890ull,
                     .positions = {{1, 2, 3}, {1 << 30, 5, 6}, {7, 8, 9}},
                     .indices = {0, 1, 2}},
                    {.neighbour = 17, .positions = {}, .indices = {}}};
    const DecodeResult result = decodePage(encodePage(page, GetParam()));
    ASSERT_TRUE(result.page) << result.fault;
    EXPECT_EQ(result.page->zippers, page.zippers);
}

TEST_P(EveryCodec, EncodesTheSameBytesEachTime) {
    const auto encode = [&] {
        std::mt19937 random(8);
        return encodePage({randomMesh(random, {.triangleCount = 300}), {}}, GetParam());
    };
    EXPECT_EQ(encode(), encode());
}

// A page that decodes must be one that can be drawn: nothing points beyond what is there.
void expectDrawable(const Page& page) {
    const PageMesh& mesh = page.mesh;
    for (const uint32_t index : mesh.indices) ASSERT_LT(index, mesh.vertexCount());
    ASSERT_TRUE(mesh.colours.empty() || mesh.colours.size() == mesh.positions.size());
    ASSERT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    uint64_t sum = 0;
    for (const MeshRun& run : mesh.runs) sum += run.triangleCount;
    ASSERT_EQ(sum, mesh.triangleCount());
    ASSERT_TRUE(std::is_sorted(mesh.partStart.begin(), mesh.partStart.end()));
    ASSERT_EQ(mesh.partStart[kPageParts], mesh.triangleCount());
}

TEST_P(EveryCodec, RefusesPagesCutShortAtAnyLength) {
    std::mt19937 random(9);
    const auto page = encodePage({randomMesh(random, {.triangleCount = 60}), {}}, GetParam());
    for (size_t bytes = 0; bytes < page.size(); ++bytes) {
        EXPECT_FALSE(decodePage(std::span(page).first(bytes)).page) << bytes;
    }
}

TEST_P(EveryCodec, RefusesOrDecodesToSomethingDrawableWhateverTheBytes) {
    std::mt19937 random(10);
    const auto page = encodePage({randomMesh(random, {.triangleCount = 60}), {}}, GetParam());
    for (size_t byte = 0; byte < page.size(); ++byte) {
        for (const unsigned change : {0x01u, 0x80u, 0xFFu}) {
            std::vector<std::byte> broken = page;
            broken[byte] ^= static_cast<std::byte>(change);
            const DecodeResult result = decodePage(broken);
            EXPECT_NE(result.page.has_value(), !result.fault.empty());
            if (result.page) expectDrawable(*result.page);
        }
    }
    for (int i = 0; i < 2000; ++i) {  // several bytes at once, anywhere
        std::vector<std::byte> broken = page;
        for (int k = 0; k < 4; ++k) broken[random() % broken.size()] = std::byte(random() & 0xFF);
        const DecodeResult result = decodePage(broken);
        if (result.page) expectDrawable(*result.page);
    }
}

TEST_P(EveryCodec, RefusesCountsThatNoBytesBackBeforeTakingMemory) {
    std::mt19937 random(11);
    const auto page = encodePage({randomMesh(random, {.triangleCount = 60}), {}}, GetParam());
    for (size_t at = 0; at + 4 <= page.size(); ++at) {
        for (const uint32_t count : {0x03FFFFFFu, 0x04000000u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
            std::vector<std::byte> broken = page;
            std::memcpy(broken.data() + at, &count, 4);
            const DecodeResult result = decodePage(broken);
            if (result.page) expectDrawable(*result.page);
        }
    }
}

TEST(Page, SkipsSectionsOfUnknownTags) {
    std::mt19937 random(12);
    const PageMesh mesh = randomMesh(random, {.triangleCount = 5});
    std::vector<std::byte> page = encodePage({mesh, {}}, Codec::Raw);
    // Insert a second entry, moving the mesh section back by its 16 bytes, and its 3 bytes behind.
    const auto get = [&](size_t at) {
        uint32_t value = 0;
        std::memcpy(&value, page.data() + at, 4);
        return value;
    };
    const auto put = [&](size_t at, uint32_t value) { std::memcpy(page.data() + at, &value, 4); };
    page.insert(page.begin() + 20, 16, std::byte{0});
    put(0, 2);
    put(12, get(12) + 16);
    std::memcpy(page.data() + 20, "NEW!", 4);
    put(24, 77);  // a codec of the future
    put(28, static_cast<uint32_t>(page.size()));
    put(32, 3);
    page.insert(page.end(), 3, std::byte{42});
    const DecodeResult result = decodePage(page);
    ASSERT_TRUE(result.page) << result.fault;
    EXPECT_EQ(result.page->mesh, mesh);
}

TEST(Page, FallsBackToMeshoptWhereDracoWouldLoseSomething) {
    const auto codecOf = [](const PageMesh& mesh) {
        return static_cast<Codec>(encodePage({mesh, {}}, Codec::Draco)[8]);
    };
    PageMesh mesh;
    mesh.positions = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}};
    mesh.indices = {0, 1, 2};
    mesh.runs = {{.triangleCount = 1}};
    mesh.partStart.fill(1);
    mesh.partStart[0] = 0;
    EXPECT_EQ(codecOf(mesh), Codec::Draco);
    mesh.positions.push_back({5, 5, 5});  // of no triangle
    EXPECT_EQ(codecOf(mesh), Codec::Meshopt);
    mesh.positions.pop_back();
    mesh.indices = {0, 1, 1};
    EXPECT_EQ(codecOf(mesh), Codec::Meshopt);
    mesh.indices = {0, 1, 2};
    mesh.positions[1].x = 1 << 21;
    EXPECT_EQ(codecOf(mesh), Codec::Meshopt);
}

INSTANTIATE_TEST_SUITE_P(Codecs, EveryCodec,
                         testing::Values(Codec::Raw, Codec::Meshopt, Codec::Draco),
                         [](const auto& test) { return std::string(codecName(test.param)); });

}  // namespace
}  // namespace pagoda::ooc
