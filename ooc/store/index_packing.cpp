#include "ooc/store/index_packing.h"

#include <algorithm>
#include <deque>
#include <stdexcept>
#include <utility>

namespace pagoda::ooc {
namespace {

constexpr uint32_t kNoParent = UINT32_MAX;

// Siblings: records that must stay side by side.
struct Family {
    uint32_t parent = kNoParent;  // number of the parent's record
    uint32_t first = 0, count = 1;
};

class Packer {
public:
    Packer(std::vector<NodeRecord>& nodes, uint32_t maxNodesPerBlock)
        : nodes_(nodes), maxNodesPerBlock_(maxNodesPerBlock) {
        byId_.reserve(nodes.size());
        for (uint32_t i = 0; i < nodes.size(); ++i) byId_.emplace_back(nodes[i].id, i);
        std::sort(byId_.begin(), byId_.end());
        subtreeNodes_.assign(nodes.size(), 1);
        for (size_t i = byId_.size(); i-- > 1;) {  // what is below a node has greater ids
            const auto& [id, number] = byId_[i];
            const auto parent = find(id.parent());
            if (parent != byId_.end()) subtreeNodes_[parent->second] += subtreeNodes_[number];
        }
    }

    std::vector<std::vector<uint32_t>> run() {
        if (nodes_.empty() || nodes_[0].id != NodeId::root()) {
            throw std::logic_error("the first node is not the root");
        }
        waiting_.push_back({Family{}});
        while (!waiting_.empty()) {
            const std::vector<Family> families = std::move(waiting_.front());
            waiting_.pop_front();
            for (size_t next = 0; next < families.size();) next = fillBlock(families, next);
        }
        if (placed_ != nodes_.size()) throw std::logic_error("nodes that no parent names");
        return std::move(blocks_);
    }

private:
    // Takes families from number `next` on until the block is full; returns the first not taken.
    size_t fillBlock(const std::vector<Family>& families, size_t next) {
        blocks_.emplace_back();
        std::vector<Family> beyond;
        do {
            fillSubtree(families[next], beyond);
            ++next;
        } while (next < families.size() && isWorthAdding(families[next]));
        if (!beyond.empty()) waiting_.push_back(std::move(beyond));
        return next;
    }

    // A subtree cut near a full block's end would leave crumbs for a block of their own.
    [[nodiscard]] bool isWorthAdding(const Family& family) const {
        size_t nodes = 0;
        for (uint32_t i = 0; i < family.count; ++i) nodes += subtreeNodes_[family.first + i];
        const size_t used = blocks_.back().size();
        return used + nodes <= maxNodesPerBlock_ || (used < maxNodesPerBlock_ / 2 && fits(family));
    }

    void fillSubtree(const Family& top, std::vector<Family>& beyond) {
        std::deque<Family> open{top};
        while (!open.empty()) {
            const Family family = open.front();
            open.pop_front();
            if (!fits(family)) {
                beyond.push_back(family);
                continue;
            }
            place(family);
            for (uint32_t i = family.first; i < family.first + family.count; ++i) {
                if (!nodes_[i].isLeaf()) open.push_back(familyBelow(i));
            }
        }
    }

    [[nodiscard]] bool fits(const Family& family) const {
        return blocks_.back().size() + family.count <= maxNodesPerBlock_;
    }

    void place(const Family& family) {
        std::vector<uint32_t>& block = blocks_.back();
        if (family.parent != kNoParent) {
            nodes_[family.parent].childBlock = static_cast<uint32_t>(blocks_.size() - 1);
            nodes_[family.parent].childIndex = static_cast<uint32_t>(block.size());
        }
        for (uint32_t i = 0; i < family.count; ++i) block.push_back(family.first + i);
        placed_ += family.count;
    }

    [[nodiscard]] Family familyBelow(uint32_t parent) const {
        const NodeRecord& node = nodes_[parent];
        const auto first =
            std::lower_bound(byId_.begin(), byId_.end(), std::pair(node.childId(0), uint32_t{0}));
        const uint32_t count = node.childCount();
        const bool isThere = first != byId_.end() && first->first == node.childId(0) &&
                             nodes_.size() - first->second >= count;
        for (uint32_t k = 0; k < count; ++k) {
            if (!isThere || nodes_[first->second + k].id != node.childId(k)) {
                throw std::logic_error("children are not side by side in the order of their ids");
            }
        }
        return {parent, first->second, count};
    }

    using ById = std::vector<std::pair<NodeId, uint32_t>>;
    [[nodiscard]] ById::const_iterator find(NodeId id) const {
        const auto place = std::lower_bound(byId_.begin(), byId_.end(), std::pair(id, uint32_t{0}));
        return place != byId_.end() && place->first == id ? place : byId_.end();
    }

    std::vector<NodeRecord>& nodes_;
    uint32_t maxNodesPerBlock_;
    ById byId_;
    std::vector<size_t> subtreeNodes_;         // a node and all below it
    std::deque<std::vector<Family>> waiting_;  // each: what one block had no room for
    std::vector<std::vector<uint32_t>> blocks_;
    size_t placed_ = 0;
};

}  // namespace

std::vector<std::vector<uint32_t>> packIndexBlocks(std::vector<NodeRecord>& nodes,
                                                   uint32_t maxNodesPerBlock) {
    for (NodeRecord& node : nodes) node.childBlock = node.childIndex = 0;
    return Packer(nodes, maxNodesPerBlock).run();
}

}  // namespace pagoda::ooc
