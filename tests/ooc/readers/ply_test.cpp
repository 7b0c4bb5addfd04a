#include "ooc/base/error.h"
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/test_files.h"

namespace pagoda::ooc::test {
namespace {

constexpr const char* kTriangleHeader =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST(PlyReader, ReadsEveryTypeOfPositionAndIndexInBothByteOrders) {
    struct Type {
        const char *name, *alias;
        std::string (*bytes)(int, bool);
    };
    const auto as = []<typename T>(T) {
        return +[](int value, bool big) { return bytesOf(static_cast<T>(value), big); };
    };
    const std::vector<Type> types = {
        {"char", "int8", as(int8_t{})},    {"uchar", "uint8", as(uint8_t{})},
        {"short", "int16", as(int16_t{})}, {"ushort", "uint16", as(uint16_t{})},
        {"int", "int32", as(int32_t{})},   {"uint", "uint32", as(uint32_t{})},
        {"float", "float32", as(float{})}, {"double", "float64", as(double{})}};
    const TempFolder folder;
    for (const bool big : {false, true}) {
        for (const Type& position : types) {
            for (size_t index = 0; index < 6; ++index) {  // whole numbers only
                std::string file = "ply\nformat binary_";
                file += big ? "big" : "little";
                file += "_endian 1.0\nelement vertex 4\n";
                file += std::string("property ") + position.name + " x\nproperty " +
                        position.alias + " y\nproperty " + position.name + " z\n";
                file += std::string("element face 2\nproperty list ") + types[index].name + " " +
                        types[index].alias + " vertex_index\nend_header\n";
                const int corners[4][3] = {{0, 0, 7}, {100, 0, 7}, {100, 50, 7}, {0, 50, 7}};
                for (const auto& corner : corners) {
                    for (const int value : corner) file += position.bytes(value, big);
                }
                for (const int value : {4, 0, 1, 2, 3, 3, 3, 1, 0}) {
                    file += types[index].bytes(value, big);
                }
                const auto sink = readAll(folder.write("a.ply", file));
                ASSERT_EQ(sink.triangles.size(), 3u) << position.name << types[index].name << big;
                EXPECT_DOUBLE_EQ(sink.area(), 7500.0);
                EXPECT_EQ(sink.triangles[2].corner[0], Vec3d(0, 50, 7));
            }
        }
    }
}

TEST(PlyReader, KeepsDoublePositionsToTheLastBit) {
    const TempFolder folder;
    std::string file =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\n"
        "property double y\nproperty double z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n";
    const double x = 2683012.123456789;
    for (const double value : {x, 0., 0., 1., x, 0., 0., 1., x}) file += bytesOf(value);
    file += '\3' + bytesOf(0) + bytesOf(1) + bytesOf(2);
    const auto sink = readAll(folder.write("a.ply", file));
    ASSERT_EQ(sink.triangles.size(), 1u);
    EXPECT_EQ(sink.triangles[0].corner[0].x, x);
    EXPECT_EQ(sink.triangles[0].corner[2].z, x);
}

TEST(PlyReader, TextGivesTheSameAsBinary) {
    const TempFolder folder;
    const std::string head = std::string(" 1.0\n") + kTriangleHeader;
    const auto text = readAll(folder.write(
        "a.ply", "ply\r\nformat ascii" + head + " 0.1 +2e-3 -3\n0 1 0\n\n0 0 1e10\n3 0 1 2\n"));
    std::string file = "ply\nformat binary_little_endian" + head;
    for (const float v : {0.1f, 2e-3f, -3.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1e10f}) file += bytesOf(v);
    file += '\3' + bytesOf(0) + bytesOf(1) + bytesOf(2);
    const auto binary = readAll(folder.write("b.ply", file));
    EXPECT_EQ(text.triangles, binary.triangles);
    ASSERT_EQ(text.triangles.size(), 1u);
}

TEST(PlyReader, TakesHeadersThatEndLinesInAnyWay) {
    const TempFolder folder;
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string header = std::string("ply\nformat binary_little_endian 1.0\n") +
                             "comment made \xff by hand\n\nobj_info num_cols 512\n" +
                             kTriangleHeader;
        std::string file;
        for (const char c : header) file += c == '\n' ? end : std::string(1, c);
        // The first byte of the data looks like an end of line.
        float first = 0;
        std::memcpy(&first, "\n\r\n\x40", 4);
        for (const float v : {first, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) file += bytesOf(v);
        file += '\3' + bytesOf(0) + bytesOf(1) + bytesOf(2);
        const auto sink = readAll(folder.write("a.ply", file));
        ASSERT_EQ(sink.triangles.size(), 1u);
        EXPECT_EQ(sink.triangles[0].corner[0].x, static_cast<double>(first));
    }
}

TEST(PlyReader, ReadsColoursOfEveryKindOfNameAndType) {
    struct Case {
        const char *properties, *values;
        uint32_t colour;
    };
    const TempFolder folder;
    for (const Case& c :
         {Case{"uchar red/uchar green/uchar blue", "255 128 0", 0xFF0080FFu},
          Case{"uchar r/uchar g/uchar b/uchar a", "1 2 3 4", 0x04030201u},
          Case{"float diffuse_red/float diffuse_green/float diffuse_blue", "1 0.5 0", 0xFF0080FFu},
          Case{"ushort blue/ushort green/ushort red", "0 32896 65535", 0xFF0080FFu},
          Case{"uchar Red/float GREEN/ushort blue", "255 nan 257", 0xFF0100FFu},
          Case{"uchar red/uchar green/uchar blue/uchar alpha", "9 9 9 0", 0xFF090909u},
          Case{"uchar red/uchar green", "9 9", 0xFFFFFFFFu}}) {
        std::string file =
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nproperty ";
        for (const char* p = c.properties; *p != '\0'; ++p) {
            file += *p == '/' ? "\nproperty " : std::string(1, *p);
        }
        file += "\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
        for (const char* xyz : {"0 0 0 ", "1 0 0 ", "0 1 0 "})
            file += std::string(xyz) + c.values + "\n";
        const auto sink = readAll(folder.write("a.ply", file + "3 0 1 2\n"));
        ASSERT_EQ(sink.triangles.size(), 1u);
        EXPECT_EQ(sink.triangles[0].colour[1], c.colour) << c.properties;
        EXPECT_EQ(sink.materials[sink.triangles[0].material].isTranslucent, c.colour >> 24 != 255u);
    }
}

TEST(PlyReader, ReadsColoursOfFacesAndNormalsOfVertices) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float nx\nproperty float ny\n"
        "property float nz\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty uchar red\nproperty list uchar int vertex_indices\n"
        "property uchar green\nproperty uchar blue\nend_header\n"
        "0 0 5 0 0 0\n0 0 1 1 0 0\n0 0 0 0 1 0\n3 0 4 0 0 1\n"
        "1 3 0 1 2 2 3\n255 3 0 1 3 0 0\n"));
    ASSERT_EQ(sink.triangles.size(), 2u);
    EXPECT_EQ(sink.triangles[0].colour[0], 0xFF030201u);
    EXPECT_EQ(sink.triangles[1].colour[2], 0xFF0000FFu);
    EXPECT_EQ(sink.triangles[0].normal[0], Vec3f(0, 0, 1));
    EXPECT_EQ(sink.triangles[0].normal[2], Vec3f(0, 0, 1));  // the face's, where there is none
    EXPECT_EQ(sink.triangles[1].normal[2], Vec3f(0.6f, 0, 0.8f));
}

