#include "tools/bench/live.h"

#include "cache/page_source.h"
#include "ooc/base/progress.h"

#include <algorithm>
#include <optional>

namespace pagoda::tools {
namespace {

void add(LivePass& pass, const hlod::FrameRecord& record) {
    const double share = record.coveredPixels > 0 ? static_cast<double>(record.fallbackPixels) /
                                                        static_cast<double>(record.coveredPixels)
                                                  : 0.0;
    ++pass.frames;
    pass.coveredPixels += record.coveredPixels;
    pass.fallbackPixels += record.fallbackPixels;
    pass.worstFallbackShare = std::max(pass.worstFallbackShare, share);
    pass.fallbackFrames += record.fallbackPixels > 0;
    pass.missingPages += record.missingPages;
    pass.fallbackShareSeries.push_back(share);
}

void addHoles(LivePass& pass, const DrawnPicture& drawn, viewer::Renderer& leaves,
              const hlod::Camera& camera, const viewer::RenderOptions& look) {
    hlod::FrameRecord reference = leaves.renderReference(camera, look);
    const uint64_t holes = countHoles(drawn, leaves.read(reference));
    pass.referenceFaults.insert(pass.referenceFaults.end(), reference.faults.begin(),
                                reference.faults.end());
    ++pass.referenceFrames;
    pass.holes += holes;
    pass.holeFrames += holes > 0;
}

}  // namespace

LivePass runLive(const BenchPlan& plan, const BenchConfiguration& configuration,
                 const std::string& strategyName, const ooc::Database& database,
                 Progress& progress) {
    cache::ManualClock clock;
    const cache::DatabaseSource source(database);
    viewer::RendererOptions options = plan.runtime.rendererOptions();
    options.queryLatencyFrames = configuration.queryLatencyFrames;
    options.clock = &clock;
    viewer::Renderer renderer(database.header().lattice, source, options);
    const auto strategy = hlod::makeStrategy(strategyName, plan.runtime.strategyOptions());
    const viewer::RenderOptions look{configuration.tauPx, {}, plan.worldUp};
    std::optional<viewer::Renderer> leaves;
    if (plan.referenceEvery > 0) {
        leaves.emplace(database.header().lattice, source, plan.runtime.rendererOptions());
    }
    LivePass pass;
    for (size_t i = 0; i < configuration.path.frames.size(); ++i) {
        progress.check();
        const hlod::Camera camera = configuration.camera(i);
        if (i == 0) static_cast<void>(renderer.render(camera, *strategy, look));
        hlod::FrameRecord record = renderer.renderLive(camera, *strategy, look);
        const DrawnPicture drawn = readDrawn(renderer, record);
        add(pass, record);
        if (leaves && i % static_cast<size_t>(plan.referenceEvery) == 0) {
            addHoles(pass, drawn, *leaves, camera, look);
        }
        clock.advance(1.0 / configuration.path.framesPerSecond);
        progress.advance(1);
    }
    const cache::Residency::Counters& counters =
        renderer.runner().streaming().residency().counters();
    pass.pageBytesRead = counters.bytesRead;
    pass.prefetch = counters.prefetch;
    pass.prefetchedBlocks = renderer.runner().streaming().prefetchedBlocks();
    return pass;
}

}  // namespace pagoda::tools
