#include "hlod/view/frame_record.h"

#include <nlohmann/json.hpp>

namespace pagoda::hlod {

std::string frameRecordToJson(const FrameRecord& record) {
    const nlohmann::ordered_json json = {
        {"strategy", record.strategy},
        {"width", record.widthPx},
        {"height", record.heightPx},
        {"tau", record.tauPx},
        {"effective_tau", record.effectiveTauPx},
        {"visited_nodes", record.visitedNodes},
        {"culled_nodes", record.culledNodes},
        {"drawn_nodes", record.drawnNodes},
        {"drawn_triangles", record.drawnTriangles},
        {"drawn_zippers", record.drawnZippers},
        {"translucent_triangles", record.translucentTriangles},
        {"stand_ins", record.standIns},
        {"queries", record.queries},
        {"covered_pixels", record.coveredPixels},
        {"loaded_pages", record.loadedPages},
        {"bytes_read", record.bytesRead},
        {"bytes_uploaded", record.bytesUploaded},
        {"evicted_pages", record.evictedPages},
        {"index_blocks", record.indexBlocks},
        {"index_bytes", record.indexBytes},
        {"gpu_bytes", record.gpuBytes},
        {"host_bytes", record.hostBytes},
        {"traverse_ms", record.traverseMs},
        {"draw_ms", record.drawMs},
        {"read_ms", record.readMs},
        {"faults", record.faults},
    };
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace pagoda::hlod