TEST(PlyReader, CutsStripsAtEachMinusOneAndTurnsEverySecondTriangle) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
        "property float z\nelement tristrips 2\nproperty list int int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n"
        "11 0 1 2 3 4 -1 0 1 -1 2 3\n5 -1 2 3 4 5\n"));
    ASSERT_EQ(sink.triangles.size(), 5u);
    for (const CollectedTriangle& t : sink.triangles) {
        EXPECT_GT(glm::cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]).z, 0.0);
    }
}

TEST(PlyReader, FindsVerticesBehindFacesAndSkipsWhatItDoesNotKnow) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement camera 1\nproperty list int float pose\n"
        "element face 1\nproperty list uchar float weights\nproperty list uchar int "
        "vertex_indices\n"
        "element nothing 1152921504606846976\n"
        "element vertex 3\nproperty list uchar int tags\nproperty float x\nproperty float y\n"
        "property float z\nelement edge 1\nproperty int a\nproperty int b\nend_header\n"
        "2 0.5 0.5\n1 0.25 3 0 1 2\n0 0 0 0\n2 8 9 1 0 0\n1 7 0 1 0\n0 1\n"));
    EXPECT_EQ(sink.triangles.size(), 1u);
    EXPECT_DOUBLE_EQ(sink.area(), 0.5);
}

