#include "tools/bench/bench.h"

#include "cache/page_source.h"
#include "hlod/strategies/preload.h"
#include "hlod/strategies/replay.h"
#include "ooc/base/progress.h"
#include "ooc/store/database.h"
#include "tools/bench/live.h"
#include "tools/bench/still.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>

namespace pagoda::tools {
namespace {

// The truth is drawn from a renderer of its own, with room for whatever it wants.
constexpr uint64_t kTruthHostBytes = uint64_t{1} << 30;
constexpr uint64_t kTruthGpuBytes = uint64_t{8} << 30;

// Means are summed first.
void addTimed(BenchRun& run, const hlod::FrameRecord& record) {
    const auto add = [](double& sum, auto value) { sum += static_cast<double>(value); };
    add(run.drawnNodes, record.drawnNodes);
    add(run.drawnTriangles, record.drawnTriangles);
    add(run.queries, record.queries);
    add(run.rarn, record.rarnNodes);
    add(run.delayed, record.delayedNodes);
    add(run.risen, record.risenNodes);
    add(run.waits, record.waits);
    add(run.visitedNodes, record.visitedNodes);
    add(run.hiddenNodes, record.hiddenNodes);
    add(run.missingPages, record.missingPages);
    add(run.effectiveTauPx, record.effectiveTauPx);
    add(run.stopHidden, record.predictions.stopHidden);
    add(run.delayHidden, record.predictions.delayHidden);
    add(run.stallMs, record.simulatedStallMs);
    run.frameMsSeries.push_back(record.frameMs);
    run.cpuMsSeries.push_back(record.cpuMs);
}

void divide(BenchRun& run) {
    const auto timed = static_cast<double>(std::max<size_t>(run.frameMsSeries.size(), 1));
    for (double* sum :
         {&run.drawnNodes, &run.drawnTriangles, &run.queries, &run.rarn, &run.delayed, &run.risen,
          &run.waits, &run.visitedNodes, &run.hiddenNodes, &run.missingPages, &run.effectiveTauPx,
          &run.stopHidden, &run.delayHidden, &run.stallMs}) {
        *sum /= timed;
    }
    const auto truth = static_cast<double>(std::max<size_t>(run.truthFrames, 1));
    for (double* sum : {&run.wrongPixels, &run.tiedPixels, &run.overdrawnPixels, &run.coveredPixels,
                        &run.psnrLuma, &run.psnrCb, &run.psnrCr}) {
        *sum /= truth;
    }
    const auto reference = static_cast<double>(std::max<size_t>(run.referenceFrames, 1));
    run.referenceIdDifferences /= reference;
    run.psnrLumaReference /= reference;
}

struct NodeHash {
    size_t operator()(ooc::NodeId node) const {
        return cache::PageIdHash{}(cache::PageId{0, node});
    }
};
using NodeSet = std::unordered_set<ooc::NodeId, NodeHash>;
using PageBytes = std::unordered_map<ooc::NodeId, uint32_t, NodeHash>;

struct Parts {
    std::vector<double> traverse, query, draw, stream;
};

class Contestant {
public:
    Contestant(const BenchPlan& plan, const BenchConfiguration& configuration,
               const std::string& name, const ooc::Database& database,
               const cache::PageSource& source)
        : renderer_(database.header().lattice, source, options(plan, configuration)),
          strategy_(hlod::makeStrategy(name, plan.runtime.strategyOptions())) {
        run_.strategy = name;
        run_.pathName = configuration.pathName;
        run_.tauPx = configuration.tauPx;
        run_.widthPx = configuration.widthPx;
        run_.heightPx = configuration.heightPx;
        run_.queryLatencyFrames = configuration.queryLatencyFrames;
        run_.frames = configuration.path.frames.size();
        run_.repeats = plan.repeats;
    }

    void forget() { strategy_->forget(); }
    void setLive(LivePass pass) {
        addFaults(pass.referenceFaults);
        run_.live = std::move(pass);
    }
    void setStill(StillPass pass) {
        addFaults(pass.faults);
        run_.still = std::move(pass);
    }

    // Each once.
    void addFaults(const std::vector<std::string>& faults) {
        for (const std::string& fault : faults) {
            if (std::find(run_.faults.begin(), run_.faults.end(), fault) == run_.faults.end()) {
                run_.faults.push_back(fault);
            }
        }
    }

