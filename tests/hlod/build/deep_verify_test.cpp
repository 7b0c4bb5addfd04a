#include "hlod/build/deep_verify.h"

#include "hlod/build/build.h"
#include "ooc/store/database_writer.h"
#include "tests/hlod/build/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>

namespace pagoda::hlod {
namespace {

using test::TemporaryFolder;

void buildTorus(const TemporaryFolder& folder, ooc::Codec codec) {
    writePly(test::roughTorus(300, 120), folder / "torus.ply");
    BuildOptions options;
    options.inputs = expandInputs({(folder / "torus.ply").string()});
    options.target = folder / "torus.pagoda";
    options.threads = 1;
    options.nodeTriangles = 1024;
    options.codec = codec;
    Progress progress;
    (void)buildDatabase(options, progress);
}

// The database again, page by page, with records as `change` leaves them.
void rewrite(const std::filesystem::path& from, const std::filesystem::path& to,
             const std::function<void(ooc::NodeRecord&)>& change) {
    const ooc::Database database = ooc::Database::open(from);
    std::map<uint64_t, ooc::NodeRecord> records;  // by place of the page: file order
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            records[node.pageOffset] = node;
            return true;
        },
        [](uint32_t, const std::string& why) { ADD_FAILURE() << why; });
    ooc::DatabaseWriter writer(to, false, 0);
    ooc::DatabaseWriter::Content content;
    content.header = database.header();
    content.materials = database.materials();
    content.metadataJson = database.metadataJson();
    for (uint32_t block = 0; block < database.objectBlockCount(); ++block) {
        const std::vector<ooc::ObjectRecord> objects =
            database.readObjectBlock(block).value.value();
        content.objects.insert(content.objects.end(), objects.begin(), objects.end());
    }
    for (auto& [place, node] : records) {
        node.pageOffset = writer.addPage(database.readPageBytes(node).value.value());
        change(node);
        content.nodes.push_back(node);
    }
    (void)writer.publish(std::move(content));
}

struct Verdict {
    DeepReport deep;
    ooc::VerifyReport faults;
};

Verdict measure(const std::filesystem::path& path, size_t threads) {
    Progress progress;
    Verdict verdict;
    verdict.deep = verifyErrors(ooc::Database::open(path), threads, progress, verdict.faults);
    return verdict;
}

bool isSoundButForErrors(const std::filesystem::path& path) {
    Progress progress;
    return ooc::verifyDatabase(path, 1, progress).isSound();
}

class DeepVerifyOf : public testing::TestWithParam<ooc::Codec> {};

// Draco stores triangles in another order and turns their corners: the samples must not care.
TEST_P(DeepVerifyOf, aDatabaseStatesTheErrorsThatItsPagesHave) {
    const TemporaryFolder folder;
    buildTorus(folder, GetParam());
    const ooc::Header header = ooc::Database::open(folder / "torus.pagoda").header();
    const Verdict verdict = measure(folder / "torus.pagoda", 2);
    EXPECT_TRUE(verdict.faults.isSound()) << verdict.faults.faults.front().what;
    EXPECT_EQ(verdict.deep.leaves, header.leafCount);
    EXPECT_EQ(verdict.deep.innerNodes, header.nodeCount - header.leafCount);
    EXPECT_GT(verdict.deep.innerNodes, 20u);
    EXPECT_EQ(verdict.deep.tooSmall, 0u);
    EXPECT_NEAR(verdict.deep.largestRatio, 1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(EveryCodec, DeepVerifyOf,
                         testing::Values(ooc::Codec::Meshopt, ooc::Codec::Draco, ooc::Codec::Raw),
                         [](const auto& codec) {
                             return std::string(ooc::codecName(codec.param));
                         });

TEST(DeepVerify, anErrorThatWasLoweredByHandIsFoundWhereNothingElseIs) {
    const TemporaryFolder folder;
    buildTorus(folder, ooc::Codec::Meshopt);
    // The root's error may fall to its children's greatest: still monotone, and a lie.
    const ooc::Database database = ooc::Database::open(folder / "torus.pagoda");
    double below = 0, stated = 0;
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            const bool isRoot = node.id == ooc::NodeId::root();
            (isRoot ? stated : below) = std::max(isRoot ? stated : below, node.errorModelUnits);
            return isRoot;
        },
        [](uint32_t, const std::string& why) { ADD_FAILURE() << why; });
    ASSERT_GT(stated, below);
    rewrite(folder / "torus.pagoda", folder / "lowered.pagoda", [&](ooc::NodeRecord& node) {
        if (node.id == ooc::NodeId::root()) node.errorModelUnits = below;
    });
    ASSERT_TRUE(isSoundButForErrors(folder / "lowered.pagoda"));

    const Verdict verdict = measure(folder / "lowered.pagoda", 1);
    EXPECT_EQ(verdict.deep.tooSmall, 1u);
    ASSERT_EQ(verdict.faults.faultCount, 1u);
    EXPECT_EQ(verdict.faults.faults[0].place, ooc::nodeName(ooc::NodeId::root()));
    EXPECT_NEAR(verdict.deep.largestRatio, stated / below, 1e-6);
}

TEST(DeepVerify, anErrorLoweredByAThousandthIsFoundAndARaisedOneIsNone) {
    const TemporaryFolder folder;
    buildTorus(folder, ooc::Codec::Meshopt);
    for (const double factor : {0.999, 1.001}) {
        const std::filesystem::path target = folder / ("root" + std::to_string(factor));
        rewrite(folder / "torus.pagoda", target, [&](ooc::NodeRecord& node) {
            if (node.id == ooc::NodeId::root()) node.errorModelUnits *= factor;
        });
        EXPECT_EQ(measure(target, 2).deep.tooSmall, factor < 1 ? 1u : 0u) << factor;
    }
}

TEST(DeepVerify, aLeafThatStatesLessThanTheSnapMayMoveIsFound) {
    const TemporaryFolder folder;
    buildTorus(folder, ooc::Codec::Meshopt);
    ooc::NodeId leaf;
    rewrite(folder / "torus.pagoda", folder / "leaf.pagoda", [&](ooc::NodeRecord& node) {
        if (!node.isLeaf() || leaf != ooc::NodeId::root()) return;
        leaf = node.id;
        node.errorModelUnits /= 2;
    });
    const Verdict verdict = measure(folder / "leaf.pagoda", 2);
    ASSERT_EQ(verdict.faults.faultCount, 1u);
    EXPECT_EQ(verdict.faults.faults[0].place, ooc::nodeName(leaf));
}

}  // namespace
}  // namespace pagoda::hlod
