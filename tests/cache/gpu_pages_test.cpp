#include "cache/gpu_pages.h"

#include <gtest/gtest.h>

namespace pagoda::cache {
namespace {

constexpr uint64_t kGranule = 64 * 20;

ooc::Page page(size_t vertices, size_t triangles) {
    ooc::Page page;
    page.mesh.positions.resize(vertices);
    page.mesh.indices.resize(3 * triangles);
    return page;
}

TEST(GpuPageLayout, VerticesIndicesAndNormalsFollowEachOtherInWholeGranules) {
    // 101 triangles: 606 bytes of indices, padded to a word; 404 of normals.
    const GpuPageLayout layout = gpuLayoutOf(page(200, 101));
    EXPECT_EQ(layout.vertexBytes(), 4000u);
    EXPECT_EQ(layout.indexBytes(), 608u);
    EXPECT_EQ(layout.bytes(), 4000u + 608 + 404);
    EXPECT_EQ(layout.sizeBytes(), 4 * kGranule);
    EXPECT_EQ(gpuLayoutOf(page(0, 0)).sizeBytes(), kGranule);
    EXPECT_EQ(gpuLayoutOf(page(64, 0)).sizeBytes(), kGranule);
    EXPECT_EQ(gpuLayoutOf(page(65, 0)).sizeBytes(), 2 * kGranule);
}

TEST(GpuPageLayout, NormalsOfFacesAreLeftOutOnlyWhereEveryVertexHasOne) {
    ooc::Page smooth = page(3, 1);
    smooth.mesh.normals.assign(3, ooc::OctNormal{1, 1});
    EXPECT_EQ(gpuLayoutOf(smooth).faceNormals, 0u);
    ooc::Page half = smooth;
    half.mesh.normals[1] = ooc::OctNormal{};
    ASSERT_TRUE(half.mesh.normals[1].isNone());
    EXPECT_EQ(gpuLayoutOf(half).faceNormals, 1u);
    ooc::Page zipped = smooth;
    zipped.zippers.resize(1);
    zipped.zippers[0].positions.resize(4);
    zipped.zippers[0].indices.resize(6);
    const GpuPageLayout layout = gpuLayoutOf(zipped);
    EXPECT_EQ(layout.vertices, 7u);
    EXPECT_EQ(layout.indices, 9u);
    EXPECT_EQ(layout.faceNormals, 3u);
}

TEST(GpuPageLayout, TheRecordForetellsAPageWithoutZippersExactlyAndNeverTooLittle) {
    ooc::NodeRecord node;
    node.vertexCount = 500;
    node.triangleCount = 900;
    EXPECT_EQ(gpuLayoutOf(node).sizeBytes(), gpuLayoutOf(page(500, 900)).sizeBytes());
    ooc::Page smooth = page(500, 900);
    smooth.mesh.normals.assign(500, ooc::OctNormal{1, 1});
    EXPECT_GE(gpuLayoutOf(node).sizeBytes(), gpuLayoutOf(smooth).sizeBytes());
}

}  // namespace
}  // namespace pagoda::cache
