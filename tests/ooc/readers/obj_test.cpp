#include "ooc/base/error.h"
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/test_files.h"

namespace pagoda::ooc::test {
namespace {

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReader, TakesCornersInEveryFormAndNormalsWhereTheyAreNamed) {
    const TempFolder folder;
    const auto sink = readAll(
        folder.write("a.obj", std::string(kSquare) +
                                  "vt 0 0\nvn 0 0 2\nvn 0 3 4\n"
                                  "f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//2\n"
                                  "f 1/1/1 2/1/1 3/1/2\nf 1// 2// 3//\nf -4//-2 -3//-2 -2//-1\n"));
    ASSERT_EQ(sink.triangles.size(), 6u);
    for (const CollectedTriangle& t : sink.triangles) EXPECT_EQ(t.corner[2], Vec3d(1, 1, 0));
    for (const size_t k : {2u, 3u, 5u})
        EXPECT_EQ(sink.triangles[k].normal[2], Vec3f(0, 0.6f, 0.8f));
    for (const size_t k : {0u, 1u, 4u}) EXPECT_EQ(sink.triangles[k].normal[2], Vec3f(0, 0, 1));
    EXPECT_TRUE(sink.ignoredThings.empty());
}

TEST(ObjReader, CountsNegativeIndicesBackFromTheirLine) {
    const TempFolder folder;
    const auto sink = readAll(folder.write("a.obj",
                                           "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n"
                                           "v 0 0 5\nv 1 0 5\nv 0 1 5\nf -3 -2 -1\nf 1 2 3\n"));
    ASSERT_EQ(sink.triangles.size(), 3u);
    EXPECT_EQ(sink.triangles[0].corner[0].z, 0.0);
    EXPECT_EQ(sink.triangles[1].corner[0].z, 5.0);
    EXPECT_EQ(sink.triangles[2].corner[0].z, 0.0);
}

TEST(ObjReader, DropsCornersThatNameNothing) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.obj", "f 1 2 3\n" + std::string(kSquare) +
                     "f 0 1 2\nf 1 2 5\nf -5 1 2\nf 1 2\nf\nf one 2 3\nf 1 2 3 4 9\n"
                     "f 1 2 99999999999999999999999999\nv 1 x 0\nv 2 2\nf 1 2 6\nf 1 2 3\n"
                     "f 1//9 2//9 3//9\n"));
    // Of the five corners one is bad: two of three triangles of the fan are sound.
    EXPECT_EQ(sink.triangles.size(), 4u);
    EXPECT_EQ(sink.drops.at(DropReason::IndexOutOfRange), 7u);
    EXPECT_EQ(sink.drops.at(DropReason::TooFewCorners), 2u);
    EXPECT_EQ(sink.drops.at(DropReason::NonFinite), 1u);
    EXPECT_EQ(sink.ignoredThings.at("vertex with a coordinate that is no number"), 2u);
    EXPECT_EQ(sink.ignoredThings.at("normal that does not exist"), 3u);
}

TEST(ObjReader, MakesObjectsOfNamesAndComesBackToThem) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.obj", std::string(kSquare) + "f 1 2 3\no my house\nf 1 2 3\ng north wall\nf 1 2 3\n"
                                        "g roof\nf 1 2 3\no tree\nf 1 2 3\no my house\ng roof\n"
                                        "f 1 2 4\ng unused\n"));
    ASSERT_EQ(sink.triangles.size(), 6u);
    ASSERT_EQ(sink.objects.size(), 5u);
    const auto objectOf = [&](size_t t) { return sink.objects[sink.triangles[t].object]; };
    EXPECT_EQ(objectOf(0).name, "");
    EXPECT_EQ(objectOf(1).name, "my house");
    EXPECT_EQ(objectOf(2).name, "north wall");
    EXPECT_EQ(objectOf(2).parent, sink.triangles[1].object);
    EXPECT_EQ(objectOf(4).name, "tree");
    EXPECT_EQ(objectOf(4).parent, ObjectInfo::kNoParent);
    EXPECT_EQ(sink.triangles[5].object, sink.triangles[3].object);
}

