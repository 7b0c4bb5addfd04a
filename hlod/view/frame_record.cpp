#include "hlod/view/frame_record.h"

#include "hlod/view/prefetch.h"

#include <nlohmann/json.hpp>

namespace pagoda::hlod {
namespace {

nlohmann::ordered_json toJson(const cache::PrefetchCount& count) {
    return {{"bytes", count.bytes}, {"used", count.usedBytes}};
}

nlohmann::ordered_json prefetchJson(const FrameRecord& record) {
    nlohmann::ordered_json json;
    for (size_t i = 0; i < record.prefetch.size(); ++i) {
        json[kPrefetchReasonNames[i]] = toJson(record.prefetch[i]);
    }
    json["blocks"] = toJson(record.prefetchedBlocks);
    return json;
}

}  // namespace

std::string frameRecordToJson(const FrameRecord& record) {
    const PredictionCounts& predictions = record.predictions;
    const nlohmann::ordered_json json = {
        {"strategy", record.strategy},
        {"choice", record.choice},
        {"frame", record.frameIndex},
        {"width", record.widthPx},
        {"height", record.heightPx},
        {"tau", record.tauPx},
        {"effective_tau", record.effectiveTauPx},
        {"visited_nodes", record.visitedNodes},
        {"culled_nodes", record.culledNodes},
        {"hidden_nodes", record.hiddenNodes},
        {"drawn_nodes", record.drawnNodes},
        {"drawn_triangles", record.drawnTriangles},
        {"drawn_zippers", record.drawnZippers},
        {"translucent_triangles", record.translucentTriangles},
        {"stand_ins", record.standIns},
        {"queries", record.queries},
        {"delayed", record.delayedNodes},
        {"rarn", record.rarnNodes},
        {"risen", record.risenNodes},
        {"waits", record.waits},
        {"predictions",
         {{"refine", predictions.refine},
          {"stop", predictions.stop},
          {"delay", predictions.delay},
          {"stop_hidden", predictions.stopHidden},
          {"delay_hidden", predictions.delayHidden},
          {"delay_visible", predictions.delayVisible}}},
        {"covered_pixels", record.coveredPixels},
        {"fallback_pixels", record.fallbackPixels},
        {"missing_pages", record.missingPages},
        {"demand_bytes", record.demandBytes},
        {"loaded_pages", record.loadedPages},
        {"bytes_read", record.bytesRead},
        {"bytes_uploaded", record.bytesUploaded},
        {"evicted_pages", record.evictedPages},
        {"reloaded_pages", record.reloadedPages},
        {"prefetched_bytes", sumOf(record.prefetch).bytes},
        {"used_prefetched_bytes", sumOf(record.prefetch).usedBytes},
        {"prefetch", prefetchJson(record)},
        {"prefetch_off", record.prefetchOff},
        {"index_blocks", record.indexBlocks},
        {"index_bytes", record.indexBytes},
        {"gpu_bytes", record.gpuBytes},
        {"host_bytes", record.hostBytes},
        {"frame_ms", record.frameMs},
        {"stream_ms", record.streamMs},
        {"traverse_ms", record.traverseMs},
        {"query_ms", record.queryMs},
        {"draw_ms", record.drawMs},
        {"read_ms", record.readMs},
        {"simulated_stall_ms", record.simulatedStallMs},
        {"cpu_ms", record.cpuMs},
        {"is_settled", record.isSettled},
        {"faults", record.faults},
    };
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace pagoda::hlod
