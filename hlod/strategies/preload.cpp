#include "hlod/strategies/preload.h"

#include <vector>

namespace pagoda::hlod {

void PreloadStrategy::traverse(FrameContext& frame) {
    std::vector<Node> pending;
    if (const auto root = frame.tree.root()) pending.push_back(*root);
    while (!pending.empty()) {
        const Node node = pending.back();
        pending.pop_back();
        if (!frame.view.intersectsFrustum(*node.boxModel)) continue;
        static_cast<void>(frame.sink.want(node, 1.0, Use::Cut));
        const double ssePx = frame.view.ssePx(node.record->errorModelUnits, *node.boxModel);
        if (frame.tauPx > 0.0 && ssePx <= frame.tauPx) continue;
        const NodeRange children = frame.tree.children(node, 1.0);
        for (uint32_t i = 0; i < children.size(); ++i) pending.push_back(children[i]);
    }
}

}  // namespace pagoda::hlod
