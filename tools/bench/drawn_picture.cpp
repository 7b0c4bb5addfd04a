#include "tools/bench/drawn_picture.h"

#include <unordered_map>

namespace pagoda::tools {

DrawnPicture readDrawn(viewer::Renderer& renderer, hlod::FrameRecord& record) {
    DrawnPicture drawn;
    drawn.picture = renderer.read(record);
    drawn.tauPx = record.effectiveTauPx;
    const hlod::FrameCut& cut = renderer.runner().cut();
    drawn.isStandIn.assign(cut.drawnAsStandIn().begin(), cut.drawnAsStandIn().end());
    for (const hlod::Node& node : cut.drawn()) {
        drawn.errorsModelUnits.push_back(node.record->errorModelUnits);
    }
    // What follows the drawn nodes are owners of zippers.
    std::unordered_map<uint64_t, double> zippedErrors;
    for (const hlod::Node& node : cut.zipped()) {
        zippedErrors.emplace(node.record->id.value, node.record->errorModelUnits);
    }
    const std::vector<ooc::NodeId>& nodes = drawn.picture.nodes;
    for (size_t i = drawn.errorsModelUnits.size(); i < nodes.size(); ++i) {
        drawn.errorsModelUnits.push_back(zippedErrors.at(nodes[i].value));
        drawn.isStandIn.push_back(0);
    }
    return drawn;
}

}  // namespace pagoda::tools
