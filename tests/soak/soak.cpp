// Frames of random cameras (walks, still views, teleports), strategies, budgets, latencies, disks
// (slow, failing, short reads) and prefetch, on a clock that only the program moves. After each
// frame: budgets hold, nothing that shows is left out, the counts agree. The same seed gives the
// same frames.
//
//   pagoda_soak [--gl] [FRAMES [SEED]]       default 1000 frames, a seed of its own
//
// On the software device, or with --gl on OpenGL, where budgets are larger (the renderer takes no
// less) and so is the scene.
#include "ooc/base/error.h"
#include "tests/soak/soak_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <span>
#include <string>

namespace pagoda::hlod {
namespace {

using test::RoomScene;
using test::SoakRig;

constexpr int kLongestEpisode = 400;
constexpr uint64_t kMaxReported = 20;

struct Totals {
    uint64_t frames = 0, episodes = 0, drawnNodes = 0, pagesRead = 0, evicted = 0, failedReads = 0;
    uint64_t settled = 0, framesWithHoles = 0, faults = 0, broken = 0;
    cache::PrefetchCount prefetch;
    double peakGpuShare = 0, peakHostShare = 0, peakTauPx = 0;
};

class Random {
public:
    explicit Random(uint64_t seed) : engine_(seed) {}
    uint64_t seed() { return engine_(); }
    int whole(int least, int most) {
        return std::uniform_int_distribution<int>(least, most)(engine_);
    }
    double real(double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(engine_);
    }
    double log(double least, double most) {
        return std::exp(real(std::log(least), std::log(most)));
    }

private:
    std::mt19937_64 engine_;
};

// What a strategy, a cache and a disk are set to for some frames.
struct Episode {
    std::string strategy;
    double tauPx = 1.0;
    int frames = 0;
    test::SoakOptions options;
};

Episode makeEpisode(Random& random, const RoomScene& scene, const test::SoakDevice& device) {
    static constexpr std::array kDisks = {"as-is",           "500MB/s",
                                          "2MB/s,10ms",      "500MB/s,40ms",
                                          "300MB/s,fail=1%", "1MB/s,20ms,fail=10%",
                                          "5MB/s,short=20%"};
    static constexpr std::array kStrategies = {"frustum", "bool", "sw",   "simp",
                                               "coh",     "hzb",  "late", "slabs"};
    Episode episode;
    episode.strategy = kStrategies[static_cast<size_t>(random.whole(0, kStrategies.size() - 1))];
    episode.tauPx = random.whole(0, 9) == 0 ? 0.0 : random.log(0.3, 8.0);
    episode.frames = random.whole(10, kLongestEpisode);
    episode.options.isPollFree = random.whole(0, 1) == 1;
    episode.options.doesPrefetch = random.whole(0, 1) == 1;
    test::RigOptions& rig = episode.options.rig;
    // From little more than the root to all of it.
    const uint64_t rootBytes = SoftwarePages(0).sizeBytes(scene.record(ooc::NodeId::root()));
    const bool isAmple = random.whole(0, 2) == 0;
    rig.gpuBytes =
        isAmple
            ? uint64_t{16} << 20
            : static_cast<uint64_t>(1.05 * static_cast<double>(rootBytes) * random.log(1.0, 40.0));
    rig.gpuBytes = std::max(rig.gpuBytes, device.leastGpuBytes());
    rig.hostBytes = std::max(static_cast<uint64_t>(random.log(double{1 << 19}, double{1 << 25})),
                             device.leastHostBytes());
    rig.uploadBytesPerFrame =
        random.whole(0, 1) == 0 ? 0 : static_cast<uint64_t>(random.log(2e3, 1e6));
    rig.disk =
        cache::parseDiskProfile(kDisks[static_cast<size_t>(random.whole(0, kDisks.size() - 1))]);
    rig.disk.seed = random.seed();
    rig.queryLatencyFrames = static_cast<uint32_t>(random.whole(0, 4));
    return episode;
}

// Walks, stands still, turns, jumps.
class Walker {
public:
    Walker(Random& random, const RoomScene& scene) : random_(random), camera_(scene.walk(0, 1)) {
        jump();
    }
    const Camera& next() {
        if (left_-- <= 0) {
            left_ = random_.whole(5, 60);
            speed_ = random_.whole(0, 2) == 0 ? 0.0 : random_.log(1.0, 60.0);
            turn_ = random_.whole(0, 2) == 0 ? 0.0 : random_.real(-0.1, 0.1);
            if (random_.whole(0, 3) == 0) jump();
        }
        if (speed_ <= 0.0) return camera_;
        yaw_ += turn_;
        const Vec3d ahead(std::cos(yaw_), std::sin(yaw_), 0.0);
        camera_.eye += speed_ * ahead;
        for (int axis = 0; axis < 2; ++axis) {
            camera_.eye[axis] = std::clamp(camera_.eye[axis], 201.0, 3799.0);
        }
        look();
        return camera_;
    }

private:
    void jump() {
        camera_.eye = {random_.real(201, 3799), random_.real(201, 3799), random_.real(2, 254)};
        yaw_ = random_.real(-3.2, 3.2);
        pitch_ = random_.real(-0.6, 0.6);
        look();
    }
    void look() { camera_.target = camera_.eye + Vec3d(std::cos(yaw_), std::sin(yaw_), pitch_); }

