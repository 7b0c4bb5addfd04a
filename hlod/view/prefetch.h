// prefetch.h: reads ahead what the next frames will need, as far as the camera's motion tells. The
// camera is taken to go on as it lately went; the cut of this frame is walked with where it will be
// then. What was foretold is held against what is wanted afterwards, for each reason apart: a
// reason that foretells too little is not read for, until it does again. Render thread only. Its
// place in a frame: docs/frame.md.
#pragma once

#include "cache/residency.h"
#include "hlod/view/camera.h"
#include "hlod/view/node_tree.h"

#include <array>
#include <bitset>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace pagoda::hlod {

// Goes on with the mean velocity of the last frames, dying away.
class CameraMotion {
public:
    // The camera of the next frame. A jump, another picture size or angle of view begins anew.
    void note(const Camera& camera, const Box3d& sceneBox);
    // Where it will be in so many frames; nothing when it stands still or has just jumped.
    [[nodiscard]] std::optional<Camera> in(double frames) const;

private:
    std::optional<Camera> last_;
    Vec3d moved_{0.0};   // model units a frame
    Vec3d turned_{0.0};  // axis times radians a frame
};

// Why a page is thought to be needed soon.
enum class PrefetchReason : uint8_t {
    Near,    // the eye is about to be inside its box: it will be drawn, unasked
    Refine,  // what stands for it grows beyond tau
    Enter,   // comes into the frustum
    Uncover  // proved hidden, and may come out
};
using PrefetchReasons = std::bitset<cache::kPrefetchReasons>;
inline constexpr std::array<const char*, cache::kPrefetchReasons> kPrefetchReasonNames = {
    "near", "refine", "enter", "uncover"};

// "on", "off" or reasons by name, joined by commas. Nothing for any other text.
[[nodiscard]] std::optional<PrefetchReasons> parsePrefetchReasons(std::string_view text);

class Prefetcher {
public:
    // For these alone is anything read; all of them go on being scored. All at first.
    void setReasons(PrefetchReasons reasons) { reasons_ = reasons; }
    // Of what the frame tells; each is one store.
    void beginFrame(uint64_t frameIndex, const NodeTree& tree);
    void noteWant(const Node& node, bool isResident);
    void noteRefined(const Node& node) { mark(node, What::Refined); }
    void noteDrawn(const Node& node) { mark(node, What::Drawn); }
    void noteHidden(const Node& node) { mark(node, What::Hidden); }

    // After the traversal of `now`: asks `residency` for what the next frames need, if the camera
    // moves.
    void run(const View& now, const Box3d& sceneBox, double tauPx, NodeTree& tree,
             cache::Residency& residency);

    // Share of the bytes foretold lately for this reason that were wanted soon after.
    [[nodiscard]] double precision(PrefetchReason reason) const;
    [[nodiscard]] bool pays(PrefetchReason reason) const;
    // What is left out because it does not pay; empty: nothing is.
    [[nodiscard]] std::string offText() const;

private:
    enum class What : uint8_t { Nothing, Refined, Drawn, Hidden };
    // What the frame told of a node, by its slot; another node may have had the slot before.
    struct Mark {
        cache::PageId page{UINT32_MAX, {}};
        uint64_t frame = 0;
        What what = What::Nothing;
    };
    struct Foretold {
        PrefetchReason reason;
        uint64_t frame;
        uint32_t bytes;
    };
    // Bytes, each event weighing less than the one after it.
    struct Score {
        double hitBytes = 0, missBytes = 0;
    };
    struct Walk;
    void mark(const Node& node, What what) { marks_[node.slot] = {node.page(), frame_, what}; }
    [[nodiscard]] What told(const Node& node) const;
    void settleScore(const Foretold& foretold, bool isHit);
    void expire();
    [[nodiscard]] double lookAheadFrames() const;
    void visit(Walk& walk, const Node& node);
    void below(Walk& walk, const Node& node, PrefetchReason reason);
    void foretell(Walk& walk, const Node& node, PrefetchReason reason);
    void foretellChildren(Walk& walk, const Node& node, PrefetchReason reason);
    [[nodiscard]] bool isReadFor(PrefetchReason reason) const;
    [[nodiscard]] double priority(const Walk& walk, const Node& node, PrefetchReason reason) const;

    using Pages = std::unordered_map<cache::PageId, uint64_t, cache::PageIdHash>;
    PrefetchReasons reasons_ = PrefetchReasons().set();
    uint64_t frame_ = 0;
    CameraMotion motion_;
    std::vector<Mark> marks_;
    std::unordered_map<cache::PageId, Foretold, cache::PageIdHash> foretold_;
    std::deque<std::pair<uint64_t, cache::PageId>> byAge_;
    std::array<Score, cache::kPrefetchReasons> scores_{};
    Pages missingSince_;
    double latencyFrames_ = 1.0;  // of loads, lately
};

}  // namespace pagoda::hlod
