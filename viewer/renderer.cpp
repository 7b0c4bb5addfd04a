#include "viewer/renderer.h"

#include "cache/thread_loads.h"
#include "viewer/reference_drawer.h"
#include "viewer/stopwatch.h"

#include <algorithm>

namespace pagoda::viewer {
namespace {

constexpr uint64_t kMinGpuBytes = uint64_t{1} << 20;
constexpr uint64_t kMinHostBytes = uint64_t{4} << 20;

uint64_t gpuBytes(const RendererOptions& options) {
    return std::max(options.gpuBytes, kMinGpuBytes);
}

std::unique_ptr<cache::LoadQueue> makeLoads(const cache::PageSource& source,
                                            const RendererOptions& options, cache::Clock& clock,
                                            cache::DiskLoads*& disk) {
    if (options.loads != nullptr) return nullptr;
    auto threads = std::make_unique<cache::ThreadLoads>(
        std::vector<const cache::PageSource*>{&source}, options.loaderThreads);
    if (options.disk.isAsIs()) return threads;
    auto loads = std::make_unique<cache::DiskLoads>(std::move(threads), options.disk, clock);
    disk = loads.get();
    return loads;
}

cache::Streaming::Options streamingOptions(const RendererOptions& options) {
    cache::Streaming::Options streaming;
    streaming.hostBytes = std::max(options.hostBytes, kMinHostBytes);
    streaming.gpuBytes = gpuBytes(options);
    streaming.uploadBytesPerFrame = options.uploadBytesPerFrame;
    return streaming;
}

}  // namespace

Renderer::Renderer(const ooc::Lattice& lattice, const cache::PageSource& source,
                   const RendererOptions& options)
    : clock_(options.clock != nullptr ? *options.clock : wallClock_),
      source_(source),
      device_(lattice, gpuBytes(options), options.pyramid),
      ownLoads_(makeLoads(source, options, clock_, disk_)),
      streaming_(std::vector<cache::SceneDatabase>{{lattice, &source}},
                 ownLoads_ ? *ownLoads_ : *options.loads, device_.store(), clock_,
                 streamingOptions(options)),
      tree_(lattice, streaming_.index()),
      runner_(streaming_, tree_, device_, options.queryLatencyFrames) {
    runner_.setPrefetch(options.doesPrefetch);
    runner_.prefetcher().setReasons(options.prefetchReasons);
    static_cast<void>(runner_.root());
}

hlod::FrameRecord Renderer::renderLive(const hlod::Camera& camera, hlod::Strategy& strategy,
                                       const RenderOptions& options) {
    device_.setLook(options.background, options.worldUp);
    return runner_.run(camera, strategy,
                       {.tauPx = options.tauPx, .clip = options.clip, .watch = options.watch});
}

hlod::FrameRecord Renderer::render(const hlod::Camera& camera, hlod::Strategy& strategy,
                                   const RenderOptions& options,
                                   const std::function<void(const hlod::FrameRecord&)>& onFrame) {
    device_.setLook(options.background, options.worldUp);
    return runner_.settle(camera, strategy,
                          {.tauPx = options.tauPx, .clip = options.clip, .watch = options.watch},
                          onFrame);
}

hlod::FrameRecord Renderer::renderReference(const hlod::Camera& camera,
                                            const RenderOptions& options,
                                            const std::function<void()>& onBatch) {
    device_.setLook(options.background, options.worldUp);
    const hlod::View view(camera, sceneBox(), options.clip);
    hlod::FrameRecord record;
    record.strategy = "reference";
    record.widthPx = camera.widthPx;
    record.heightPx = camera.heightPx;
    Stopwatch watch;
    const LeafList leaves = leavesInFrustum(view, tree_.lattice(), source_);
    record.visitedNodes = leaves.visitedNodes;
    record.culledNodes = leaves.culledNodes;
    record.faults = leaves.faults;
    record.traverseMs = watch.lapMs();
    streaming_.dropAll();
    cache::ThreadLoads loads({&source_}, 2);
    ReferenceDrawer(source_, loads, device_).draw(view, leaves.nodes, record, onBatch);
    record.drawMs = watch.lapMs();
    return record;
}

bool Renderer::setDisk(const cache::DiskProfile& disk) {
    if (disk_ == nullptr) return false;
    disk_->setProfile(disk);
    return true;
}

Picture Renderer::read(hlod::FrameRecord& record) {
    Stopwatch watch;
    Picture picture = device_.read();
    record.coveredPixels = picture.coveredPixels();
    record.fallbackPixels = 0;
    const std::span<const uint8_t> isStandIn = runner_.cut().drawnAsStandIn();
    if (std::find(isStandIn.begin(), isStandIn.end(), 1) != isStandIn.end()) {
        for (const uint32_t ordinal : picture.nodeOrdinals) {
            record.fallbackPixels +=
                ordinal > 0 && ordinal <= isStandIn.size() && isStandIn[ordinal - 1] != 0;
        }
    }
    record.readMs = watch.lapMs();
    return picture;
}

}  // namespace pagoda::viewer
