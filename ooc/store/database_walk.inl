// database_walk.inl: walkIndex() and forEachNode() of database.h.
// A child's id must be the one its place implies. So every node is reached once at most and the
// walk ends and goes no deeper than ids do, whatever a hostile file refers to.
#pragma once

#include <algorithm>
#include <map>
#include <utility>

namespace pagoda::ooc {
namespace detail {

template <typename Visitor>
class IndexWalk {
public:
    IndexWalk(const Database& database, Visitor& visitor)
        : database_(database), visitor_(visitor) {}

    void run() {
        Loaded<IndexBlock> block = database_.readBlock(0);
        if (!block.value) {
            visitor_.fault(0, block.fault);
            return;
        }
        walk(0, *block.value, {0});
    }

private:
    // Everything below the nodes `first`, which lie in `block` and have not been entered yet. The
    // blocks below are loaded one after the other while this one stays: one a level.
    void walk(uint32_t blockNumber, const IndexBlock& block, std::vector<uint32_t> open) {
        std::map<uint32_t, std::vector<uint32_t>> below;  // child block -> parents in this block
        while (!open.empty()) {
            const uint32_t index = open.back();
            open.pop_back();
            const NodeRecord& node = block.nodes[index];
            if (!visitor_.enter(node, NodeRef{blockNumber, index}) || node.isLeaf()) continue;
            if (node.childBlock != blockNumber) {
                below[node.childBlock].push_back(index);
                continue;
            }
            visitor_.children(node,
                              std::span(block.nodes).subspan(node.childIndex, node.childCount()));
            for (uint32_t k = node.childCount(); k-- > 0;) open.push_back(node.childIndex + k);
        }
        for (const auto& [childBlock, parents] : below) descend(block, childBlock, parents);
    }

    void descend(const IndexBlock& block, uint32_t childBlock,
                 const std::vector<uint32_t>& parents) {
        Loaded<IndexBlock> loaded = database_.readBlock(childBlock);
        if (!loaded.value) {
            visitor_.fault(childBlock, loaded.fault);
            return;
        }
        std::vector<uint32_t> open;  // the last is entered first
        for (const uint32_t parent : parents) {
            const NodeRecord& node = block.nodes[parent];
            const auto children =
                std::span(loaded.value->nodes).subspan(node.childIndex, node.childCount());
            if (!areOf(node, children)) {
                visitor_.fault(childBlock, "children of another node");
                continue;
            }
            visitor_.children(node, children);
            for (uint32_t k = 0; k < node.childCount(); ++k) open.push_back(node.childIndex + k);
        }
        std::reverse(open.begin(), open.end());
        walk(childBlock, *loaded.value, std::move(open));
    }

    static bool areOf(const NodeRecord& parent, std::span<const NodeRecord> children) {
        for (uint32_t k = 0; k < children.size(); ++k) {
            if (children[k].id != parent.childId(k)) return false;
        }
        return true;
    }

    const Database& database_;
    Visitor& visitor_;
};

}  // namespace detail

template <typename Visitor>
void walkIndex(const Database& database, Visitor& visitor) {
    detail::IndexWalk<Visitor>(database, visitor).run();
}

template <typename Visit, typename Fault>
void forEachNode(const Database& database, Visit&& visit, Fault&& fault) {
    struct Visitor {
        Visit& visit;
        Fault& onFault;
        bool enter(const NodeRecord& node, NodeRef ref) { return visit(node, ref); }
        void children(const NodeRecord&, std::span<const NodeRecord>) {}
        void fault(uint32_t block, const std::string& why) { onFault(block, why); }
    };
    Visitor visitor{visit, fault};
    walkIndex(database, visitor);
}

}  // namespace pagoda::ooc
