#include "ooc/store/database.h"

#include "ooc/base/error.h"
#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>

namespace pagoda::ooc {
namespace {

using test::TemporaryFolder;
using test::writeDatabase;

TEST(Database, GivesBackWhatWasWritten) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.pagoda";
    const auto content = writeDatabase(path, {.depth = 4, .childrenPerNode = 8});
    const Database database = Database::open(path);
    EXPECT_TRUE(database.headerFault().empty());
    EXPECT_EQ(database.header().lattice, content.header.lattice);
    EXPECT_EQ(database.header().triangleSum, content.header.triangleSum);
    EXPECT_EQ(database.header().nodeCount, content.nodes.size());
    EXPECT_EQ(database.metadataJson(), content.metadataJson);
    ASSERT_EQ(database.materials().size(), 2u);
    EXPECT_TRUE(database.materials()[1].isTranslucent);
    EXPECT_EQ(database.readObject(1).value->name, "wall");

    std::set<NodeId> seen;
    uint64_t triangles = 0;
    forEachNode(
        database,
        [&](const NodeRecord& node, NodeRef) {
            EXPECT_TRUE(node.id == NodeId::root() || seen.contains(node.id.parent()));
            EXPECT_TRUE(seen.insert(node.id).second);
            const auto page = database.readPage(node);
            EXPECT_TRUE(page.value) << page.fault;
            if (node.isLeaf()) triangles += node.triangleCount;
            return true;
        },
        [](uint32_t block, const std::string& why) { ADD_FAILURE() << block << ": " << why; });
    EXPECT_EQ(seen.size(), content.nodes.size());
    EXPECT_EQ(triangles, content.header.triangleCount);
}

// Overwrites bytes of a file.
void poke(const std::filesystem::path& path, uint64_t offset, std::span<const std::byte> bytes) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(offset));
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

void spoil(const std::filesystem::path& path, uint64_t offset) {
    const std::byte old = readWholeFile(path, 1u << 24).at(offset);
    const std::byte flipped = old ^ std::byte{16};
    poke(path, offset, std::span(&flipped, 1));
}

class BrokenDatabase : public testing::Test {
protected:
    std::set<NodeId> reachable(uint32_t* faults = nullptr) const {
        std::set<NodeId> seen;
        forEachNode(
            Database::open(path_),
            [&](const NodeRecord& node, NodeRef) { return seen.insert(node.id).second; },
            [&](uint32_t, const std::string&) { *faults += 1; });
        return seen;
    }

    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path() / "a.pagoda";
};

TEST_F(BrokenDatabase, OpensByItsFooterWhenTheHeaderIsBroken) {
    const auto content = writeDatabase(path_, {});
    for (const uint64_t offset : {0u, 6u, 100u, 250u}) {
        spoil(path_, offset);
        const Database database = Database::open(path_);
        EXPECT_FALSE(database.headerFault().empty());
        EXPECT_EQ(database.header().triangleSum, content.header.triangleSum);
        EXPECT_EQ(reachable().size(), content.nodes.size());
        spoil(path_, offset);  // flips it back
    }
    spoil(path_, std::filesystem::file_size(path_) - 100);
    EXPECT_TRUE(Database::open(path_).headerFault().empty());  // and without its footer
    spoil(path_, 100);
    EXPECT_THROW((void)Database::open(path_), Error);  // but not without both
}

TEST_F(BrokenDatabase, IsRefusedWhenCutShortAtAnyLength) {
    (void)writeDatabase(path_, {});
    for (uintmax_t bytes = std::filesystem::file_size(path_); bytes-- > 0;) {
        std::filesystem::resize_file(path_, bytes);
        ASSERT_THROW((void)Database::open(path_), Error) << bytes;
    }
}

TEST_F(BrokenDatabase, LosesOnlyTheSubtreeOfABrokenIndexBlock) {
    const auto content = writeDatabase(path_, {.depth = 4, .childrenPerNode = 8});  // 4681 nodes
    const Database database = Database::open(path_);
    ASSERT_GT(database.blockCount(), 3u);
    for (uint32_t broken = 1; broken < database.blockCount(); ++broken) {
        std::set<NodeId> lost;  // of the block and below
        const auto block = database.readBlock(broken);
        for (const NodeRecord& node : block.value->nodes) lost.insert(node.id);
        std::set<NodeId> expected;
        for (const NodeRecord& node : content.nodes) {
            bool isLost = false;
            for (NodeId id = node.id;; id = id.parent()) {
                isLost = isLost || lost.contains(id);
                if (id == NodeId::root()) break;
            }
            if (!isLost) expected.insert(node.id);
        }
        spoil(path_, database.indexRanges()[broken].offset + 7);
        uint32_t faults = 0;
        EXPECT_EQ(reachable(&faults), expected);
        EXPECT_EQ(faults, 1u);
        spoil(path_, database.indexRanges()[broken].offset + 7);
    }
}

