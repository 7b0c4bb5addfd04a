// truth.h: pictures held against each other, pixel by pixel. Pure functions; the pictures that one
// of them takes have one size (asserted).
#pragma once

#include "tools/bench/drawn_picture.h"

#include <cstdint>
#include <functional>

namespace pagoda::tools {

// Pixels that differ from the truth's, by reason: in node or triangle of the opaque surface; or, as
// ids are of opaque surfaces alone, in colour, which then is of what is translucent before it.
struct WrongPixels {
    uint64_t wrong = 0;  // neither of the others
    uint64_t tied = 0;   // at bit-equal depth: either surface is right
    // Of nodes that were drawn beside what refines them (RARN). A translucent surface does not say
    // whose it is: where any node was drawn so, it counts as that.
    uint64_t overdrawn = 0;
};
// `isOverdrawn` says so of a node.
[[nodiscard]] WrongPixels countWrongPixels(const viewer::Picture& picture,
                                           const viewer::Picture& truth,
                                           const std::function<bool(ooc::NodeId)>& isOverdrawn);

// Pixels whose node or triangle differs, whatever the reason.
[[nodiscard]] uint64_t countDifferentIds(const viewer::Picture& a, const viewer::Picture& b);

// Pixels that show through what the leaves close: all pixels within ceil(tau) + 1 of it, to the
// sides and across, are covered in `leaves`, while `drawn` shows background there, or an opaque
// surface farther than their farthest depth plus the error of the node that is drawn there.
// Pixels nearer to the border of the picture are not judged: what lies beyond is not known. Where
// the leaves are translucent alone they have no depth, and only background is a hole. Memory of
// some copies of the depths; O(pixels * tau).
[[nodiscard]] uint64_t countHoles(const DrawnPicture& drawn, const viewer::Picture& leaves);

// Pixels whose node has a greater error than that of the frame before, of a still camera, by
// reason. Pixels without an opaque surface before or now do not count.
struct CoarserPixels {
    uint64_t byCut = 0;       // neither of the others: a node that stands for the one before
    uint64_t byOthers = 0;    // another surface, which does not, came to the front
    uint64_t byStandIns = 0;  // a stand-in, before or now
    uint64_t byTau = 0;       // of frames whose tau rose

    // Without a cause that is allowed.
    [[nodiscard]] uint64_t coarser() const { return byCut + byOthers; }
    void add(const CoarserPixels& more);
};
[[nodiscard]] CoarserPixels countCoarser(const DrawnPicture& before, const DrawnPicture& now);

// Peak signal-to-noise ratio, dB, of luma and chroma (BT.601, full range); equal pictures have
// kEqualDb.
inline constexpr double kEqualDb = 99.0;
struct Psnr {
    double luma = 0, cb = 0, cr = 0;
};
[[nodiscard]] Psnr psnr(const viewer::Picture& picture, const viewer::Picture& reference);

}  // namespace pagoda::tools
