#include "ooc/base/error.h"
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/test_files.h"

namespace pagoda::ooc::test {
namespace {

std::string binaryStl(uint32_t announced, uint32_t facets, std::string_view header = "",
                      uint16_t attribute = 0) {
    std::string file(header);
    file.resize(80, ' ');
    file += bytesOf(announced);
    for (uint32_t k = 0; k < facets; ++k) {
        const auto x = static_cast<float>(k);
        for (const float value : {0.f, 0.f, 1.f, x, 0.f, 0.f, x + 1, 0.f, 0.f, x, 1.f, 0.f}) {
            file += bytesOf(value);
        }
        file += bytesOf(attribute);
    }
    return file;
}

TEST(StlReader, ReadsBinaryFilesThatBeginLikeText) {
    const TempFolder folder;
    const auto sink =
        readAll(folder.write("a.stl", binaryStl(5000, 5000, "solid by another name")));
    ASSERT_EQ(sink.triangles.size(), 5000u);
    EXPECT_EQ(sink.triangles[4999].corner[1], Vec3d(5000, 0, 0));
    EXPECT_EQ(sink.triangles[4999].corner[2], Vec3d(4999, 1, 0));
    EXPECT_EQ(sink.objects.size(), 1u);
    EXPECT_TRUE(sink.ignoredThings.empty());
}

TEST(StlReader, AnnouncesTheTrianglesOfABinaryFile) {
    const TempFolder folder;
    const auto path = folder.write("a.stl", binaryStl(17, 17));
    EXPECT_EQ(openReader(path, {})->announcedTriangles(), 17u);
}

TEST(StlReader, CountsAttributesAndBytesBehindTheEnd) {
    const TempFolder folder;
    const auto sink = readAll(folder.write("a.stl", binaryStl(3, 3, "", 0x7FFF) + "tail"));
    EXPECT_EQ(sink.triangles.size(), 3u);
    EXPECT_EQ(sink.ignoredThings.at("attribute (colour) of a facet"), 3u);
    EXPECT_EQ(sink.ignoredThings.at("bytes behind the last facet"), 4u);
}

TEST(StlReader, TakesTheCountFromTheSizeWhereTheWriterLeftItOpen) {
    const TempFolder folder;
    for (const uint32_t announced : {0u, UINT32_MAX}) {
        const auto sink = readAll(folder.write("a.stl", binaryStl(announced, 4)));
        EXPECT_EQ(sink.triangles.size(), 4u);
        EXPECT_EQ(sink.ignoredThings.at("wrong number of facets in the header"), 1u);
    }
}

TEST(StlReader, RefusesABinaryFileThatIsCutShort) {
    const TempFolder folder;
    const auto path = folder.write("a.stl", binaryStl(2000000000, 4));
    try {
        (void)openReader(path, {});
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.path(), path.string());
        EXPECT_EQ(error.place(), "byte 284");
    }
}

TEST(StlReader, MakesEachSolidOfATextAnObject) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.stl",
        "solid first part\r\nFACET NORMAL 0 0 1\r\n outer loop\r\n vertex 0 0 0\r\n"
        " vertex +1.5e0 0 0\r\n vertex 0 1 0\r\n endloop\r\nendfacet\r\nendsolid first part\r\n"
        "solid empty\nendsolid\n"
        "Solid\n facet normal -nan(ind) 1.#QNAN 0 outer loop vertex 0 0 5 vertex 1 0 5 vertex 0 1 "
        "5 "
        "endloop endfacet endsolid"));
    ASSERT_EQ(sink.objects.size(), 3u);
    EXPECT_EQ(sink.objects[0].name, "first part");
    EXPECT_EQ(sink.objects[2].name, "");
    ASSERT_EQ(sink.triangles.size(), 2u);
    EXPECT_EQ(sink.triangles[0].object, 0u);
    EXPECT_EQ(sink.triangles[0].corner[1], Vec3d(1.5, 0, 0));
    EXPECT_EQ(sink.triangles[1].object, 2u);
    EXPECT_TRUE(sink.ignoredThings.empty());
}

TEST(StlReader, DropsFacetsThatAreNoTrianglesAndCutsThoseOfMoreCorners) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n"
        "endloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex nan 0 0\nvertex 1 1 0\n"
        "endloop\nendfacet\nendsolid\n"));
    EXPECT_EQ(sink.triangles.size(), 2u);
    EXPECT_EQ(sink.drops.at(DropReason::TooFewCorners), 1u);
    EXPECT_EQ(sink.drops.at(DropReason::NonFinite), 1u);
}

TEST(StlReader, NamesTheLineOfAVertexThatIsNone) {
    const TempFolder folder;
    const auto path =
        folder.write("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 x 0\n");
    try {
        (void)readAll(path);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.place(), "line 4");
    }
}

}  // namespace
}  // namespace pagoda::ooc::test
