#include "hlod/view/frame_cut.h"

namespace pagoda::hlod {

void FrameCut::clear() {
    drawn_.clear();
    refined_.clear();
}

void FrameCut::refine(const Node& node) {
    refined_.emplace(node.page(), node);
}

void FrameCut::draw(const Node& node) {
    drawn_.push_back(node);
    if (node.isLeaf()) refine(node);
}

}  // namespace pagoda::hlod
