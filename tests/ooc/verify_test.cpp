#include "ooc/store/verify.h"

#include "ooc/base/error.h"
#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>

namespace pagoda::ooc {
namespace {

using test::DatabaseOptions;
using test::TemporaryFolder;
using test::writeDatabase;

std::string list(const VerifyReport& report) {
    std::string text;
    for (const VerifyFault& fault : report.faults) text += fault.place + ": " + fault.what + "\n";
    return text;
}

class VerifyDatabase : public testing::Test {
protected:
    VerifyReport verify(size_t threadCount = 2) {
        return verifyDatabase(path_, threadCount, progress_);
    }
    [[nodiscard]] std::vector<char> read() const {
        std::ifstream in(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    // Calls `broken` with one bit flipped; the file is whole again afterwards.
    void flip(size_t byte, unsigned bit, const std::function<void(VerifyReport)>& broken) {
        const auto poke = [&](char value) {
            std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
            file.seekp(static_cast<std::streamoff>(byte));
            file.put(value);
        };
        const char good = read()[byte];
        poke(static_cast<char>(good ^ (1 << bit)));
        broken(verify(1));
        poke(good);
    }

    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path() / "a.pagoda";
    Progress progress_;
};

TEST_F(VerifyDatabase, FindsNothingInSoundDatabasesOfEveryCodec) {
    for (const Codec codec : {Codec::Raw, Codec::Meshopt, Codec::Draco}) {
        std::filesystem::remove(path_);
        const auto content =
            writeDatabase(path_, {.codec = codec, .depth = 4, .childrenPerNode = 6});
        const VerifyReport report = verify();
        EXPECT_TRUE(report.isSound()) << list(report);
        EXPECT_EQ(report.bytesChecked, std::filesystem::file_size(path_));
        EXPECT_EQ(report.nodesChecked, content.nodes.size());
        EXPECT_EQ(report.trianglesChecked, content.header.triangleCount);
    }
}

TEST_F(VerifyDatabase, FindsEveryFlippedBitOfATinyDatabaseAndCallsItOneFault) {
    (void)writeDatabase(path_, {.depth = 0, .leafTriangles = 1});
    for (size_t byte = 0; byte < std::filesystem::file_size(path_); ++byte) {
        for (unsigned bit = 0; bit < 8; ++bit) {
            flip(byte, bit, [&](const VerifyReport& report) {
                EXPECT_EQ(report.faultCount, 1u) << byte << ", bit " << bit << "\n" << list(report);
            });
        }
    }
}

TEST_F(VerifyDatabase, FindsAFlippedBitInEveryByteOfDatabasesOfEveryCodec) {
    for (const Codec codec : {Codec::Raw, Codec::Meshopt, Codec::Draco}) {
        std::filesystem::remove(path_);
        (void)writeDatabase(path_,
                            {.codec = codec, .depth = 1, .childrenPerNode = 2, .leafTriangles = 4});
        for (size_t byte = 0; byte < std::filesystem::file_size(path_); ++byte) {
            flip(byte, byte % 8, [&](const VerifyReport& report) {
                EXPECT_EQ(report.faultCount, 1u) << byte << "\n" << list(report);
            });
        }
    }
}

TEST_F(VerifyDatabase, FindsAFileOfAnyOtherLength) {
    (void)writeDatabase(path_, {.depth = 1, .childrenPerNode = 2});
    const auto whole = std::filesystem::file_size(path_);
    for (uintmax_t bytes = 0; bytes < whole; bytes += 37) {
        std::filesystem::resize_file(path_, bytes);
        EXPECT_FALSE(verify(1).isSound()) << bytes;
        std::filesystem::remove(path_);
        (void)writeDatabase(path_, {.depth = 1, .childrenPerNode = 2});
    }
    std::filesystem::resize_file(path_, whole + 1);
    EXPECT_FALSE(verify(1).isSound());
}

TEST_F(VerifyDatabase, ThrowsForAFileThatIsNotThere) {
    EXPECT_THROW((void)verify(), Error);
}

struct Lie {
    const char* name;
    std::function<void(DatabaseWriter::Content&)> spoil;
    const char* expected;  // part of the first fault
};

// Each of these has sound checksums: only the structure gives it away. nodes[0] is the root, 1..3
// its octants, 4 its extra leaf, 5.. leaves.
const Lie kLies[] = {
    {"leafBoxTooLarge", [](auto& c) { c.nodes[4].box.max.x += 1; }, "box"},
    {"innerBoxTooLarge", [](auto& c) { c.nodes[1].box.min.y -= c.nodes[1].box.min.y; }, ""},
    {"boxOutsideParent", [](auto& c) { c.nodes[1].box.max = Vec3i(1024); }, "box"},
    {"errorShrinksUpwards", [](auto& c) { c.nodes[2].errorModelUnits = 99; }, "error"},
    {"trianglesBelow", [](auto& c) { c.nodes[0].subtreeTriangles -= 1; }, "triangles below"},
    {"triangleCount", [](auto& c) { c.header.triangleCount += 1; }, "triangles"},
    {"triangleSum", [](auto& c) { c.header.triangleSum.low ^= 1; }, "other triangles"},
    {"levels", [](auto& c) { c.header.levelCount += 1; }, "levels"},
    {"colourFlag", [](auto& c) { c.nodes[5].flags ^= kNodeHasColours; }, "flags"},
    {"normalFlag", [](auto& c) { c.nodes[5].flags ^= kNodeHasNormals; }, "flags"},
    {"translucentFlag", [](auto& c) { c.nodes[5].flags ^= kNodeHasTranslucent; }, "flags"},
    {"zipperFlag", [](auto& c) { c.nodes[5].flags ^= kNodeHasZippers; }, "flags"},
    {"vertexCount", [](auto& c) { c.nodes[5].vertexCount += 1; }, "counts"},
    {"opaqueCount", [](auto& c) { c.nodes[5].opaqueTriangleCount -= 1; }, "counts"},
    {"pageShared",
     [](auto& c) {
         c.nodes[6].pageOffset = c.nodes[5].pageOffset;
         c.nodes[6].pageBytes = c.nodes[5].pageBytes;
     },
     ""},
    {"objectTriangles", [](auto& c) { c.objects[1].triangleCount += 1; }, "triangles"},
    {"objectBox", [](auto& c) { c.objects[1].box.max.z += 1; }, "box"},
    {"objectSource", [](auto& c) { c.objects[1].source = 1; }, "source"},
    {"objectMissing", [](auto& c) { c.objects.pop_back(); }, "no such object"},
    {"parentBehind", [](auto& c) { c.objects[1].parent = 2; }, "parent"},
    {"materialMissing", [](auto& c) { c.materials.pop_back(); }, "no such material"},
    {"materialOpacity", [](auto& c) { c.materials[0].isTranslucent = true; }, "opacity"},
    {"metadata", [](auto& c) { c.metadataJson.pop_back(); }, "JSON"},
};

class VerifyStructure : public VerifyDatabase, public testing::WithParamInterface<Lie> {};

TEST_P(VerifyStructure, FindsWhatIsWrong) {
    (void)writeDatabase(path_, {.spoil = GetParam().spoil});
    const VerifyReport report = verify();
    ASSERT_FALSE(report.isSound());
    EXPECT_NE(list(report).find(GetParam().expected), std::string::npos) << list(report);
}

INSTANTIATE_TEST_SUITE_P(Lies, VerifyStructure, testing::ValuesIn(kLies),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_F(VerifyDatabase, FindsAPageThatNoNodeNames) {
    (void)writeDatabase(path_, {.depth = 0});
    std::filesystem::remove(path_);
    DatabaseWriter writer(path_, false, 0);
    writer.addPage(std::vector<std::byte>(10));  // nobody's
    std::mt19937 random(1);
    const PageMesh mesh =
        test::randomMesh(random, {.hasTranslucent = false, .objectCount = 1, .materialCount = 1});
    const std::vector<std::byte> page = encodePage({mesh, {}}, Codec::Meshopt);
    DatabaseWriter::Content content;
    NodeRecord& node = content.nodes.emplace_back();
    node.pageOffset = writer.addPage(page);
    node.pageBytes = static_cast<uint32_t>(page.size());
    node.pageChecksum = hash64(page);
    node.box = mesh.box();
    node.flags = kNodeHasColours | kNodeHasNormals;
    node.triangleCount = node.opaqueTriangleCount = mesh.triangleCount();
    node.subtreeTriangles = content.header.triangleCount = mesh.triangleCount();
    node.vertexCount = mesh.vertexCount();
    content.header.lattice.extentBits = 10;
    content.header.levelCount = 1;
    content.objects.emplace_back();
    content.materials.emplace_back();
    content.metadataJson = std::string("{}");
    writer.publish(std::move(content));
    EXPECT_NE(list(verify()).find("bytes between pages"), std::string::npos) << list(verify());
}

}  // namespace
}  // namespace pagoda::ooc
