#include "ooc/base/error.h"
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/test_files.h"

namespace pagoda::ooc::test {
namespace {

TEST(OffReader, ReadsCountsOnTheFirstLineCommentsAndBlankLines) {
    const TempFolder folder;
    for (const char* start : {"OFF\n# made by hand\n\n4 1 0\n", "OFF 4 1 0 # counts\n",
                              "OFF4 1 0\n", "4 1 0\n", "\xEF\xBB\xBFOFF\r\n4 1 0\r\n"}) {
        const auto sink = readAll(folder.write(
            "a.off", std::string(start) + "0 0 0\n1 0 0 # corner\n\n1 1 0\n0 1 0\n4 0 1 2 3\n"));
        EXPECT_EQ(sink.triangles.size(), 2u) << start;
        EXPECT_DOUBLE_EQ(sink.area(), 1.0);
        EXPECT_EQ(sink.triangles[0].colour[0], 0xFFFFFFFFu);
    }
}

TEST(OffReader, ReadsColoursOfVerticesAndNormals) {
    const TempFolder folder;
    const auto sink = readAll(folder.write("a.off",
                                           "CNOFF\n3 1 0\n0 0 0 0 0 -2 255 0 0 255\n"
                                           "1 0 0 0 0 -2 0 255 0\n0 1 0 0 0 -2 0.0 0.0 1.0 0.5\n"
                                           "3 0 1 2\n"));
    ASSERT_EQ(sink.triangles.size(), 1u);
    EXPECT_EQ(sink.triangles[0].colour[0], 0xFF0000FFu);
    EXPECT_EQ(sink.triangles[0].colour[1], 0xFF00FF00u);
    EXPECT_EQ(sink.triangles[0].colour[2], 0x80FF0000u);
    EXPECT_EQ(sink.triangles[0].normal[0], Vec3f(0, 0, -1));
    EXPECT_TRUE(sink.materials[sink.triangles[0].material].isTranslucent);
}

TEST(OffReader, ReadsColoursOfFaces) {
    const TempFolder folder;
    const auto sink = readAll(folder.write("a.off",
                                           "OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n"
                                           "3 0 1 2 1.0 0.0 0.0\n3 0 1 2 0 0 255 255\n3 0 1 2\n"));
    ASSERT_EQ(sink.triangles.size(), 3u);
    EXPECT_EQ(sink.triangles[0].colour[2], 0xFF0000FFu);
    EXPECT_EQ(sink.triangles[1].colour[0], 0xFFFF0000u);
    EXPECT_EQ(sink.triangles[2].colour[0], 0xFFFFFFFFu);
}

TEST(OffReader, DropsWhatIsBadAlone) {
    const TempFolder folder;
    const auto sink = readAll(folder.write("a.off",
                                           "OFF\n4 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 inf\n"
                                           "3 0 1 2\n3 0 1 4\n3 0 -1 2\n2 0 1\n4 0 1 2 3\n"));
    EXPECT_EQ(sink.triangles.size(), 2u);  // and the half of the last that is sound
    EXPECT_EQ(sink.drops.at(DropReason::IndexOutOfRange), 2u);
    EXPECT_EQ(sink.drops.at(DropReason::TooFewCorners), 1u);
    EXPECT_EQ(sink.drops.at(DropReason::NonFinite), 1u);
}

TEST(OffReader, RefusesWhatItCannotRead) {
    const TempFolder folder;
    for (const char* text :
         {"", "4OFF\n1 1 0\n", "OFF BINARY\n", "OFF\nmany few\n",
          "OFF\n1152921504606846976 1152921504606846976 0\n0 0 0\n", "OFF\n3 1 0\n0 0 0\n1 0 0\n",
          "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "OFF\n3 1 0\n0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n",
          "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2147483647 0 1 2\n"}) {
        const auto path = folder.write("a.off", text);
        try {
            (void)readAll(path);
            FAIL() << "no error: " << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.path(), path.string());
            EXPECT_EQ(error.place().substr(0, 5), "line ") << error.what();
        }
    }
}

}  // namespace
}  // namespace pagoda::ooc::test
