// The example of ooc/FORMAT.md is what our writer writes.
#include "ooc/base/file.h"
#include "ooc/store/triangle_sum.h"
#include "ooc/store/verify.h"
#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fstream>
#include <sstream>

namespace pagoda::ooc {
namespace {

void writeExample(const std::filesystem::path& path) {
    PageMesh mesh;
    mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 1}};
    mesh.constantColour = 0xFF0000FFu;  // red
    mesh.indices = {0, 1, 2};
    mesh.runs = {{.triangleCount = 1, .object = 0, .material = 0}};
    mesh.partStart.fill(1);
    mesh.partStart[0] = 0;
    const std::vector<std::byte> page = encodePage({mesh, {}}, Codec::Raw);

    DatabaseWriter writer(path, false, 0);
    NodeRecord node;
    node.box = mesh.box();
    node.errorModelUnits = 0.25;
    node.triangleCount = node.opaqueTriangleCount = 1;
    node.vertexCount = 3;
    node.subtreeTriangles = 1;
    node.pageOffset = writer.addPage(page);
    node.pageBytes = static_cast<uint32_t>(page.size());
    node.pageChecksum = hash64(page);

    DatabaseWriter::Content content;
    content.header.lattice = {.origin = {10, 0, 0}, .stepExponent = -1, .extentBits = 2};
    content.header.codec = Codec::Raw;
    content.header.levelCount = 1;
    content.header.triangleCount = 1;
    content.header.nodeTriangles = 4096;
    addTriangle(content.header.triangleSum, mesh.positions[0], mesh.positions[1], mesh.positions[2],
                0, 0);
    content.nodes = {node};
    content.objects.emplace_back();
    content.objects[0].name = "sail";
    content.objects[0].box = node.box;
    content.objects[0].triangleCount = 1;
    content.materials = {{.name = "red", .colour = 0xFF0000FFu}};
    content.metadataJson = R"({"up":"z"})";
    writer.publish(std::move(content));
}

std::string hex(std::span<const std::byte> bytes) {
    std::string text;
    for (const std::byte byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned>(byte));
    return text;
}

// Lines of the page's dump: an offset, a colon, groups of hex digits, two blanks, words.
std::string dumpOfThePage() {
    std::ifstream in(std::filesystem::path(PAGODA_SOURCE_DIR) / "ooc" / "FORMAT.md");
    std::string line, digits;
    bool isDump = false;
    while (std::getline(in, line)) {
        if (line == "```dump") isDump = true;
        if (line == "```") isDump = false;
        const size_t colon = line.find(": ");
        if (!isDump || colon == std::string::npos) continue;
        EXPECT_EQ(std::stoul(line.substr(0, colon)), digits.size() / 2) << line;
        std::string bytes = line.substr(colon + 2);
        bytes.resize(std::min(bytes.size(), bytes.find("  ")));
        std::erase(bytes, ' ');
        digits += bytes;
    }
    return digits;
}

TEST(FormatPage, ExplainsTheVeryBytesThatAreWritten) {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "example.pagoda";
    writeExample(path);
    Progress progress;
    ASSERT_TRUE(verifyDatabase(path, 1, progress).isSound());
    const std::vector<std::byte> bytes = readWholeFile(path, 4096);
    const auto header = std::span(bytes).first(256), footer = std::span(bytes).last(256);
    EXPECT_EQ(hex(header), hex(footer));
    EXPECT_EQ(dumpOfThePage(), hex(std::span(bytes).first(bytes.size() - 256)));
}

}  // namespace
}  // namespace pagoda::ooc
