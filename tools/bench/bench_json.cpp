#include "tools/bench/bench.h"
#include "tools/bench/ratios.h"
#include "tools/bench/report_file.h"

#include <fmt/format.h>

namespace pagoda::tools {
namespace {

double share(uint64_t part, uint64_t whole) {
    return whole > 0 ? shown(static_cast<double>(part) / static_cast<double>(whole)) : 0.0;
}

Json toJson(const cache::PrefetchCount& count) {
    return {{"bytes", count.bytes},
            {"used", count.usedBytes},
            {"precision", share(count.usedBytes, count.bytes)}};
}

Json toJson(const LivePass& pass) {
    const cache::PrefetchCount all = sumOf(pass.prefetch);
    Json json = {{"frames", pass.frames},
                 {"covered_pixels", pass.coveredPixels},
                 {"fallback_pixels", pass.fallbackPixels},
                 {"fallback_share", share(pass.fallbackPixels, pass.coveredPixels)},
                 {"fallback_share_worst", shown(pass.worstFallbackShare)},
                 {"fallback_frames", pass.fallbackFrames},
                 {"missing_pages", pass.missingPages},
                 {"page_bytes_read", pass.pageBytesRead},
                 {"prefetched_bytes", all.bytes},
                 {"used_prefetched_bytes", all.usedBytes},
                 {"prefetch_precision", share(all.usedBytes, all.bytes)},
                 {"reference_frames", pass.referenceFrames},
                 {"holes", pass.holes},
                 {"hole_frames", pass.holeFrames}};
    for (size_t i = 0; i < pass.prefetch.size(); ++i) {
        json["prefetch"][hlod::kPrefetchReasonNames[i]] = toJson(pass.prefetch[i]);
    }
    json["prefetch"]["blocks"] = toJson(pass.prefetchedBlocks);
    return json;
}

Json toJson(const StillPass& pass) {
    return {{"frames", pass.frames},
            {"covered_pixels", pass.coveredPixels},
            {"coarser_pixels", pass.coarser.coarser()},
            {"coarser_frames", pass.coarserFrames},
            {"coarser_by_others", pass.coarser.byOthers},
            {"coarser_by_stand_ins", pass.coarser.byStandIns},
            {"coarser_by_tau", pass.coarser.byTau}};
}

Json toJson(const BenchRun& run) {
    Json json = {
        {"strategy", run.strategy},
        {"tau", run.tauPx},
        {"path", run.pathName},
        {"width", run.widthPx},
        {"height", run.heightPx},
        {"query_latency", run.queryLatencyFrames},
        {"frames", run.frames},
        {"repeats", run.repeats},
        {"drawn_nodes", shown(run.drawnNodes)},
        {"drawn_triangles", shown(run.drawnTriangles)},
        {"queries", shown(run.queries)},
        {"rarn", shown(run.rarn)},
        {"delayed", shown(run.delayed)},
        {"risen", shown(run.risen)},
        {"waits", shown(run.waits)},
        {"visited_nodes", shown(run.visitedNodes)},
        {"hidden_nodes", shown(run.hiddenNodes)},
        {"stop_hidden", shown(run.stopHidden)},
        {"delay_hidden", shown(run.delayHidden)},
        {"missing_pages", shown(run.missingPages)},
        {"effective_tau", shown(run.effectiveTauPx)},
        {"simulated_stall_ms", shown(run.stallMs)},
        {"truth_frames", run.truthFrames},
        {"wrong_pixels", shown(run.wrongPixels)},
        {"tied_pixels", shown(run.tiedPixels)},
        {"rarn_pixels", shown(run.overdrawnPixels)},
        {"covered_pixels", shown(run.coveredPixels)},
        {"truth_missing_pages", shown(run.truthMissingPages)},
        {"psnr_luma", shown(run.psnrLuma)},
        {"psnr_cb", shown(run.psnrCb)},
        {"psnr_cr", shown(run.psnrCr)},
        {"psnr_luma_worst", shown(run.worstPsnrLuma)},
        {"reference_frames", run.referenceFrames},
        {"reference_id_differences", shown(run.referenceIdDifferences)},
        {"psnr_luma_reference", shown(run.psnrLumaReference)},
        {"holes", run.holes},
        {"hole_frames", run.holeFrames},
    };
    json["frame_ms"] = numbersJson(run.frameMs);
    json["frame_ms"]["traverse"] = shown(run.traverseMs.median);
    json["frame_ms"]["query"] = shown(run.queryMs.median);
    json["frame_ms"]["draw"] = shown(run.drawMs.median);
    json["frame_ms"]["upload"] = shown(run.streamMs.median);
    json["cpu_ms"] = numbersJson(run.cpuMs);
    json["bytes_read"] = run.bytesRead;
    json["page_bytes_read"] = run.pageBytesRead;
    json["bytes_exact"] = run.bytesExact;
    json["bytes_drawn"] = run.bytesDrawn;
    json["unsettled_frames"] = run.unsettledFrames;
    json["gpu_bytes_peak"] = run.gpuBytesPeak;
    json["host_bytes_peak"] = run.hostBytesPeak;
    json["live"] = toJson(run.live);
    json["still"] = toJson(run.still);
    json["faults"] = run.faults;
    json["series"] = {{"frame_ms", numbersJson(run.frameMsSeries)},
                      {"cpu_ms", numbersJson(run.cpuMsSeries)},
                      {"drawn_nodes", numbersJson(run.drawnNodesSeries)},
                      {"psnr_luma", numbersJson(run.psnrLumaSeries)},
                      {"fallback_share", numbersJson(run.live.fallbackShareSeries)}};
    return json;
}

// CPU time of every strategy over every other one: how many times as fast the other is.
Json ratiosJson(const std::vector<BenchRun>& runs) {
    Json ratios = Json::array();
    for (const CpuRatio& cpu : cpuRatios(runs)) {
        const BenchRun& slow = runs[cpu.numerator];
        ratios.push_back({{"path", slow.pathName},
                          {"tau", slow.tauPx},
                          {"width", slow.widthPx},
                          {"height", slow.heightPx},
                          {"query_latency", slow.queryLatencyFrames},
                          {"of", "cpu_ms"},
                          {"numerator", slow.strategy},
                          {"denominator", runs[cpu.denominator].strategy},
                          {"frames", cpu.isHardest ? "hardest" : "all"},
                          {"ratio", shown(cpu.ratio.value)},
                          {"low", shown(cpu.ratio.low)},
                          {"high", shown(cpu.ratio.high)},
                          {"pairs", cpu.ratio.pairs}});
    }
    return ratios;
}

}  // namespace

std::string benchToJson(const BenchPlan& plan, const std::vector<BenchRun>& runs,
                        const std::string& device) {
    Json list = Json::array();
    for (const BenchRun& run : runs) list.push_back(toJson(run));
    Json json = headJson(plan, device);
    json["settings"].update({{"host_budget", plan.runtime.hostBudget},
                             {"gpu_budget", plan.runtime.gpuBudget},
                             {"upload_budget", plan.runtime.uploadBudget},
                             {"pyramid", plan.runtime.pyramid},
                             {"push_occluders", plan.runtime.pushOccluders == "on"},
                             {"disk", plan.runtime.disk},
                             {"speed", plan.speed},
                             {"repeats", plan.repeats},
                             {"truth_every", plan.truthEvery},
                             {"reference_every", plan.referenceEvery},
                             {"still_every", plan.stillEvery}});
    json["runs"] = list;
    json["ratios"] = ratiosJson(runs);
    return json.dump(1);
}

std::string benchToCsv(const std::vector<BenchRun>& runs) {
    std::vector<Json> rows;
    for (const BenchRun& run : runs) {
        rows.push_back(toJson(run));
        rows.back().erase("series");
    }
    return csvOf(rows);
}

}  // namespace pagoda::tools
