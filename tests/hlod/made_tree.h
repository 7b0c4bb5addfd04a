// made_tree.h: an octree of records without pages, made by hand or by dice, as a strategy walks it:
// every index block is resident. For tests and benchmarks of traversals alone.
#pragma once

#include "cache/clock.h"
#include "cache/index_cache.h"
#include "cache/page_source.h"
#include "hlod/view/node_tree.h"
#include "ooc/store/index_packing.h"
#include "tests/viewer/inline_loads.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pagoda::hlod::test {

// The records. Nodes are numbered in the order in which they were added; 0 is the root.
class MadeRecords final : public cache::PageSource {
public:
    MadeRecords(const ooc::Lattice& latticeOfAll, const Box3i& rootBox, double rootError)
        : lattice(latticeOfAll) {
        nodes_.push_back({.id = ooc::NodeId::root(),
                          .box = rootBox,
                          .errorModelUnits = rootError,
                          .triangleCount = 1,
                          .opaqueTriangleCount = 1,
                          .vertexCount = 3,
                          .pageBytes = 1});
        children_.emplace_back();
    }
    // Octants of one parent in rising order.
    size_t add(size_t parent, uint32_t octant, const Box3i& box, double errorModelUnits) {
        ooc::NodeRecord record = nodes_[parent];
        nodes_[parent].childMask |= static_cast<uint16_t>(1u << octant);
        record.id = record.id.child(octant);
        record.box = box;
        record.errorModelUnits = errorModelUnits;
        record.childMask = 0;
        record.pageOffset = nodes_.size();
        nodes_.push_back(record);
        children_[parent].push_back(nodes_.size() - 1);
        children_.emplace_back();
        return nodes_.size() - 1;
    }
    void setError(size_t node, double errorModelUnits) {
        nodes_[node].errorModelUnits = errorModelUnits;
    }
    // Lays the records out in blocks as a database does. Once, after the last add().
    void finish() {
        std::vector<size_t> order = {0};  // children side by side
        for (size_t next = 0; next < order.size(); ++next) {
            const std::vector<size_t>& family = children_[order[next]];
            order.insert(order.end(), family.begin(), family.end());
        }
        std::vector<ooc::NodeRecord> records;
        records.reserve(order.size());
        for (const size_t node : order) records.push_back(nodes_[node]);
        for (const auto& numbers :
             ooc::packIndexBlocks(records, cache::IndexCache::kSlotsPerBlock)) {
            ooc::IndexBlock& block = blocks_.emplace_back();
            for (const uint32_t number : numbers) block.nodes.push_back(records[number]);
        }
    }
    [[nodiscard]] const std::vector<ooc::NodeRecord>& nodes() const { return nodes_; }
    [[nodiscard]] const std::vector<size_t>& children(size_t node) const { return children_[node]; }

    std::string read(uint64_t, std::span<std::byte>) const override { return {}; }
    ooc::Loaded<ooc::Page> decodePage(const ooc::NodeRecord&,
                                      std::span<const std::byte>) const override {
        return page;
    }
    uint32_t blockCount() const override { return static_cast<uint32_t>(blocks_.size()); }
    cache::ByteRange blockRange(uint32_t block) const override {
        return {uint64_t{block} << 20, 96 * blocks_[block].nodes.size()};
    }
    ooc::Loaded<ooc::IndexBlock> decodeBlock(uint32_t block,
                                             std::span<const std::byte>) const override {
        return {blocks_[block], ""};
    }

    ooc::Lattice lattice;
    ooc::Loaded<ooc::Page> page{std::nullopt, "there are no pages"};  // of every node

private:
    std::vector<ooc::NodeRecord> nodes_;
    std::vector<std::vector<size_t>> children_;
    std::vector<ooc::IndexBlock> blocks_;
};

// Its index, with every block resident.
class MadeTree {
public:
    explicit MadeTree(const MadeRecords& records)
        : loads_(records),
          requests_(loads_, clock_, {.readsInFlight = SIZE_MAX, .readBytes = 1}),
          index_(records.lattice, records, requests_, UINT64_MAX / 4),
          tree_(records.lattice, index_) {
        beginFrame();
        for (uint32_t block = 0; block < records.blockCount(); ++block) {
            static_cast<void>(index_.block(block));
        }
        requests_.send([this](const cache::Request& request) { return index_.admit(request); });
        std::vector<cache::RequestQueue::Arrival> arrivals;
        requests_.collect(arrivals);
        for (cache::RequestQueue::Arrival& arrival : arrivals) index_.arrive(arrival);
    }
    void beginFrame() {
        requests_.beginFrame();
        index_.beginFrame(++frameIndex_);
    }
    [[nodiscard]] NodeTree& tree() noexcept { return tree_; }
    [[nodiscard]] size_t blockCount() const { return index_.blockCount(); }
    [[nodiscard]] uint64_t frameIndex() const noexcept { return frameIndex_; }

private:
    cache::ManualClock clock_;
    pagoda::test::InlineLoads loads_;
    cache::RequestQueue requests_;
    cache::IndexCache index_;
    NodeTree tree_;
    uint64_t frameIndex_ = 0;
};

}  // namespace pagoda::hlod::test