    void settle(const hlod::Camera& camera, const viewer::RenderOptions& options) {
        hlod::FrameRecord record = renderer_.render(camera, *strategy_, options);
        const viewer::Picture picture = renderer_.read(record);
        run_.unsettledFrames += !record.isSettled;
        notePeaks(record);
        addFaults(record.faults);
        std::vector<bool> isSeen(picture.nodes.size() + 1, false);
        for (const uint32_t ordinal : picture.nodeOrdinals) isSeen[ordinal] = true;
        for (size_t i = 0; i < picture.nodes.size(); ++i) {
            addWithAncestors(drawn_, picture.nodes[i]);
            if (isSeen[i + 1]) addWithAncestors(exact_, picture.nodes[i]);
        }
    }

    void endSettled(const PageBytes& pageBytes) {
        const cache::RequestQueue::Counters& counters =
            renderer_.runner().streaming().requests().counters();
        run_.bytesRead = counters.bytesRead - counters.blockBytesRead;
        run_.pageBytesRead = renderer_.runner().streaming().residency().counters().bytesRead;
        for (const ooc::NodeId node : exact_) run_.bytesExact += pageBytes.at(node);
        for (const ooc::NodeId node : drawn_) run_.bytesDrawn += pageBytes.at(node);
    }

    // Everything down to the cut at tau; what does not fit is missing later, and counted.
    void preload(const hlod::Camera& camera, const viewer::RenderOptions& options) {
        hlod::PreloadStrategy all;
        static_cast<void>(renderer_.render(camera, all, options));
    }

    [[nodiscard]] bool learnsWhatIsHidden() const { return strategy_->learnsWhatIsHidden(); }

    hlod::FrameRecord live(const hlod::Camera& camera, const viewer::RenderOptions& options) {
        hlod::FrameRecord record = renderer_.renderLive(camera, *strategy_, options);
        notePeaks(record);
        return record;
    }

    // `leaves` is null in frames that are not held against the leaves.
    void compare(hlod::FrameRecord& record, viewer::Renderer& truth, const hlod::Camera& camera,
                 const viewer::RenderOptions& options, const viewer::Picture& tauPicture,
                 const viewer::Picture* leaves) {
        const DrawnPicture drawn = readDrawn(renderer_, record);
        const viewer::Picture& picture = drawn.picture;
        hlod::ReplayStrategy replay(renderer_.runner().cut());
        viewer::RenderOptions same = options;
        same.tauPx = record.effectiveTauPx;
        hlod::FrameRecord truthRecord = truth.render(camera, replay, same);
        const viewer::Picture truthPicture = truth.read(truthRecord);
        const WrongPixels wrong = countWrongPixels(picture, truthPicture, [&](ooc::NodeId node) {
            return replay.overdrawn().contains(cache::PageId{0, node});
        });
        const Psnr quality = psnr(picture, tauPicture);
        run_.wrongPixels += static_cast<double>(wrong.wrong);
        run_.tiedPixels += static_cast<double>(wrong.tied);
        run_.overdrawnPixels += static_cast<double>(wrong.overdrawn);
        run_.coveredPixels += static_cast<double>(record.coveredPixels);
        run_.truthMissingPages += static_cast<double>(record.missingPages);
        run_.psnrLumaSeries.push_back(quality.luma);
        run_.psnrLuma += quality.luma;
        run_.psnrCb += quality.cb;
        run_.psnrCr += quality.cr;
        run_.worstPsnrLuma =
            run_.truthFrames == 0 ? quality.luma : std::min(run_.worstPsnrLuma, quality.luma);
        ++run_.truthFrames;
        if (leaves != nullptr) compareWithLeaves(drawn, *leaves);
    }

    void time(const hlod::Camera& camera, const viewer::RenderOptions& options, bool isLast) {
        const hlod::FrameRecord record = live(camera, options);
        addTimed(run_, record);
        parts_.traverse.push_back(record.traverseMs);
        parts_.query.push_back(record.queryMs);
        parts_.draw.push_back(record.drawMs);
        parts_.stream.push_back(record.streamMs);
        if (isLast) run_.drawnNodesSeries.push_back(static_cast<double>(record.drawnNodes));
    }

