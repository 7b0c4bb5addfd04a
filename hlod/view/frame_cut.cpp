#include "hlod/view/frame_cut.h"

namespace pagoda::hlod {
namespace {

// Finaliser of MurmurHash3: spreads ids that differ in few bits, so that sums do not collide.
uint64_t spread(uint64_t value) {
    value = (value ^ (value >> 33)) * 0xFF51AFD7ED558CCDull;
    value = (value ^ (value >> 33)) * 0xC4CEB9FE1A85EC53ull;
    return value ^ (value >> 33);
}

}  // namespace

void FrameCut::clear() {
    drawn_.clear();
    hidden_.clear();
    zipped_.clear();
    isStandIn_.clear();
    refined_.clear();
    drawnHash_ = toldHash_ = 0;
}

void FrameCut::tell(const Node& node, uint64_t what) {
    toldHash_ = spread(toldHash_ ^ (4 * spread(node.record->id.value + node.database) + what));
}

void FrameCut::refine(const Node& node) {
    tell(node, 0);
    if ((node.record->flags & ooc::kNodeHasZippers) == 0) return;
    if (refined_.insert(node.page()).second) zipped_.push_back(node);
}

void FrameCut::hide(const Node& node) {
    tell(node, 1);
    hidden_.push_back(node);
}

void FrameCut::draw(const Node& node, bool isStandIn) {
    tell(node, isStandIn ? 2 : 3);
    drawn_.push_back(node);
    isStandIn_.push_back(isStandIn);
    drawnHash_ += spread(node.record->id.value + (uint64_t{node.database} << 58));
    if (node.isLeaf()) refine(node);
}

}  // namespace pagoda::hlod