TEST(PlyReader, StreamsFacesLongerThanItsBlocks) {
    const TempFolder folder;
    constexpr int kCorners = 400000;  // 1.6 MB in one list
    std::string file =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nelement face 3\n"
        "property list int int vertex_indices\nend_header\n";
    for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) file += bytesOf(v);
    const std::string triangle = bytesOf(3) + bytesOf(0) + bytesOf(1) + bytesOf(2);
    file += triangle + bytesOf(kCorners);
    for (int k = 0; k < kCorners; ++k) file += bytesOf(k % 3);
    const auto sink = readAll(folder.write("a.ply", file + triangle));
    EXPECT_EQ(sink.triangles.size(), static_cast<size_t>(kCorners - 2 + 2));
    EXPECT_EQ(sink.triangles.back().corner[1], Vec3d(1, 0, 0));
    EXPECT_EQ(sink.ignoredThings.size(), 1u);
}

TEST(PlyReader, DropsWhatIsBadAlone) {
    const TempFolder folder;
    const auto sink = readAll(folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
        "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\nnan 0 0\n"
        "3 0 1 2\n3 0 1 5\n3 0 1 -7\n3 0 1 4\n2 0 1\n4 0 1 2 9\n"));
    EXPECT_EQ(sink.triangles.size(), 2u);
    EXPECT_EQ(sink.drops.at(DropReason::IndexOutOfRange), 3u);
    EXPECT_EQ(sink.drops.at(DropReason::NonFinite), 1u);
    EXPECT_EQ(sink.drops.at(DropReason::TooFewCorners), 1u);
}

TEST(PlyReader, RefusesHeadersThatLie) {
    const TempFolder folder;
    const std::string ascii = "ply\nformat ascii 1.0\n",
                      binary = "ply\nformat binary_little_endian 1.0\n";
    const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
    const std::string face = "property list uchar int vertex_indices\nend_header\n";
    const std::string huge = "1152921504606846976";
    const std::string three(36, '\0');
    for (const std::string& text :
         {std::string(), std::string("ply"), std::string("plyformat\n"), ascii,
          ascii + "end_header", ascii + "element vertex -1\n" + xyz + "end_header\n",
          ascii + "element vertex 99999999999999999999999\n" + xyz + "end_header\n",
          binary + "element vertex " + huge + "\n" + xyz + "end_header\n" + three,
          ascii + "element vertex " + huge + "\n" + xyz + "end_header\n0 0 0\n",
          binary + "element vertex 3\n" + xyz + "element face " + huge + "\n" + face + three,
          binary + "element vertex 3\n" + xyz + "element face 1\n" + face + three,
          binary + "element vertex 3\n" + xyz +
              "element face 1\nproperty list uint int vertex_indices\nend_header\n" + three +
              "\xff\xff\xff\x7f",
          binary + "element vertex 3\n" + xyz +
              "element face 1\nproperty list int int vertex_indices\nend_header\n" + three +
              "\xff\xff\xff\xff",
          binary + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
              std::string(1, '\0'),
          ascii + "element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
          ascii + "element vertex 3\n" + xyz + "element face 1\n" + face +
              "0 0 0\n0 0 x\n0 0 0\n3 0 1 2\n",
          ascii + "element vertex 3\n" + xyz + "element face 1\n" + face +
              "0 0 0\n0 0 0\n0 0 0\n3 0 1 2.5\n",
          ascii + "element vertex 3\n" + xyz + "element face 1\n" + face +
              "0 0 0\n0 0 0\n0 0 0\n2147483647 0\n"}) {
        const auto path = folder.write("a.ply", text);
        try {
            (void)readAll(path);
            FAIL() << "no error: " << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.path(), path.string());
            EXPECT_TRUE(error.place().starts_with("line ") || error.place().starts_with("byte "))
                << error.what();
        }
    }
}

TEST(PlyReader, ReadsBeyondFourGibibytes) {
    // A sparse file: zeros for 4.5 GiB of an element that is skipped, then the model.
    const TempFolder folder;
    constexpr uint64_t kSkipped = (uint64_t{9} << 29) / 8;
    std::string header = "ply\nformat binary_little_endian 1.0\nelement padding " +
                         std::to_string(kSkipped) + "\nproperty double nothing\n" + kTriangleHeader;
    const auto path = folder.write("a.ply", header);
    std::string tail;
    for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) tail += bytesOf(v);
    tail += '\3' + bytesOf(0) + bytesOf(1) + bytesOf(2);
    std::error_code code;
    std::filesystem::resize_file(path, header.size() + kSkipped * 8, code);
    if (code) GTEST_SKIP() << "SKIPPED: no sparse files here: " << code.message();
    std::ofstream(path, std::ios::binary | std::ios::app) << tail;
    const auto sink = readAll(path);
    EXPECT_EQ(sink.triangles.size(), 1u);
    EXPECT_DOUBLE_EQ(sink.area(), 0.5);
}

}  // namespace
}  // namespace pagoda::ooc::test