TEST_F(BrokenDatabase, LosesOnlyThePageOfAFlippedBit) {
    (void)writeDatabase(path_, {.codec = Codec::Meshopt});
    const Database database = Database::open(path_);
    const auto block = database.readBlock(0);
    const std::vector<NodeRecord>& nodes = block.value->nodes;
    spoil(path_, nodes[1].pageOffset + nodes[1].pageBytes / 2);
    EXPECT_EQ(database.readPage(nodes[1]).fault, "checksum differs");
    EXPECT_TRUE(database.readPage(nodes[0]).value);
    EXPECT_TRUE(database.readPage(nodes[2]).value);
}

TEST_F(BrokenDatabase, LosesOnlyNamesOfABrokenObjectBlock) {
    const auto content = writeDatabase(path_, {.spoil = [](auto& c) {
                                           c.objects.resize(5000);  // two blocks
                                       }});
    const Database database = Database::open(path_);
    ASSERT_EQ(database.objectBlockCount(), 2u);
    spoil(path_, database.objectRanges()[0].offset);
    EXPECT_FALSE(database.readObject(1).value);
    EXPECT_TRUE(database.readObject(4096).value);
    EXPECT_EQ(reachable().size(), content.nodes.size());
}

TEST_F(BrokenDatabase, OpensWithoutItsMetadataAndSaysSo) {
    (void)writeDatabase(path_, {});
    const Database sound = Database::open(path_);
    spoil(path_, sound.otherRanges()[4].offset);
    const Database database = Database::open(path_);
    EXPECT_EQ(database.metadataJson(), "{}");
    EXPECT_FALSE(database.metadataFault().empty());
}

// Every number of the header set to every hostile value, with a checksum that is right.
TEST_F(BrokenDatabase, NeverBelievesAHeaderThatLies) {
    (void)writeDatabase(path_, {.depth = 1});
    std::vector<std::byte> header = readWholeFile(path_, 1u << 24);
    header.resize(256);
    for (size_t at = 8; at < 248; at += 4) {
        for (const uint64_t value : {uint64_t{0}, uint64_t{1}, uint64_t{0x7FFFFFFF}, UINT64_MAX,
                                     uint64_t{1} << 63, UINT64_MAX - 255}) {
            std::vector<std::byte> lie = header;
            std::memcpy(lie.data() + at, &value, std::min<size_t>(8, 248 - at));
            const uint64_t checksum = hash64(std::span(lie).first(248));
            std::memcpy(lie.data() + 248, &checksum, 8);
            poke(path_, 0, lie);
            try {
                const Database database = Database::open(path_);
                uint32_t faults = 0;
                (void)reachable(&faults);
                (void)database.readObject(0);
            } catch (const Error&) {
            }
        }
    }
}

// Every field of every node record, with checksums that are right all the way up.
TEST_F(BrokenDatabase, NeverFollowsANodeThatLies) {
    (void)writeDatabase(path_, {.depth = 2});
    const Database sound = Database::open(path_);
    const auto block = sound.indexRanges()[0];
    std::vector<std::byte> file = readWholeFile(path_, 1u << 24);
    for (size_t at = 0; at < block.bytes; at += 4) {
        for (const uint32_t value : {0u, 1u, 2u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
            std::vector<std::byte> lie = file;
            std::memcpy(lie.data() + block.offset + at, &value, 4);
            const auto reseal = [&](uint64_t offset, uint64_t bytes, uint64_t place) {
                const uint64_t checksum = hash64(std::span(lie).subspan(offset, bytes));
                std::memcpy(lie.data() + place, &checksum, 8);
            };
            const auto directory = sound.otherRanges()[1];
            reseal(block.offset, block.bytes, directory.offset + 16);
            reseal(directory.offset, directory.bytes, 136 + 16);
            reseal(0, 248, 248);
            poke(path_, 0, lie);
            const Database database = Database::open(path_);
            std::set<NodeId> seen;
            forEachNode(
                database,
                [&](const NodeRecord& node, NodeRef) {
                    EXPECT_TRUE(seen.insert(node.id).second);
                    (void)database.readPage(node);
                    return true;
                },
                [](uint32_t, const std::string&) {});
            EXPECT_LE(seen.size(), sound.header().nodeCount);
        }
    }
}

}  // namespace
}  // namespace pagoda::ooc
