#include "tools/bench/report_file.h"
#include "tools/stress/stress.h"

namespace pagoda::tools {
namespace {

Json toJson(const StressBytes& bytes) {
    return {{"read", bytes.read},   {"drawn", bytes.drawn}, {"wasted", bytes.wasted},
            {"twice", bytes.twice}, {"index", bytes.index}, {"gaps", bytes.gaps}};
}

Json toJson(const StressPeaks& peaks) {
    return {{"gpu_bytes", peaks.gpuBytes},
            {"host_bytes", peaks.hostBytes},
            {"upload_bytes", peaks.uploadBytes},
            {"upload_bytes_of_one_page", peaks.uploadBytesOfOnePage},
            {"frames_over_budget", peaks.framesOver}};
}

Json toJson(const std::vector<StressJump>& jumps) {
    Json list = Json::array();
    for (const StressJump& jump : jumps) {
        list.push_back({{"frame", jump.frame},
                        {"is_sharp", jump.isSharp},
                        {"sharp_s", shown(jump.sharpS)},
                        {"bound_s", shown(jump.boundS)},
                        {"bytes_read", jump.bytesRead},
                        {"levels", jump.levels}});
    }
    return list;
}

Json summaryOf(const StressCell& cell) {
    const SharpTimes sharp = sharpTimesOf(cell);
    return {
        {"workload", cell.workload},
        {"path", cell.madeOf},
        {"disk", cell.disk.name},
        {"profile", cell.disk.profile},
        {"is_resident", cell.isResident},
        {"frames", cell.frames},
        {"budgets",
         {{"gpu_bytes", cell.gpuBudget},
          {"host_bytes", cell.hostBudget},
          {"upload_bytes", cell.uploadBudget},
          {"needed_gpu_bytes", cell.neededGpuBytes}}},
        {"frame_ms", numbersJson(cell.frameMs)},
        {"cpu_ms", numbersJson(cell.cpuMs)},
        {"hitches", {{"frame", cell.hitches}, {"cpu", cell.cpuHitches}}},
        {"p99_over_resident",
         {{"frame", shown(cell.frameP99OverResident)}, {"cpu", shown(cell.cpuP99OverResident)}}},
        {"decode_cpu_ms", shown(cell.decodeCpuMs)},
        {"missing_detail",
         {{"pixel_seconds", shown(cell.missingPxS)},
          {"covered_pixel_seconds", shown(cell.coveredPxS)},
          {"share", shown(cell.missingShare())},
          {"worst_share", shown(cell.worstMissingShare)},
          {"frames", cell.framesMissing}}},
        {"empty_frames", cell.framesEmpty},
        {"coarser_pixels", cell.coarserPixels},
        {"missing_pages", cell.missingPages},
        {"time_to_sharp",
         {{"jumps", cell.jumps.size()},
          {"sharp", sharp.count},
          {"median_s", shown(sharp.medianS)},
          {"max_s", shown(sharp.maxS)},
          {"worst_over_bound", shown(sharp.worstOverBound)}}},
        {"bytes", toJson(cell.bytes)},
        {"reads",
         {{"sent", cell.reads},
          {"failed", cell.failedReads},
          {"short", cell.shortReads},
          {"retries", cell.retries},
          {"cancelled", cell.cancelled}}},
        {"evicted_pages", cell.evictedPages},
        {"peaks", toJson(cell.peaks)},
        {"effective_tau",
         {{"least", shown(cell.leastTauPx)},
          {"mean", shown(cell.meanTauPx)},
          {"greatest", shown(cell.greatestTauPx)}}},
        {"faults", cell.faults.size()},
    };
}

}  // namespace

std::string stressToJson(const StressPlan& plan, const std::vector<StressCell>& cells,
                         const std::string& device) {
    Json list = Json::array();
    for (const StressCell& cell : cells) {
        Json json = summaryOf(cell);
        json["faults"] = cell.faults;
        json["jumps"] = toJson(cell.jumps);
        json["series"] = {{"frame_ms", numbersJson(cell.frameMsSeries)},
                          {"cpu_ms", numbersJson(cell.cpuMsSeries)},
                          {"missing_share", numbersJson(cell.missingShareSeries)},
                          {"effective_tau", numbersJson(cell.tauSeries)}};
        list.push_back(std::move(json));
    }
    Json json = headJson(plan, device);
    json["settings"].update(
        {{"strategy", plan.runtime.strategy},
         {"tau", plan.runtime.tauPx},
         {"query_latency", plan.runtime.queryLatencyFrames},
         {"width", plan.widthPx},
         {"height", plan.heightPx},
         {"frames", plan.frames},
         {"fps", plan.framesPerSecond},
         {"seed", plan.seed},
         {"hitch", {{"over_median", kHitchOverMedian}, {"over_ms", kHitchMs}}}});
    json["cells"] = list;
    return json.dump(1);
}

std::string stressToCsv(const std::vector<StressCell>& cells) {
    std::vector<Json> rows;
    rows.reserve(cells.size());
    for (const StressCell& cell : cells) rows.push_back(summaryOf(cell));
    return csvOf(rows);
}

}  // namespace pagoda::tools