    BenchRun finish() {
        divide(run_);
        run_.frameMs = spreadOf(run_.frameMsSeries);
        run_.cpuMs = spreadOf(run_.cpuMsSeries);
        run_.traverseMs = spreadOf(parts_.traverse);
        run_.queryMs = spreadOf(parts_.query);
        run_.drawMs = spreadOf(parts_.draw);
        run_.streamMs = spreadOf(parts_.stream);
        return std::move(run_);
    }

private:
    void compareWithLeaves(const DrawnPicture& drawn, const viewer::Picture& leaves) {
        run_.referenceIdDifferences +=
            static_cast<double>(countDifferentIds(drawn.picture, leaves));
        run_.psnrLumaReference += psnr(drawn.picture, leaves).luma;
        const uint64_t holes = countHoles(drawn, leaves);
        run_.holes += holes;
        run_.holeFrames += holes > 0;
        ++run_.referenceFrames;
    }
    static viewer::RendererOptions options(const BenchPlan& plan,
                                           const BenchConfiguration& configuration) {
        viewer::RendererOptions options = plan.runtime.rendererOptions();
        options.queryLatencyFrames = configuration.queryLatencyFrames;
        return options;
    }
    static void addWithAncestors(NodeSet& nodes, ooc::NodeId node) {
        while (nodes.insert(node).second && node != ooc::NodeId::root()) node = node.parent();
    }
    void notePeaks(const hlod::FrameRecord& record) {
        run_.gpuBytesPeak = std::max(run_.gpuBytesPeak, record.gpuBytes);
        run_.hostBytesPeak = std::max(run_.hostBytesPeak, record.hostBytes);
    }
    viewer::Renderer renderer_;
    std::unique_ptr<hlod::Strategy> strategy_;
    BenchRun run_;
    Parts parts_;
    NodeSet exact_, drawn_;
};

PageBytes pageBytesOf(const ooc::Database& database) {
    PageBytes bytes;
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            bytes.emplace(node.id, node.pageBytes);
            return true;
        },
        [](uint32_t, const std::string&) {});
    return bytes;
}

// What the contestants' pictures are held against.
struct Judges {
    Judges(const BenchPlan& plan, const ooc::Database& database, const cache::PageSource& source)
        : truth(database.header().lattice, source, roomy()),
          frustum(hlod::makeStrategy("frustum")) {
        if (plan.referenceEvery > 0) {
            leaves.emplace(database.header().lattice, source, plan.runtime.rendererOptions());
        }
    }
    static viewer::RendererOptions roomy() {
        viewer::RendererOptions options;
        options.hostBytes = kTruthHostBytes;
        options.gpuBytes = kTruthGpuBytes;
        return options;
    }

    viewer::Renderer truth;
    std::unique_ptr<hlod::Strategy> frustum;
    std::optional<viewer::Renderer> leaves;
};

class Bench {
public:
    Bench(const BenchPlan& plan, const BenchConfiguration& configuration, Progress& progress)
        : plan_(plan),
          configuration_(configuration),
          progress_(progress),
          database_(ooc::Database::open(plan.database)),
          source_(database_) {
        options_.tauPx = configuration.tauPx;
        options_.worldUp = plan.worldUp;
        for (const std::string& name : plan.strategies) {
            contestants_.push_back(
                std::make_unique<Contestant>(plan, configuration, name, database_, source_));
        }
    }

    std::vector<BenchRun> run() {
        const size_t frames = configuration_.path.frames.size();
        const bool isResident = plan_.truthEvery > 0 || plan_.repeats > 0;
        const bool isLive = !plan_.runtime.rendererOptions().disk.isAsIs();
        const size_t passes = size_t{plan_.doesSettle} + (isLive ? contestants_.size() : 0) +
                              size_t{plan_.truthEvery > 0} + size_t{isResident} +
                              static_cast<size_t>(plan_.repeats);
        const size_t stillFrames =
            plan_.stillEvery > 0 ? contestants_.size() * stillPassFrames(plan_, configuration_) : 0;
        progress_.beginStage(
            fmt::format("{}, tau {:g}, {}x{}", configuration_.pathName, configuration_.tauPx,
                        configuration_.widthPx, configuration_.heightPx),
            frames * passes + stillFrames, "frames");
        if (plan_.doesSettle) settled();
        if (isLive) live();
        if (plan_.stillEvery > 0) still();
        if (isResident) preload();
        if (plan_.truthEvery > 0) truth();
        timed();
        std::vector<BenchRun> runs;
        for (auto& contestant : contestants_) runs.push_back(contestant->finish());
        return runs;
    }

private:
    template <typename Visit>
    void eachFrame(Visit&& visit) {
        for (auto& contestant : contestants_) contestant->forget();
        for (size_t i = 0; i < configuration_.path.frames.size(); ++i) {
            progress_.check();
            visit(i, configuration_.camera(i));
            progress_.advance(1);
        }
    }

