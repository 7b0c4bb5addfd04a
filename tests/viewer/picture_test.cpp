// Files of pictures, read back the way docs/frame.md tells a script to.
#include "viewer/picture.h"

#include "ooc/base/error.h"

#include <gtest/gtest.h>
#include <png.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

namespace pagoda::viewer {
namespace {

class PictureTest : public ::testing::Test {
protected:
    PictureTest() {
        std::filesystem::create_directories(folder_);
        picture_.widthPx = 3;
        picture_.heightPx = 2;
        for (uint8_t i = 0; i < 24; ++i) picture_.colours.push_back(static_cast<uint8_t>(10 * i));
        picture_.depthsModelUnits = {1, 2, 3, 4, 5, std::numeric_limits<float>::infinity()};
        picture_.nodeOrdinals = {1, 1, 2, 2, 2, 0};
        picture_.triangles = {10, 11, 12, 13, 14, 0};
        picture_.nodes = {ooc::NodeId{0x123456789ABCDEF0ull}, ooc::NodeId{16}};
    }
    ~PictureTest() override { std::filesystem::remove_all(folder_); }

    static std::string bytes(const std::filesystem::path& path) {
        std::ifstream in(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() /
        ("pagoda_picture_" +
         std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    Picture picture_;
};

TEST_F(PictureTest, PngHoldsTheColoursFromTopToBottom) {
    writePng(picture_, folder_ / "a.png");
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_file(&image, (folder_ / "a.png").c_str()), 0);
    EXPECT_EQ(image.width, 3u);
    EXPECT_EQ(image.height, 2u);
    image.format = PNG_FORMAT_RGB;
    std::vector<uint8_t> rgb(18);
    ASSERT_NE(png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr), 0);
    for (size_t i = 0; i < 18; ++i) EXPECT_EQ(rgb[i], picture_.colours[i / 3 * 4 + i % 3]);
}

TEST_F(PictureTest, DepthIsAPfmFromBottomToTop) {
    writeDepth(picture_, folder_ / "d.pfm");
    const std::string content = bytes(folder_ / "d.pfm");
    const std::string header = "Pf\n3 2\n-1.0\n";
    ASSERT_EQ(content.size(), header.size() + 24);
    EXPECT_EQ(content.substr(0, header.size()), header);
    float values[6];
    std::memcpy(values, content.data() + header.size(), 24);
    EXPECT_EQ(values[0], 4.0f);
    EXPECT_EQ(values[2], std::numeric_limits<float>::infinity());
    EXPECT_EQ(values[3], 1.0f);
}

TEST_F(PictureTest, IdsArePairsWithATableOfNodesBeside) {
    writeIds(picture_, folder_ / "i.ids");
    const std::string content = bytes(folder_ / "i.ids");
    ASSERT_EQ(content.size(), 48u);
    uint32_t pairs[12];
    std::memcpy(pairs, content.data(), 48);
    EXPECT_EQ(pairs[4], 2u);
    EXPECT_EQ(pairs[5], 12u);
    const auto table = nlohmann::json::parse(bytes(folder_ / "i.ids.json"));
    EXPECT_EQ(table["width"], 3);
    EXPECT_EQ(table["height"], 2);
    EXPECT_EQ(table["nodes"][0], "0x123456789abcdef0");
}

TEST_F(PictureTest, SaysWhichFileCannotBeWritten) {
    try {
        writePng(picture_, folder_ / "missing" / "a.png");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(error.path().find("missing"), std::string::npos);
    }
    EXPECT_THROW(writeDepth(picture_, "/dev/full"), Error);
    EXPECT_THROW(writePng(picture_, "/dev/full"), Error);
}

TEST_F(PictureTest, CountsPixelsThatAnythingCovers) {
    picture_.colours[3] = 0;
    EXPECT_EQ(picture_.coveredPixels(), 5u);
}

}  // namespace
}  // namespace pagoda::viewer
