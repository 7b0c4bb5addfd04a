#include "ooc/codecs/page_codec.h"

#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

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

INSTANTIATE_TEST_SUITE_P(Codecs, EveryCodec,
                         testing::Values(Codec::Raw, Codec::Meshopt, Codec::Draco),
                         [](const auto& test) { return std::string(codecName(test.param)); });

}  // namespace
}  // namespace pagoda::ooc