    Random& random_;
    Camera camera_;
    int left_ = 0;
    double speed_ = 0, turn_ = 0, yaw_ = 0, pitch_ = 0;
};

struct Plan {
    uint64_t frames = 1000, seed = 0;
    bool isOnGl = false;
};

RoomScene::Options sceneOptions(const Plan& plan) {
    RoomScene::Options options;
    options.seed = static_cast<uint32_t>(plan.seed % 1000 + 1);
    if (plan.isOnGl) options.boxesPerRoom *= 6;
    return options;
}

std::unique_ptr<test::SoakDevice> makeDevice(const Plan& plan, const RoomScene& scene) {
#ifdef PAGODA_SOAK_GL
    if (plan.isOnGl) return test::makeGlDevice(scene);
#else
    if (plan.isOnGl) throw Error("--gl", "", "this program was built without GL", "leave it out");
#endif
    return test::makeSoftwareDevice(scene);
}

class Soak {
public:
    explicit Soak(const Plan& plan)
        : random_(plan.seed),
          frames_(plan.frames),
          scene_(sceneOptions(plan)),
          device_(makeDevice(plan, scene_)) {}

    const Totals& run() {
        while (totals_.frames < frames_) runEpisode();
        return totals_;
    }

private:
    void runEpisode() {
        episode_ = makeEpisode(random_, scene_, *device_);
        const auto rig = device_->makeRig(episode_.options);
        const auto strategy = makeStrategy(episode_.strategy);
        Walker walker(random_, scene_);
        for (int i = 0; i < episode_.frames && totals_.frames < frames_; ++i) {
            const Camera camera = walker.next();
            const FrameRecord record = rig->run(camera, *strategy, episode_.tauPx);
            ++totals_.frames;
            check(*rig, record, camera);
        }
        ++totals_.episodes;
        const cache::Streaming& streaming = rig->runner().streaming();
        const cache::Residency::Counters& counters = streaming.residency().counters();
        totals_.pagesRead += rig->pagesRead();
        totals_.evicted += counters.evictedPages;
        totals_.failedReads += streaming.requests().counters().retried;
        totals_.faults += streaming.residency().faults().size();
        totals_.prefetch += sumOf(counters.prefetch);
        totals_.prefetch += streaming.prefetchedBlocks();
    }

    void expect(bool isRight, const std::string& what) {
        if (isRight) return;
        if (++totals_.broken > kMaxReported) return;
        const test::RigOptions& rig = episode_.options.rig;
        fmt::print(stderr, "frame {} ({}, gpu {} host {} upload {} latency {} tau {}): {}\n",
                   totals_.frames, episode_.strategy, rig.gpuBytes, rig.hostBytes,
                   rig.uploadBytesPerFrame, rig.queryLatencyFrames, episode_.tauPx, what);
    }

    void check(SoakRig& rig, const FrameRecord& record, const Camera& camera) {
        checkBudgets(rig, record);
        checkCounts(rig, record);
        totals_.drawnNodes += record.drawnNodes;
        totals_.settled += record.isSettled;
        totals_.peakTauPx = std::max(totals_.peakTauPx, record.effectiveTauPx);
        if (record.drawnNodes == 0) return;  // the root is on its way, or cannot be read
        const uint64_t holes = rig.holes(camera);
        totals_.framesWithHoles += holes > 0;
        expect(holes == 0, fmt::format("{} pixels of holes", holes));
    }

