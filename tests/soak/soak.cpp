// Frames of random cameras (walks, still views, teleports), strategies, budgets, latencies and
// disks (slow, failing, short reads), on the software device and a clock that only the program
// moves. After each frame: budgets hold, nothing that shows is left out, the counts agree. The same
// seed gives the same frames.
//
//   pagoda_soak [FRAMES [SEED]]       default 1000 frames, a seed of its own
#include "tests/hlod/software_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace pagoda::hlod {
namespace {

using test::Rig;
using test::RoomScene;

constexpr int kLongestEpisode = 400;
constexpr uint64_t kMaxReported = 20;
constexpr double kFrameS = 1.0 / 60.0;

struct Totals {
    uint64_t frames = 0, episodes = 0, drawnNodes = 0, pagesRead = 0, evicted = 0, failedReads = 0;
    uint64_t settled = 0, framesWithHoles = 0, faults = 0, broken = 0;
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
    bool isPollFree = false;
    test::RigOptions rig;
};

Episode makeEpisode(Random& random, const RoomScene& scene) {
    static constexpr std::array kDisks = {"as-is",           "500MB/s",
                                          "2MB/s,10ms",      "500MB/s,40ms",
                                          "300MB/s,fail=1%", "1MB/s,20ms,fail=10%",
                                          "5MB/s,short=20%"};
    static constexpr std::array kStrategies = {"frustum", "bool", "sw",  "simp",
                                               "coh",     "hzb",  "late"};
    Episode episode;
    episode.strategy = kStrategies[static_cast<size_t>(random.whole(0, kStrategies.size() - 1))];
    episode.tauPx = random.whole(0, 9) == 0 ? 0.0 : random.log(0.3, 8.0);
    episode.frames = random.whole(10, kLongestEpisode);
    episode.isPollFree = random.whole(0, 1) == 1;
    // From little more than the root to all of it.
    const uint64_t rootBytes = SoftwarePages(0).sizeBytes(scene.record(ooc::NodeId::root()));
    const bool isAmple = random.whole(0, 2) == 0;
    episode.rig.gpuBytes =
        isAmple
            ? uint64_t{16} << 20
            : static_cast<uint64_t>(1.05 * static_cast<double>(rootBytes) * random.log(1.0, 40.0));
    episode.rig.hostBytes = static_cast<uint64_t>(random.log(double{1 << 19}, double{1 << 25}));
    episode.rig.uploadBytesPerFrame =
        random.whole(0, 1) == 0 ? 0 : static_cast<uint64_t>(random.log(2e3, 1e6));
    episode.rig.disk =
        cache::parseDiskProfile(kDisks[static_cast<size_t>(random.whole(0, kDisks.size() - 1))]);
    episode.rig.disk.seed = random.seed();
    episode.rig.queryLatencyFrames = static_cast<uint32_t>(random.whole(0, 4));
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

class Soak {
public:
    Soak(uint64_t seed, uint64_t frames)
        : random_(seed),
          frames_(frames),
          scene_(RoomScene::Options{.seed = static_cast<uint32_t>(seed % 1000 + 1)}),
          leaves_(scene_) {}

    const Totals& run() {
        while (totals_.frames < frames_) runEpisode();
        return totals_;
    }

private:
    void runEpisode() {
        episode_ = makeEpisode(random_, scene_);
        Rig rig(scene_, episode_.rig);
        rig.device.setCounting(true, episode_.isPollFree);
        const auto strategy = makeStrategy(episode_.strategy);
        Walker walker(random_, scene_);
        for (int i = 0; i < episode_.frames && totals_.frames < frames_; ++i) {
            const Camera camera = walker.next();
            const FrameRecord record = rig.runner.run(camera, *strategy, {episode_.tauPx});
            rig.clock.advance(kFrameS);
            ++totals_.frames;
            check(rig, record, camera);
        }
        ++totals_.episodes;
        for (const auto& [node, times] : rig.loads.pages) {
            totals_.pagesRead += static_cast<uint64_t>(times);
        }
        totals_.evicted += rig.streaming.residency().counters().evictedPages;
        totals_.failedReads += rig.streaming.requests().counters().retried;
        totals_.faults += rig.streaming.residency().faults().size();
    }

    void expect(bool isRight, const std::string& what) {
        if (isRight) return;
        if (++totals_.broken > kMaxReported) return;
        fmt::print(stderr, "frame {} ({}, gpu {} host {} upload {} latency {} tau {}): {}\n",
                   totals_.frames, episode_.strategy, episode_.rig.gpuBytes, episode_.rig.hostBytes,
                   episode_.rig.uploadBytesPerFrame, episode_.rig.queryLatencyFrames,
                   episode_.tauPx, what);
    }

    void check(Rig& rig, const FrameRecord& record, const Camera& camera) {
        checkBudgets(rig, record);
        checkCounts(rig, record);
        totals_.drawnNodes += record.drawnNodes;
        totals_.settled += record.isSettled;
        totals_.peakTauPx = std::max(totals_.peakTauPx, record.effectiveTauPx);
        if (record.drawnNodes == 0) return;  // the root is on its way, or cannot be read
        static_cast<void>(leaves_.settle(camera, *frustum_, 0.0));
        const uint64_t holes = test::holes(rig, leaves_.picture());
        totals_.framesWithHoles += holes > 0;
        expect(holes == 0, fmt::format("{} pixels of holes", holes));
    }

    void checkBudgets(Rig& rig, const FrameRecord& record) {
        const uint64_t gpuBytes = rig.device.pages().usedBytes();
        expect(gpuBytes == record.gpuBytes, "GPU bytes are counted twice or not at all");
        expect(gpuBytes <= episode_.rig.gpuBytes, fmt::format("{} GPU bytes", gpuBytes));
        expect(record.hostBytes <= episode_.rig.hostBytes,
               fmt::format("{} host bytes", record.hostBytes));
        const auto share = [](uint64_t bytes, uint64_t budget) {
            return static_cast<double>(bytes) / static_cast<double>(budget);
        };
        totals_.peakGpuShare =
            std::max(totals_.peakGpuShare, share(gpuBytes, episode_.rig.gpuBytes));
        totals_.peakHostShare =
            std::max(totals_.peakHostShare, share(record.hostBytes, episode_.rig.hostBytes));
    }

    void checkCounts(Rig& rig, const FrameRecord& record) {
        const FrameCut& cut = rig.runner.cut();
        std::set<ooc::NodeId> drawn;
        uint64_t standIns = 0;
        for (size_t i = 0; i < cut.drawn().size(); ++i) {
            const Node& node = cut.drawn()[i];
            expect(drawn.insert(node.record->id).second, "a node is drawn twice");
            expect(rig.device.pages().contains(node.page()), "a drawn page is gone");
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
    Rig leaves_;
    std::unique_ptr<Strategy> frustum_ = makeStrategy("frustum");
    Episode episode_;
    Totals totals_;
};

int run(int count, char** arguments) {
    const uint64_t frames = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 1000;
    const uint64_t seed =
        count > 2 ? std::strtoull(arguments[2], nullptr, 10) : std::random_device{}();
    fmt::print("soak: {} frames, seed {}\n", frames, seed);
    const Totals totals = Soak(seed, frames).run();
    fmt::print(
        "soak: {} frames in {} episodes: {} broken rules, {} frames with holes; {:.1f} nodes drawn "
        "a "
        "frame, {} frames settled; {} pages read, {} evicted, {} reads failed, {} pages given up; "
        "peaks: GPU {:.3f} and host {:.3f} of budget, tau {:.1f} px\n",
        totals.frames, totals.episodes, totals.broken, totals.framesWithHoles,
        static_cast<double>(totals.drawnNodes) /
            static_cast<double>(std::max<uint64_t>(totals.frames, 1)),
        totals.settled, totals.pagesRead, totals.evicted, totals.failedReads, totals.faults,
        totals.peakGpuShare, totals.peakHostShare, totals.peakTauPx);
    return totals.broken == 0 ? 0 : 1;
}

}  // namespace
}  // namespace pagoda::hlod

int main(int count, char** arguments) {
    return pagoda::hlod::run(count, arguments);
}
