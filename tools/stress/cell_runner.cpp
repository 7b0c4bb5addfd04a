#include "tools/stress/cell_runner.h"

#include "cache/thread_loads.h"
#include "hlod/strategies/preload.h"
#include "tools/bench/truth.h"

#include <algorithm>
#include <ctime>

namespace pagoda::tools {
namespace {

// What is resident has room for whatever it wants.
constexpr uint64_t kRoomyHostBytes = uint64_t{1} << 30;
constexpr uint64_t kRoomyGpuBytes = uint64_t{8} << 30;
// As FrameRunner sees it: the frame that asks, and the one that uploads.
constexpr double kFramesOfALevel = 2;

double processCpuMs() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

bool isComplete(const hlod::FrameRecord& record) {
    return record.missingPages == 0 && record.standIns == 0 && record.drawnNodes > 0;
}

}  // namespace

CellRunner::CellRunner(const CellSetting& setting, const std::optional<StressDisk>& disk,
                       uint64_t gpuBytes)
    : setting_(setting), frameS_(1 / setting.plan.framesPerSecond) {
    cell_.workload = setting.workload;
    cell_.madeOf = setting.madeOf;
    cell_.isResident = !disk;
    cell_.disk = disk ? *disk : StressDisk{"all resident", ""};
    if (disk) {
        profile_ = cache::parseDiskProfile(disk->profile);
        profile_.seed = setting.plan.seed;
    }
    renderer_ = std::make_unique<viewer::Renderer>(setting.database.header().lattice,
                                                   setting.source, rendererOptions(gpuBytes));
    const cache::Residency& residency = renderer_->runner().streaming().residency();
    cell_.gpuBudget = residency.gpuBudgetBytes();
    strategy_ =
        hlod::makeStrategy(setting.plan.runtime.strategy, setting.plan.runtime.strategyOptions());
    renderOptions_.tauPx = setting.plan.runtime.tauPx;
    if (setting.plan.up == hlod::UpAxis::Z) renderOptions_.worldUp = {0, 0, 1};
}

viewer::RendererOptions CellRunner::rendererOptions(uint64_t gpuBytes) {
    viewer::RendererOptions options = setting_.plan.runtime.rendererOptions();
    if (cell_.isResident) {
        options.hostBytes = std::max(options.hostBytes, kRoomyHostBytes);
        options.gpuBytes = std::max(options.gpuBytes, kRoomyGpuBytes);
        options.uploadBytesPerFrame = 0;
    } else if (gpuBytes > 0) {
        options.gpuBytes = gpuBytes;
    }
    auto meter = std::make_unique<MeteredLoads>(std::make_unique<cache::ThreadLoads>(
        std::vector<const cache::PageSource*>{&setting_.source}, options.loaderThreads));
    meter_ = meter.get();
    disk_ = std::make_unique<cache::DiskLoads>(std::move(meter), profile_, clock_);
    options.loads = disk_.get();
    options.clock = &clock_;
    cell_.hostBudget = options.hostBytes;
    cell_.uploadBudget = options.uploadBytesPerFrame;
    return options;
}

hlod::FrameRecord CellRunner::draw(const hlod::Camera& camera) {
    hlod::FrameRecord record = renderer_->renderLive(camera, *strategy_, renderOptions_);
    const double beginMs = processCpuMs();
    meter_->finishDecoding();
    cell_.decodeCpuMs += processCpuMs() - beginMs;
    clock_.advance(frameS_);
    return record;
}

uint64_t CellRunner::preload(const hlod::Camera& camera) {
    hlod::PreloadStrategy all;
    static_cast<void>(renderer_->render(camera, all, renderOptions_));
    const uint64_t neededBytes = draw(camera).demandBytes;
    cell_.decodeCpuMs = 0;
    return neededBytes;
}

void CellRunner::run(const hlod::Camera& camera) {
    if (frame_ == 0) strategy_->forget();
    const cache::Residency& residency = renderer_->runner().streaming().residency();
    const uint64_t uploadedBefore = residency.counters().uploadedPages;
    const bool isStill = lastCamera_ == camera;
    const bool isJumping = cell_.workload == "teleport";
    if (isJumping && !isStill) beginJump();
    hlod::FrameRecord record = draw(camera);
    DrawnPicture drawn = readDrawn(*renderer_, record);
    count(record);
    countBudgets(record, residency.counters().uploadedPages - uploadedBefore);
    countPixels(record, std::move(drawn), isStill);
    if (isJumping && !isComplete(record)) {
        sharpFrame_ = frame_ + 1;
        // What is read behind a sharp picture is read ahead of the next one.
        cell_.jumps.back().bytesRead = meter_->totals().bytes - bytesBefore_;
        cell_.jumps.back().levels = meter_->levelsRead();
    }
    lastCamera_ = camera;
    ++frame_;
}

void CellRunner::count(const hlod::FrameRecord& record) {
    cell_.frameMsSeries.push_back(record.frameMs);
    cell_.cpuMsSeries.push_back(record.cpuMs);
    cell_.tauSeries.push_back(record.effectiveTauPx);
    cell_.missingPages += record.missingPages;
    cell_.evictedPages += record.evictedPages;
    cell_.framesEmpty += record.drawnNodes == 0;
    for (const hlod::Node& node : renderer_->runner().cut().drawn()) drawn_.insert(node.record->id);
    for (const std::string& fault : record.faults) {
        if (std::find(cell_.faults.begin(), cell_.faults.end(), fault) == cell_.faults.end()) {
            cell_.faults.push_back(fault);
        }
    }
}

void CellRunner::countBudgets(const hlod::FrameRecord& record, uint64_t uploadedPages) {
    StressPeaks& peaks = cell_.peaks;
    peaks.gpuBytes = std::max(peaks.gpuBytes, record.gpuBytes);
    peaks.hostBytes = std::max(peaks.hostBytes, record.hostBytes);
    // The first page of a frame always goes, however large.
    const bool isAlone = uploadedPages == 1;
    uint64_t& uploadPeak = isAlone ? peaks.uploadBytesOfOnePage : peaks.uploadBytes;
    uploadPeak = std::max(uploadPeak, record.bytesUploaded);
    const bool isUploadOver =
        !isAlone && cell_.uploadBudget > 0 && record.bytesUploaded > cell_.uploadBudget;
    peaks.framesOver +=
        record.gpuBytes > cell_.gpuBudget || record.hostBytes > cell_.hostBudget || isUploadOver;
}

void CellRunner::countPixels(const hlod::FrameRecord& record, DrawnPicture drawn, bool isStill) {
    coveredPx_.push_back(static_cast<double>(record.coveredPixels));
    missingPx_.push_back(static_cast<double>(record.fallbackPixels));
    isEmpty_.push_back(record.drawnNodes == 0);
    if (isStill) cell_.coarserPixels += countCoarser(last_, drawn).coarser();
    last_ = std::move(drawn);
}

void CellRunner::beginJump() {
    endJump();
    cell_.jumps.push_back({.frame = frame_});
    sharpFrame_ = frame_;
    bytesBefore_ = meter_->totals().bytes;
    meter_->forgetLevels();
}

void CellRunner::endJump() {
    if (cell_.jumps.empty()) return;
    StressJump& jump = cell_.jumps.back();
    jump.isSharp = sharpFrame_ < frame_;
    jump.sharpS = static_cast<double>(sharpFrame_ - jump.frame) * frameS_;
    jump.boundS =
        static_cast<double>(jump.levels) * (profile_.latencyS + kFramesOfALevel * frameS_);
    if (profile_.bytesPerS > 0) {
        jump.boundS += static_cast<double>(jump.bytesRead) / profile_.bytesPerS;
    }
}

void CellRunner::countBytes() {
    const MeteredLoads::Totals& totals = meter_->totals();
    cell_.bytes.read = totals.bytes;
    cell_.bytes.index = totals.blockBytes;
    cell_.bytes.gaps = totals.gapBytes();
    for (const auto& [node, page] : meter_->pages()) {
        (drawn_.contains(node) ? cell_.bytes.drawn : cell_.bytes.wasted) += page.bytes;
        cell_.bytes.twice += (page.times - 1) * page.bytes;
    }
    const cache::DiskLoads::Counters& disk = disk_->counters();
    cell_.reads = disk.reads;
    cell_.failedReads = disk.failedReads;
    cell_.shortReads = disk.shortReads;
    const cache::RequestQueue::Counters& requests =
        renderer_->runner().streaming().requests().counters();
    cell_.retries = requests.retried;
    cell_.cancelled = requests.cancelled;
}

// Where nothing is drawn yet, what the next frame shows is missing.
void CellRunner::integratePixels() {
    for (size_t i = frame_; i-- > 0;) {
        if (isEmpty_[i] && i + 1 < frame_) coveredPx_[i] = coveredPx_[i + 1];
        if (isEmpty_[i]) missingPx_[i] = coveredPx_[i];
    }
    for (size_t i = 0; i < frame_; ++i) {
        cell_.coveredPxS += coveredPx_[i] * frameS_;
        cell_.missingPxS += missingPx_[i] * frameS_;
        cell_.framesMissing += missingPx_[i] > 0;
        cell_.missingShareSeries.push_back(coveredPx_[i] > 0 ? missingPx_[i] / coveredPx_[i] : 0);
    }
}

StressCell CellRunner::finish() {
    integratePixels();
    endJump();
    countBytes();
    cell_.frames = frame_;
    cell_.frameMs = spreadOf(cell_.frameMsSeries);
    cell_.cpuMs = spreadOf(cell_.cpuMsSeries);
    cell_.hitches = hitchesOf(cell_.frameMsSeries);
    cell_.cpuHitches = hitchesOf(cell_.cpuMsSeries);
    cell_.decodeCpuMs /= static_cast<double>(std::max<size_t>(frame_, 1));
    const Spread taus = spreadOf(cell_.tauSeries);
    cell_.meanTauPx = taus.mean;
    cell_.greatestTauPx = taus.max;
    const auto& series = cell_.tauSeries;
    cell_.leastTauPx = series.empty() ? 0 : *std::min_element(series.begin(), series.end());
    const auto& shares = cell_.missingShareSeries;
    cell_.worstMissingShare = shares.empty() ? 0 : *std::max_element(shares.begin(), shares.end());
    return std::move(cell_);
}

}  // namespace pagoda::tools
