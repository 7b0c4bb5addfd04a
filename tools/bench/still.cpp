#include "tools/bench/still.h"

#include "cache/page_source.h"
#include "hlod/strategies/preload.h"
#include "ooc/base/progress.h"

namespace pagoda::tools {
namespace {

class StillRunner {
public:
    StillRunner(const BenchPlan& plan, const BenchConfiguration& configuration,
                const std::string& strategy, const ooc::Database& database,
                const cache::PageSource& source, Progress& progress)
        : plan_(plan),
          configuration_(configuration),
          progress_(progress),
          renderer_(database.header().lattice, source, options(plan, configuration)),
          strategy_(hlod::makeStrategy(strategy, plan.runtime.strategyOptions())),
          look_{configuration.tauPx, {}, plan.worldUp} {}

    StillPass run() {
        hlod::PreloadStrategy all;
        const size_t frames = configuration_.path.frames.size();
        for (size_t i = 0; i < frames; ++i) {
            step();
            static_cast<void>(renderer_.render(configuration_.camera(i), all, look_));
        }
        for (size_t i = 0; i < frames; ++i) {
            step();
            hlod::FrameRecord record =
                renderer_.renderLive(configuration_.camera(i), *strategy_, look_);
            if (i % static_cast<size_t>(plan_.stillEvery) == 0) stop(i, record);
        }
        return pass_;
    }

private:
    static viewer::RendererOptions options(const BenchPlan& plan,
                                           const BenchConfiguration& configuration) {
        viewer::RendererOptions options = plan.runtime.rendererOptions();
        options.queryLatencyFrames = configuration.queryLatencyFrames;
        options.disk = {};
        return options;
    }

    void step() {
        progress_.check();
        progress_.advance(1);
    }

    // After `record` of the path's frame.
    void stop(size_t frame, hlod::FrameRecord& record) {
        const hlod::Camera camera = configuration_.camera(frame);
        DrawnPicture before = readDrawn(renderer_, record);
        const size_t count = stillFramesAtStop(configuration_.queryLatencyFrames);
        for (size_t i = 0; i < count; ++i) {
            step();
            hlod::FrameRecord still = renderer_.renderLive(camera, *strategy_, look_);
            pass_.faults = still.faults;  // all so far
            DrawnPicture now = readDrawn(renderer_, still);
            const CoarserPixels coarser = countCoarser(before, now);
            ++pass_.frames;
            pass_.coarserFrames += coarser.coarser() > 0;
            pass_.coveredPixels += still.coveredPixels;
            pass_.coarser.add(coarser);
            before = std::move(now);
        }
    }

    const BenchPlan& plan_;
    const BenchConfiguration& configuration_;
    Progress& progress_;
    viewer::Renderer renderer_;
    std::unique_ptr<hlod::Strategy> strategy_;
    viewer::RenderOptions look_;
    StillPass pass_;
};

}  // namespace

size_t stillPassFrames(const BenchPlan& plan, const BenchConfiguration& configuration) {
    const size_t frames = configuration.path.frames.size();
    const auto every = static_cast<size_t>(plan.stillEvery);
    const size_t stops = (frames + every - 1) / every;
    return 2 * frames + stops * stillFramesAtStop(configuration.queryLatencyFrames);
}

StillPass runStill(const BenchPlan& plan, const BenchConfiguration& configuration,
                   const std::string& strategy, const ooc::Database& database, Progress& progress) {
    const cache::DatabaseSource source(database);
    return StillRunner(plan, configuration, strategy, database, source, progress).run();
}

}  // namespace pagoda::tools
