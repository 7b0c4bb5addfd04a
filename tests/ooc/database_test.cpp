#include "ooc/store/database.h"

#include "ooc/base/error.h"
#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace pagoda::ooc