TEST(ObjReader, ReadsMaterialsWithSpacesInNamesAndCountsWhatIsMissing) {
    const TempFolder folder;
    folder.write(
        "sub/my materials.mtl",
        "newmtl dark  red \nKd 0.5 0 0\nmap_Kd brick.png\n\nnewmtl glass\nKd 0 1 1\nd 0.25\n"
        "newmtl tr\nTr 0.75\nnewmtl gone\nd 0\nTr 1\nnewmtl both\nd 1\nTr 0.5\n");
    const auto sink = readAll(folder.write(
        "a.obj", std::string(kSquare) +
                     "usemtl dark  red\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl tr\nf 1 2 3\n"
                     "usemtl gone\nf 1 2 3\nusemtl both\nf 1 2 3\nusemtl nowhere\nf 1 2 3\n"
                     "mtllib sub\\my materials.mtl\r\nmtllib lost.mtl\n"));
    ASSERT_EQ(sink.triangles.size(), 6u);
    const auto materialOf = [&](size_t t) { return sink.materials[sink.triangles[t].material]; };
    EXPECT_EQ(materialOf(0).name, "dark  red");
    EXPECT_EQ(materialOf(0).colour, 0xFF000080u);
    EXPECT_EQ(materialOf(1).colour, 0x40FFFF00u);
    EXPECT_TRUE(materialOf(1).isTranslucent);
    EXPECT_EQ(materialOf(2).colour >> 24, 0x40u);
    EXPECT_FALSE(materialOf(3).isTranslucent);
    EXPECT_FALSE(materialOf(4).isTranslucent);
    EXPECT_EQ(materialOf(5).name, "nowhere");
    EXPECT_EQ(sink.ignoredThings.at("missing material library"), 1u);
    EXPECT_EQ(sink.ignoredThings.at("material without a definition"), 1u);
    EXPECT_EQ(sink.ignoredThings.at("texture of a material"), 1u);
    EXPECT_EQ(sink.ignoredThings.at("full transparency of a material"), 1u);
}

TEST(ObjReader, MultipliesVertexColoursByTheMaterial) {
    const TempFolder folder;
    folder.write("a.mtl", "newmtl half\nKd 0.5 1 1\n");
    const auto sink = readAll(folder.write("a.obj",
                                           "mtllib a.mtl\nv 0 0 0\nv 1 0 0 1 0.5 0\n"
                                           "v 0 1 0 255 0 51\nv 2 2 2 nan 0 0\nv 3 3 3 1.0\n"
                                           "f 1 2 3\nusemtl half\nf 1 2 4\nf 1 2 5\n"));
    ASSERT_EQ(sink.triangles.size(), 3u);
    EXPECT_EQ(sink.triangles[0].colour[0], 0xFFFFFFFFu);
    EXPECT_EQ(sink.triangles[0].colour[1], 0xFF0080FFu);
    EXPECT_EQ(sink.triangles[0].colour[2], 0xFF3300FFu);
    EXPECT_EQ(sink.triangles[1].colour[1], 0xFF008080u);
    EXPECT_EQ(sink.triangles[1].colour[2], 0xFFFFFF80u);
    EXPECT_EQ(sink.triangles[2].colour[2], 0xFFFFFF80u);
}

TEST(ObjReader, ReadsTextHoweverItIsEncodedAndItsLinesEnd) {
    const TempFolder folder;
    const std::string text =
        "# test\no K\xC3\xB6rper \xF0\x9F\x8F\xAF\nv\t0  0 0 # a comment\nv 1 0 0\nv 1 \\\n 1 0\n"
        "v 0 1 0\n\n  f 1 2 \\\n\\\n 3  4  \nf 1 2 3";
    const std::u16string wide =
        u"# test\no K\u00F6rper \U0001F3EF\nv\t0  0 0 # a comment\nv 1 0 0\nv 1 \\\n 1 0\n"
        u"v 0 1 0\n\n  f 1 2 \\\n\\\n 3  4  \nf 1 2 3";
    std::string little = "\xFF\xFE", big = "\xFE\xFF", carriage, windows;
    for (const char16_t unit : wide) {
        little += bytesOf(static_cast<uint16_t>(unit));
        big += bytesOf(static_cast<uint16_t>(unit), true);
    }
    for (const char c : text) {
        carriage += c == '\n' ? '\r' : c;
        windows += c == '\n' ? "\r\n" : std::string(1, c);
    }
    for (const std::string& file : {text, little, big, carriage, windows, "\xEF\xBB\xBF" + text}) {
        const auto sink = readAll(folder.write("a.obj", file));
        ASSERT_EQ(sink.triangles.size(), 3u);
        EXPECT_EQ(sink.objects[0].name, "K\xC3\xB6rper \xF0\x9F\x8F\xAF");
        EXPECT_DOUBLE_EQ(sink.area(), 1.5);
        EXPECT_TRUE(sink.ignoredThings.empty());
    }
}

