#include "ooc/store/index_packing.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <stdexcept>

namespace pagoda::ooc {
namespace {

// Root first, then family by family, breadth first: what DatabaseWriter is given.
std::vector<NodeRecord> randomTree(uint32_t seed, int depth) {
    std::mt19937 random(seed);
    std::vector<NodeRecord> nodes(1);
    for (size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].id.slot() != 0 || nodes[i].id.depth() >= depth || random() % 4 == 0) continue;
        nodes[i].childMask = static_cast<uint16_t>((random() & 0xFF) | (random() % 3 << 8));
        for (uint32_t k = 0; k < nodes[i].childCount(); ++k) {
            nodes.emplace_back().id = nodes[i].childId(k);
        }
    }
    return nodes;
}

class IndexPacking : public testing::TestWithParam<uint32_t> {};

TEST_P(IndexPacking, PlacesEveryNodeOnceAndFamiliesSideBySideBehindTheirParent) {
    std::vector<NodeRecord> nodes = randomTree(GetParam(), 6);
    const auto blocks = packIndexBlocks(nodes, 64);
    std::map<NodeId, std::pair<uint32_t, uint32_t>> placeOf;
    for (uint32_t b = 0; b < blocks.size(); ++b) {
        EXPECT_LE(blocks[b].size(), 64u);
        for (uint32_t i = 0; i < blocks[b].size(); ++i) {
            EXPECT_TRUE(placeOf.insert({nodes[blocks[b][i]].id, {b, i}}).second);
        }
    }
    EXPECT_EQ(placeOf.size(), nodes.size());
    EXPECT_EQ(placeOf[NodeId::root()], std::pair(0u, 0u));

    std::map<uint32_t, std::set<uint32_t>> blocksAbove;
    for (const NodeRecord& node : nodes) {
        for (uint32_t k = 0; k < node.childCount(); ++k) {
            EXPECT_EQ(placeOf[node.childId(k)], std::pair(node.childBlock, node.childIndex + k));
            EXPECT_LT(placeOf[node.id], placeOf[node.childId(k)]);
        }
        if (!node.isLeaf() && node.childBlock != placeOf[node.id].first) {
            blocksAbove[node.childBlock].insert(placeOf[node.id].first);
        }
    }
    for (const auto& [block, above] : blocksAbove) EXPECT_EQ(above.size(), 1u) << block;
}

INSTANTIATE_TEST_SUITE_P(Seeds, IndexPacking, testing::Range(0u, 20u));

TEST(IndexPackingOfALargeTree, FillsItsBlocks) {
    std::vector<NodeRecord> nodes(1);
    for (size_t i = 0; i < nodes.size(); ++i) {  // 8^5 leaves
        if (nodes[i].id.depth() == 5) continue;
        nodes[i].childMask = 0xFF;
        for (uint32_t k = 0; k < 8; ++k) {
            const NodeId child = nodes[i].childId(k);
            nodes.emplace_back().id = child;
        }
    }
    const auto blocks = packIndexBlocks(nodes, 512);
    EXPECT_LE(blocks.size() * 512, nodes.size() * 5 / 4);  // above 80% full
}

TEST(IndexPackingOfWrongOrder, IsRefused) {
    std::vector<NodeRecord> nodes(3);
    nodes[0].childMask = 3;
    nodes[1].id = NodeId::root().child(1);
    nodes[2].id = NodeId::root().child(0);
    EXPECT_THROW((void)packIndexBlocks(nodes, 512), std::logic_error);
}

}  // namespace
}  // namespace pagoda::ooc
