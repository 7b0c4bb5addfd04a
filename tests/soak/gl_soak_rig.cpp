#include "tests/soak/soak_rig.h"
#include "viewer/gl_context.h"
#include "viewer/renderer.h"

#include <cmath>
#include <optional>
#include <utility>

namespace pagoda::hlod::test {
namespace {

// The least that the renderer takes.
constexpr uint64_t kLeastHostBytes = uint64_t{4} << 20, kLeastGpuBytes = uint64_t{1} << 20;
// Two triangles in one plane may differ by the depth buffer's rounding.
constexpr float kSameDepth = 1e-4f;

viewer::RendererOptions optionsOf(const SoakOptions& soak, cache::LoadQueue& loads,
                                  cache::Clock& clock) {
    viewer::RendererOptions options;
    options.hostBytes = soak.rig.hostBytes;
    options.gpuBytes = soak.rig.gpuBytes;
    options.uploadBytesPerFrame = soak.rig.uploadBytesPerFrame;
    options.queryLatencyFrames = soak.rig.queryLatencyFrames;
    options.doesPrefetch = soak.doesPrefetch;
    options.clock = &clock;
    options.loads = &loads;
    return options;
}

// All leaves on GL, unculled, with room for all of them.
class Leaves {
public:
    explicit Leaves(const RoomScene& scene)
        : renderer_(scene.lattice, scene, {}), frustum_(makeStrategy("frustum")) {}
    // The same camera once more costs nothing.
    const viewer::Picture& seenFrom(const Camera& camera) {
        if (camera_ == camera) return picture_;
        camera_ = camera;
        FrameRecord record = renderer_.renderLive(camera, *frustum_, {.tauPx = 0.0});
        if (record.missingPages > 0) record = renderer_.render(camera, *frustum_, {.tauPx = 0.0});
        picture_ = renderer_.read(record);
        return picture_;
    }

private:
    viewer::Renderer renderer_;
    std::unique_ptr<Strategy> frustum_;
    std::optional<Camera> camera_;
    viewer::Picture picture_;
};

class GlSoakRig final : public SoakRig {
public:
    GlSoakRig(const RoomScene& scene, Leaves& leaves, const SoakOptions& options)
        : leaves_(leaves),
          loads_(std::make_unique<cache::DiskLoads>(
              std::make_unique<pagoda::test::InlineLoads>(scene), options.rig.disk, clock_)),
          renderer_(scene.lattice, scene, optionsOf(options, loads_, clock_)) {}

    FrameRecord run(const Camera& camera, Strategy& strategy, double tauPx) override {
        FrameRecord record = renderer_.renderLive(camera, strategy, {.tauPx = tauPx});
        picture_ = renderer_.read(record);
        clock_.advance(1.0 / 60.0);
        return record;
    }
    FrameRunner& runner() override { return renderer_.runner(); }
    uint64_t gpuBytes() override { return renderer_.device().store().usedBytes(); }
    bool contains(cache::PageId page) override { return renderer_.device().store().contains(page); }
    uint64_t holes(const Camera& camera) override {
        const viewer::Picture& leaves = leaves_.seenFrom(camera);
        return test::holes(runner().cut(), leaves, [&](size_t i) {
            return picture_.depthsModelUnits[i] > leaves.depthsModelUnits[i] * (1 + kSameDepth);
        });
    }
    uint64_t pagesRead() const override { return loads_.pageCount(); }

private:
    Leaves& leaves_;
    cache::ManualClock clock_;
    RecordingLoads loads_;
    viewer::Renderer renderer_;
    viewer::Picture picture_;
};

class GlSoakDevice final : public SoakDevice {
public:
    explicit GlSoakDevice(const RoomScene& scene)
        : context_(viewer::GlContext::headless()), scene_(scene), leaves_(scene) {}
    std::unique_ptr<SoakRig> makeRig(const SoakOptions& options) override {
        return std::make_unique<GlSoakRig>(scene_, leaves_, options);
    }
    uint64_t leastHostBytes() const override { return kLeastHostBytes; }
    uint64_t leastGpuBytes() const override { return kLeastGpuBytes; }

private:
    viewer::GlContext context_;
    const RoomScene& scene_;
    Leaves leaves_;
};

}  // namespace

std::unique_ptr<SoakDevice> makeGlDevice(const RoomScene& scene) {
    return std::make_unique<GlSoakDevice>(scene);
}

}  // namespace pagoda::hlod::test