TEST(ObjReader, ReadsNumbersHoweverTheyAreWritten) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.obj",
        "v 1. +.5 -2.5e+1\nv 1E2 0.1234567890123456789 12345678901234567890\nv -0 007 1e-400\n"
        "f 1 2 3\n"));
    ASSERT_EQ(sink.triangles.size(), 1u);
    EXPECT_EQ(sink.triangles[0].corner[0], Vec3d(1, 0.5, -25));
    EXPECT_EQ(sink.triangles[0].corner[1],
              Vec3d(100, 0.1234567890123456789, 12345678901234567890.0));
    EXPECT_EQ(sink.triangles[0].corner[2], Vec3d(0, 7, 0));
}

TEST(ObjReader, GivesCoordinatesTheBitsOfStrtod) {
    const TempFolder folder;
    std::string text;
    std::vector<double> truth;
    uint64_t seed = 1;
    for (int k = 0; k < 3000; ++k) {
        seed = seed * 6364136223846793005ull + 1442695040888963407ull;
        char number[64];
        std::snprintf(number, sizeof number,
                      k % 3 == 0   ? "%.6f"
                      : k % 3 == 1 ? "%.17g"
                                   : "%.9e",
                      static_cast<double>(static_cast<int64_t>(seed)) / 1e13);
        truth.push_back(std::strtod(number, nullptr));
        text += (k % 3 == 0 ? "v " : " ") + std::string(number) + (k % 3 == 2 ? "\n" : "");
        if (k % 9 == 8) text += "f -3 -2 -1\n";
    }
    const auto sink = readAll(folder.write("a.obj", text));
    ASSERT_EQ(sink.triangles.size(), 333u);
    for (size_t t = 0; t < 333; ++t) {
        for (size_t k = 0; k < 9; ++k) {
            const Vec3d& corner = sink.triangles[t].corner[k / 3];
            ASSERT_EQ(corner[static_cast<int>(k % 3)], truth[9 * t + k]) << 9 * t + k;
        }
    }
}

TEST(ObjReader, CountsWhatItDoesNotDraw) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.obj", std::string(kSquare) + "l 1 2\nl 2 3\np 1\ncurv 0 1 1 2\nvp 0 0\nwhatever\ns off\n"
                                        "vt 0 0\nfo 1 2 3\n"));
    EXPECT_EQ(sink.triangles.size(), 1u);
    EXPECT_EQ(sink.ignoredThings.at("lines (l)"), 2u);
    EXPECT_EQ(sink.ignoredThings.at("points (p)"), 1u);
    EXPECT_EQ(sink.ignoredThings.at("free-form curves and surfaces"), 2u);
    EXPECT_EQ(sink.ignoredThings.at("text lines with an unknown keyword"), 1u);
}

TEST(ObjReader, CutsALongFaceAsAFanAndSaysSo) {
    const TempFolder folder;
    std::string text = kSquare;
    text += "f";
    for (int k = 0; k < 5000; ++k) text += k % 100 == 99 ? " \\\n1" : " 2";
    const auto sink = readAll(folder.write("a.obj", text));
    EXPECT_EQ(sink.triangleCount(), 4998u);
    EXPECT_EQ(sink.ignoredThings.size(), 1u);
}

}  // namespace
}  // namespace pagoda::ooc::test
