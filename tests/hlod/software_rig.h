// software_rig.h: the whole run time on the software device, over a scene in memory, on a clock
// that the test moves; and what its pictures are held against.
#pragma once

#include "cache/clock.h"
#include "cache/disk_loads.h"
#include "cache/streaming.h"
#include "hlod/raster/software_device.h"
#include "hlod/strategies/replay.h"
#include "hlod/strategies/strategies.h"
#include "hlod/view/frame_runner.h"
#include "tests/hlod/room_scene.h"
#include "tests/viewer/inline_loads.h"

#include <map>
#include <memory>

namespace pagoda::hlod::test {

// Notes the pages that are read.
class RecordingLoads final : public cache::LoadQueue {
public:
    explicit RecordingLoads(std::unique_ptr<cache::LoadQueue> inner) : inner_(std::move(inner)) {}
    void send(std::vector<cache::LoadItem> items) override {
        for (const cache::LoadItem& item : items) {
            if (!item.isBlock) ++pages[item.node.id];
        }
        inner_->send(std::move(items));
    }
    void collect(std::vector<cache::LoadResult>& arrived) override { inner_->collect(arrived); }
    bool waitForArrival() override { return inner_->waitForArrival(); }
    size_t readsInFlight() const override { return inner_->readsInFlight(); }

    [[nodiscard]] uint64_t pageCount() const {
        uint64_t count = 0;
        for (const auto& [node, times] : pages) count += static_cast<uint64_t>(times);
        return count;
    }

    std::map<ooc::NodeId, int> pages;  // times read

private:
    std::unique_ptr<cache::LoadQueue> inner_;
};

struct RigOptions {
    uint64_t hostBytes = uint64_t{64} << 20, gpuBytes = uint64_t{64} << 20;
    uint64_t uploadBytesPerFrame = 0;
    cache::DiskProfile disk{};
    uint32_t queryLatencyFrames = 0;
};

class Rig {
public:
    explicit Rig(const RoomScene& scene, const RigOptions& options = {})
        : loads(std::make_unique<cache::DiskLoads>(
              std::make_unique<pagoda::test::InlineLoads>(scene), options.disk, clock)),
          device(scene.lattice, options.gpuBytes),
          database{scene.lattice, &scene},
          streaming(std::span(&database, 1), loads, device.pages(), clock,
                    {.hostBytes = options.hostBytes,
                     .gpuBytes = options.gpuBytes,
                     .uploadBytesPerFrame = options.uploadBytesPerFrame}),
          tree(scene.lattice, streaming.index()),
          runner(streaming, tree, device, options.queryLatencyFrames) {}

    // A frame, and the time until the next.
    FrameRecord live(const Camera& camera, Strategy& strategy, double tauPx) {
        FrameRecord record = runner.run(camera, strategy, {tauPx});
        clock.advance(1.0 / 60.0);
        return record;
    }
    FrameRecord settle(const Camera& camera, Strategy& strategy, double tauPx) {
        return runner.settle(camera, strategy, {tauPx});
    }
    [[nodiscard]] const SoftwarePicture& picture() const { return device.picture(); }

    cache::ManualClock clock;
    RecordingLoads loads;
    SoftwareDevice device;
    cache::SceneDatabase database;
    cache::Streaming streaming;
    NodeTree tree;
    FrameRunner runner;
};

struct WrongPixels {
    uint64_t wrong = 0, tied = 0, overdrawn = 0, same = 0;
};

// Pixels of the rig's last frame against its own cut without culling, drawn by `truth`.
inline WrongPixels wrongPixels(const Rig& rig, const FrameRecord& record, const Camera& camera,
                               Rig& truth) {
    ReplayStrategy replay(rig.runner.cut());
    static_cast<void>(truth.settle(camera, replay, record.effectiveTauPx));
    const SoftwarePicture &drawn = rig.picture(), &right = truth.picture();
    WrongPixels counts;
    for (size_t i = 0; i < drawn.pixelCount(); ++i) {
        const bool isDrawn = drawn.nodeOrdinals[i] != 0, isRight = right.nodeOrdinals[i] != 0;
        const bool isSameTriangle = isDrawn && isRight && drawn.nodeAt(i) == right.nodeAt(i) &&
                                    drawn.triangles[i] == right.triangles[i];
        if (isSameTriangle || (!isDrawn && !isRight)) {
            ++counts.same;
        } else if (drawn.depths[i] == right.depths[i]) {
            ++counts.tied;
        } else if (isDrawn && replay.overdrawn().contains({0, drawn.nodeAt(i)})) {
            ++counts.overdrawn;
        } else {
            ++counts.wrong;
        }
    }
    return counts;
}

// Pixels whose leaf in `leaves` (the same view from leaves alone) nothing drawn stands for, and
// which show something behind it, or nothing (`isBehind(pixel)`): what is left out must be hidden.
template <typename Picture, typename IsBehind>
uint64_t holes(const FrameCut& cut, const Picture& leaves, IsBehind&& isBehind) {
    std::set<ooc::NodeId> drawn;
    for (const Node& node : cut.drawn()) drawn.insert(node.record->id);
    uint64_t count = 0;
    for (size_t i = 0; i < leaves.pixelCount(); ++i) {
        if (leaves.nodeOrdinals[i] == 0 || !isBehind(i)) continue;
        ooc::NodeId node = leaves.nodes[leaves.nodeOrdinals[i] - 1];
        while (!drawn.contains(node) && node != ooc::NodeId::root()) node = node.parent();
        count += !drawn.contains(node);
    }
    return count;
}

inline uint64_t holes(const Rig& rig, const SoftwarePicture& leaves) {
    return holes(rig.runner.cut(), leaves,
                 [&](size_t i) { return rig.picture().depths[i] < leaves.depths[i]; });
}

}  // namespace pagoda::hlod::test
