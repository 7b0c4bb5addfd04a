#include "ooc/base/error.h"
#include "ooc/readers/drc_reader.h"
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/test_files.h"

#include <nlohmann/json.hpp>

#include <fstream>

namespace pagoda::ooc::test {
namespace {

TEST(DrcReader, EveryFileGivesTheTrianglesThatDracoDecoderCounted) {
    PAGODA_REQUIRE_TEST_DATA();
    const auto stats = nlohmann::json::parse(std::ifstream(testData() / "stats.json"));
    size_t files = 0;
    for (const auto& [name, counts] : stats.items()) {
        if (!name.ends_with(".drc") || name.starts_with("malformed/")) continue;
        SCOPED_TRACE(name);
        ++files;
        const auto reader = openReader(testData() / name, {});
        CollectingSink first, second;
        reader->read(first);
        reader->read(second);
        EXPECT_EQ(first.triangleCount(), counts["tris"].get<uint64_t>());
        EXPECT_EQ(reader->announcedTriangles(), counts["tris"].get<uint64_t>());
        EXPECT_EQ(first.triangles, second.triangles);
        if (first.triangles.empty()) {
            EXPECT_EQ(first.ignoredThings.count("point cloud (no triangles)"), 1u);
        }
    }
    EXPECT_GT(files, 20u);
}

// The same mesh in old and new bitstreams, by both encoders.
TEST(DrcReader, AllBitstreamVersionsHoldOneShape) {
    PAGODA_REQUIRE_TEST_DATA();
    const auto folder = testData() / "zoo/drc";
    const CollectingSink expected = readAll(folder / "test_nm.obj.sequential.1.1.0.drc");
    ASSERT_EQ(expected.triangles.size(), 170u);
    const double size = glm::distance(expected.box().min, expected.box().max);
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("test_nm.obj.")) continue;
        const CollectingSink sink = readAll(entry.path());
        // Quantised to 10 bits and more.
        EXPECT_LT(glm::distance(sink.box().min, expected.box().min), 2e-3 * size) << name;
        EXPECT_LT(glm::distance(sink.box().max, expected.box().max), 2e-3 * size) << name;
        EXPECT_NEAR(sink.area() / expected.area(), 1, 1e-2) << name;
    }
}

TEST(DrcReader, TheBunnyHasTheSizeOfTheScannedBunny) {
    PAGODA_REQUIRE_TEST_DATA();
    const CollectingSink sink = readAll(testData() / "scan/bunny.drc");
    EXPECT_EQ(sink.triangles.size(), 69451u);
    // The Stanford bunny, in metres: 0.156 x 0.154 x 0.121.
    const Vec3d extent = sink.box().max - sink.box().min;
    EXPECT_NEAR(extent.x, 0.1557, 1e-3);
    EXPECT_NEAR(extent.y, 0.1542, 1e-3);
    EXPECT_NEAR(extent.z, 0.1207, 1e-3);
}

TEST(DrcReader, TruncatedAndForeignFilesAreRefused) {
    PAGODA_REQUIRE_TEST_DATA();
    TempFolder folder;
    const std::string whole = contentsOf(testData() / "zoo/drc/cube_att.drc");
    for (size_t size = 0; size < whole.size(); ++size) {
        const auto path = folder.write("cut.drc", whole.substr(0, size));
        EXPECT_THROW(readAll(path), Error) << size << " bytes";
    }
    EXPECT_THROW(readAll(folder.write("text.drc", "not a Draco file at all")), Error);
}

TEST(DrcReader, WhatAHeaderPromisesIsWeighedBeforeItIsDecoded) {
    TempFolder folder;
    // Sequential mesh, bitstream 2.2: 2^32 - 1 faces and points.
    const std::string header("DRACO\x02\x02\x01\x00\x00\x00", 11);
    const std::string most("\xFF\xFF\xFF\xFF\x0F", 5);
    const auto path = folder.write("huge.drc", header + most + most + std::string(100, '\0'));
    try {
        (void)readAll(path);
        FAIL() << "was read";
    } catch (const Error& error) {
        EXPECT_NE(error.problem().find("memory"), std::string::npos) << error.what();
    }
    ReaderOptions few;
    few.maxTriangles = 1000;
    try {
        (void)openDrcReader(path, few);
        FAIL() << "was opened";
    } catch (const Error& error) {
        EXPECT_NE(error.problem().find("4294967295"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace pagoda::ooc::test
