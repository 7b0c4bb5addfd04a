#include "hlod/raster/software_device.h"

#include <cassert>

namespace pagoda::hlod {

void SoftwareDevice::beginFrame(const View& view) {
    raster_.begin(view);
    queries_.beginFrame(view);
    pyramid_.beginFrame(view);
    drawnNodes_ = drawnTriangles_ = 0;
}

void SoftwareDevice::draw(const Node& node) {
    const SoftwareMesh& mesh = pages_.mesh(node.page());
    raster_.draw(mesh, node.record->id);
    queries_.isStale_ = true;
    ++drawnNodes_;
    drawnTriangles_ += mesh.indices.size() / 3;
}

void SoftwareDevice::endFrame(const FrameCut&, FrameRecord& record) {
    record.drawnNodes += drawnNodes_;
    record.drawnTriangles += drawnTriangles_;
    record.queries += queries_.queries_;
    record.coveredPixels = picture().coveredPixels();
}

void SoftwareDevice::Queries::beginFrame(const View& view) {
    view_ = &view;
    isStale_ = true;
    queries_ = 0;
}

QueryTicket SoftwareDevice::Queries::query(const QueryShape& shape) {
    const auto* const together = std::get_if<std::vector<Box3d>>(&shape);
    assert(together != nullptr || std::holds_alternative<Box3d>(shape));
    if (isStale_) boxes_.setDepths(*view_, drawn_.picture().depths);
    isStale_ = false;
    ++queries_;
    const uint64_t ticket = nextTicket_++;
    uint64_t& pixels = answers_[ticket];
    if (together != nullptr) {
        for (const Box3d& box : *together) pixels += boxes_.visiblePixels(box);
    } else {
        pixels = boxes_.visiblePixels(std::get<Box3d>(shape));
    }
    return {ticket};
}

uint64_t SoftwareDevice::Queries::wait(QueryTicket ticket) {
    const auto found = answers_.find(ticket.value);
    assert(found != answers_.end());
    const uint64_t pixels = found->second;
    answers_.erase(found);
    return pixels;
}

void SoftwareDevice::Pyramid::build() {
    depths_ = drawn_.picture().depths;
    boxes_.setDepths(*view_, depths_);
}

}  // namespace pagoda::hlod
