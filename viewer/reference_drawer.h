// reference_drawer.h: draws all leaves inside the frustum, whatever their number: pages are read
// ahead in order, uploaded until the budget is full, drawn and dropped. Render thread only.
#pragma once

#include "cache/load_queue.h"
#include "cache/page_source.h"
#include "hlod/view/node_tree.h"
#include "viewer/gl_device.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace pagoda::viewer {

class ReferenceDrawer {
public:
    // `store` (of `device`) is empty and stays so. All outlive it.
    ReferenceDrawer(const cache::PageSource& source, cache::LoadQueue& loads, GlDevice& device);

    // Draws the opaque parts of `leaves` in their order, then the translucent ones from back to
    // front; what cannot be had is appended to record.faults. `onBatch` is called after each batch.
    void draw(const hlod::View& view, std::span<const hlod::Node> leaves, hlod::FrameRecord& record,
              const std::function<void()>& onBatch);

private:
    void inBatches(std::span<const hlod::Node> nodes, hlod::FrameRecord& record,
                   const std::function<void(std::span<const hlod::Node>)>& drawBatch,
                   const std::function<void()>& onBatch);
    void readAhead(std::span<const hlod::Node> nodes);
    [[nodiscard]] cache::LoadResult take(uint64_t ticket);

    const cache::PageSource& source_;
    cache::LoadQueue& loads_;
    GlDevice& device_;
    std::map<uint64_t, cache::LoadResult> arrived_;  // by ticket
    uint64_t firstTicket_ = 0, nextTicket_ = 0;      // tickets of the run in progress
    size_t sent_ = 0;
};

// Copies of the records of all leaves that meet the frustum, by page id, and their boxes: blocks
// of the index may come and go meanwhile.
struct LeafList {
    std::vector<ooc::NodeRecord> records;
    std::vector<Box3d> boxesModel;
    std::vector<hlod::Node> nodes;  // into the two
    std::vector<std::string> faults;
    uint64_t visitedNodes = 0, culledNodes = 0;
};
[[nodiscard]] LeafList leavesInFrustum(const hlod::View& view, const ooc::Lattice& lattice,
                                       const cache::PageSource& source);

}  // namespace pagoda::viewer