    void checkBudgets(SoakRig& rig, const FrameRecord& record) {
        const uint64_t gpuBytes = rig.gpuBytes();
        expect(gpuBytes == record.gpuBytes, "GPU bytes are counted twice or not at all");
        expect(gpuBytes <= episode_.options.rig.gpuBytes, fmt::format("{} GPU bytes", gpuBytes));
        expect(record.hostBytes <= episode_.options.rig.hostBytes,
               fmt::format("{} host bytes", record.hostBytes));
        const auto share = [](uint64_t bytes, uint64_t budget) {
            return static_cast<double>(bytes) / static_cast<double>(budget);
        };
        totals_.peakGpuShare =
            std::max(totals_.peakGpuShare, share(gpuBytes, episode_.options.rig.gpuBytes));
        totals_.peakHostShare = std::max(totals_.peakHostShare,
                                         share(record.hostBytes, episode_.options.rig.hostBytes));
    }

    void checkCounts(SoakRig& rig, const FrameRecord& record) {
        const FrameCut& cut = rig.runner().cut();
        std::set<ooc::NodeId> drawn;
        uint64_t standIns = 0;
        for (size_t i = 0; i < cut.drawn().size(); ++i) {
            const Node& node = cut.drawn()[i];
            expect(drawn.insert(node.record->id).second, "a node is drawn twice");
            expect(rig.contains(node.page()), "a drawn page is gone");
            standIns += cut.drawnAsStandIn()[i];
        }
        expect(record.drawnNodes == drawn.size(), "drawn nodes");
        expect(record.standIns == standIns, "stand-ins");
        expect(record.hiddenNodes == cut.hidden().size(), "hidden nodes");
        expect(record.rarnNodes + record.delayedNodes <= record.visitedNodes, "visited nodes");
        expect(!record.isSettled || record.missingPages == 0, "settled with pages missing");
        expect(record.effectiveTauPx >= episode_.tauPx, "effective tau");
    }

    Random random_;
    uint64_t frames_;
    RoomScene scene_;
    std::unique_ptr<test::SoakDevice> device_;
    Episode episode_;
    Totals totals_;
};

int run(std::span<char*> arguments) {
    Plan plan;
    plan.isOnGl = !arguments.empty() && std::string(arguments[0]) == "--gl";
    if (plan.isOnGl) arguments = arguments.subspan(1);
    if (!arguments.empty()) plan.frames = std::strtoull(arguments[0], nullptr, 10);
    plan.seed =
        arguments.size() > 1 ? std::strtoull(arguments[1], nullptr, 10) : std::random_device{}();
    fmt::print("soak: {} frames{}, seed {}\n", plan.frames, plan.isOnGl ? " on GL" : "", plan.seed);
    const Totals totals = Soak(plan).run();
    fmt::print(
        "soak: {} frames in {} episodes: {} broken rules, {} frames with holes; {:.1f} nodes drawn "
        "a frame, {} frames settled; {} pages read, {} evicted, {} reads failed, {} pages given "
        "up; "
        "{} bytes read ahead, {} of them used; peaks: GPU {:.3f} and host {:.3f} of budget, tau "
        "{:.1f} px\n",
        totals.frames, totals.episodes, totals.broken, totals.framesWithHoles,
        static_cast<double>(totals.drawnNodes) /
            static_cast<double>(std::max<uint64_t>(totals.frames, 1)),
        totals.settled, totals.pagesRead, totals.evicted, totals.failedReads, totals.faults,
        totals.prefetch.bytes, totals.prefetch.usedBytes, totals.peakGpuShare, totals.peakHostShare,
        totals.peakTauPx);
    return totals.broken == 0 ? 0 : 1;
}

}  // namespace
}  // namespace pagoda::hlod

int main(int count, char** arguments) {
    try {
        return pagoda::hlod::run(std::span(arguments, static_cast<size_t>(count)).subspan(1));
    } catch (const pagoda::Error& error) {
        fmt::print(stderr, "pagoda_soak: {}\n", error.what());
        return 2;
    }
}
