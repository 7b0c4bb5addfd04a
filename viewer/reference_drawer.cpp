#include "viewer/reference_drawer.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace pagoda::viewer {
namespace {

constexpr size_t kReadAhead = 64;  // pages

ooc::Loaded<ooc::IndexBlock> readBlock(const cache::PageSource& source, uint32_t block) {
    if (block >= source.blockCount()) return {{}, "no such block"};
    const cache::ByteRange range = source.blockRange(block);
    std::vector<std::byte> bytes(range.bytes);
    std::string fault = source.read(range.offset, bytes);
    if (!fault.empty()) return {{}, std::move(fault)};
    return source.decodeBlock(block, bytes);
}

// Walks the index by blocks: each is read once, since nodes of one other block alone refer to it.
class LeafWalk {
public:
    LeafWalk(const hlod::View& view, const ooc::Lattice& lattice, const cache::PageSource& source,
             LeafList& list)
        : view_(view), lattice_(lattice), source_(source), list_(list) {}

    void walk(uint32_t number, const std::vector<uint32_t>& roots) {
        ooc::Loaded<ooc::IndexBlock> block = readBlock(source_, number);
        if (!block.value) {
            list_.faults.push_back(fmt::format("index block {}: {}", number, block.fault));
            return;
        }
        const std::vector<ooc::NodeRecord>& nodes = block.value->nodes;
        std::map<uint32_t, std::vector<uint32_t>> elsewhere;  // block -> nodes there
        std::vector<uint32_t> pending = roots;
        while (!pending.empty()) {
            const uint32_t index = pending.back();
            pending.pop_back();
            if (index >= nodes.size()) continue;  // a reference that lies: `verify` tells
            const ooc::NodeRecord& node = nodes[index];
            const Box3d boxModel = lattice_.toModel(node.box);
            ++list_.visitedNodes;
            if (!view_.intersectsFrustum(boxModel)) {
                ++list_.culledNodes;
                continue;
            }
            if (node.isLeaf()) {
                list_.records.push_back(node);
                list_.boxesModel.push_back(boxModel);
            }
            auto& below = node.childBlock == number ? pending : elsewhere[node.childBlock];
            for (uint32_t i = 0; i < node.childCount(); ++i) below.push_back(node.childIndex + i);
        }
        block.value.reset();
        for (const auto& [next, indices] : elsewhere) {
            // Blocks lie behind those that refer to them: no circles.
            if (!indices.empty() && next > number) walk(next, indices);
        }
    }

private:
    const hlod::View& view_;
    const ooc::Lattice& lattice_;
    const cache::PageSource& source_;
    LeafList& list_;
};

}  // namespace

LeafList leavesInFrustum(const hlod::View& view, const ooc::Lattice& lattice,
                         const cache::PageSource& source) {
    LeafList list;
    LeafWalk(view, lattice, source, list).walk(0, {0});
    std::vector<size_t> order(list.records.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return list.records[a].id < list.records[b].id; });
    for (const size_t i : order) {
        list.nodes.push_back({&list.records[i], &list.boxesModel[i], 0, 0});
    }
    return list;
}

ReferenceDrawer::ReferenceDrawer(const cache::PageSource& source, cache::LoadQueue& loads,
                                 GlDevice& device)
    : source_(source), loads_(loads), device_(device) {
}

void ReferenceDrawer::draw(const hlod::View& view, std::span<const hlod::Node> leaves,
                           hlod::FrameRecord& record, const std::function<void()>& onBatch) {
    device_.beginFrame(view);
    const auto drawOpaque = [&](std::span<const hlod::Node> batch) {
        for (const hlod::Node& node : batch) device_.draw(node);
        device_.finishOpaque(record);
    };
    inBatches(leaves, record, drawOpaque, onBatch);
    const std::vector<hlod::Node> translucent = translucentBackToFront(leaves, view.eye());
    const auto drawTranslucent = [&](std::span<const hlod::Node> batch) {
        device_.drawTranslucent(batch, record);
        device_.finishOpaque(record);
    };
    inBatches(translucent, record, drawTranslucent, onBatch);
    std::sort(record.faults.begin(), record.faults.end());
    record.faults.erase(std::unique(record.faults.begin(), record.faults.end()),
                        record.faults.end());
}

void ReferenceDrawer::readAhead(std::span<const hlod::Node> nodes) {
    while (sent_ < nodes.size() && sent_ - (nextTicket_ - firstTicket_) < kReadAhead) {
        const ooc::NodeRecord& node = *nodes[sent_].record;
        loads_.send({{firstTicket_ + sent_, 0, cache::pageRange(node), false, 0, node}});
        ++sent_;
    }
}

cache::LoadResult ReferenceDrawer::take(uint64_t ticket) {
    std::vector<cache::LoadResult> results;
    while (!arrived_.contains(ticket)) {
        static_cast<void>(loads_.waitForArrival());
        results.clear();
        loads_.collect(results);
        for (cache::LoadResult& result : results) {
            const uint64_t key = result.ticket;
            arrived_.emplace(key, std::move(result));
        }
    }
    return std::move(arrived_.extract(ticket).mapped());
}

void ReferenceDrawer::inBatches(std::span<const hlod::Node> nodes, hlod::FrameRecord& record,
                                const std::function<void(std::span<const hlod::Node>)>& drawBatch,
                                const std::function<void()>& onBatch) {
    std::vector<hlod::Node> batch;
    uint64_t batchBytes = 0;
    const auto flush = [&] {
        record.gpuBytes = std::max(record.gpuBytes, batchBytes);
        batchBytes = 0;
        drawBatch(batch);
        for (const hlod::Node& node : batch) device_.store().drop(node.page());
        batch.clear();
        if (onBatch) onBatch();
    };
    firstTicket_ = nextTicket_;
    sent_ = 0;
    for (const hlod::Node& node : nodes) {
        readAhead(nodes);
        const cache::LoadResult result = take(nextTicket_++);
        if (!result.page) {
            record.faults.push_back(
                fmt::format("page of node {:#x}: {}", node.record->id.value, result.fault));
            continue;
        }
        ++record.loadedPages;
        record.bytesRead += node.record->pageBytes;
        using Upload = cache::GpuPages::Upload;
        Upload done = device_.store().upload(node.page(), *result.page);
        if (done == Upload::NoRoom && !batch.empty()) {
            flush();
            done = device_.store().upload(node.page(), *result.page);
        }
        if (done == Upload::Done) {
            batchBytes += device_.store().sizeBytes(*result.page);
            record.bytesUploaded += device_.store().sizeBytes(*result.page);
            batch.push_back(node);
        } else {
            record.faults.push_back(fmt::format("page of node {:#x}: larger than the GPU budget",
                                                node.record->id.value));
        }
    }
    flush();
}

}  // namespace pagoda::viewer