    void settled() {
        eachFrame([&](size_t, const hlod::Camera& camera) {
            for (auto& contestant : contestants_) contestant->settle(camera, options_);
        });
        const PageBytes bytes = pageBytesOf(database_);
        for (auto& contestant : contestants_) contestant->endSettled(bytes);
    }

    void live() {
        for (size_t i = 0; i < contestants_.size(); ++i) {
            contestants_[i]->setLive(
                runLive(plan_, configuration_, plan_.strategies[i], database_, progress_));
        }
    }

    void still() {
        for (size_t i = 0; i < contestants_.size(); ++i) {
            contestants_[i]->setStill(
                runStill(plan_, configuration_, plan_.strategies[i], database_, progress_));
        }
    }

    // Culling is compared as if the whole model were there: a child that was never looked at must
    // not be missing when the camera turns to it.
    void preload() {
        eachFrame([&](size_t, const hlod::Camera& camera) {
            for (auto& contestant : contestants_) contestant->preload(camera, options_);
        });
    }

    void truth() {
        Judges judges(plan_, database_, source_);
        const auto every = static_cast<size_t>(plan_.truthEvery);
        eachFrame([&](size_t i, const hlod::Camera& camera) {
            const bool isCompared = i % every == 0;
            std::vector<hlod::FrameRecord> records;
            for (auto& contestant : contestants_) {
                // In between only those go on that learn from what they see.
                if (!isCompared && !contestant->learnsWhatIsHidden()) continue;
                records.push_back(contestant->live(camera, options_));
            }
            if (isCompared) judge(judges, camera, records, i / every);
        });
    }

    void judge(Judges& judges, const hlod::Camera& camera, std::vector<hlod::FrameRecord>& records,
               size_t truthFrame) {
        hlod::FrameRecord record = judges.truth.render(camera, *judges.frustum, options_);
        const viewer::Picture tauPicture = judges.truth.read(record);
        std::optional<viewer::Picture> leaves;
        if (judges.leaves && truthFrame % static_cast<size_t>(plan_.referenceEvery) == 0) {
            hlod::FrameRecord reference = judges.leaves->renderReference(camera, options_);
            leaves = judges.leaves->read(reference);
            for (auto& contestant : contestants_) contestant->addFaults(reference.faults);
        }
        for (size_t k = 0; k < contestants_.size(); ++k) {
            contestants_[k]->compare(records[k], judges.truth, camera, options_, tauPicture,
                                     leaves ? &*leaves : nullptr);
        }
    }

    void timed() {
        for (int repeat = 0; repeat < plan_.repeats; ++repeat) {
            eachFrame([&](size_t i, const hlod::Camera& camera) {
                // Who begins changes from frame to frame: what the one before left in caches is not
                // always the same one's.
                for (size_t k = 0; k < contestants_.size(); ++k) {
                    contestants_[(k + i) % contestants_.size()]->time(camera, options_,
                                                                      repeat + 1 == plan_.repeats);
                }
            });
        }
    }

    const BenchPlan& plan_;
    const BenchConfiguration& configuration_;
    Progress& progress_;
    ooc::Database database_;
    cache::DatabaseSource source_;
    viewer::RenderOptions options_;
    std::vector<std::unique_ptr<Contestant>> contestants_;
};

}  // namespace

hlod::Camera BenchConfiguration::camera(size_t frame) const {
    hlod::Camera camera = path.frames[frame];
    camera.widthPx = widthPx;
    camera.heightPx = heightPx;
    return camera;
}

std::vector<BenchRun> runBench(const BenchPlan& plan, const BenchConfiguration& configuration,
                               Progress& progress) {
    return Bench(plan, configuration, progress).run();
}

}  // namespace pagoda::tools
