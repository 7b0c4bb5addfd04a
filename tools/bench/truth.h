// truth.h: pictures held against each other, pixel by pixel. Pure functions.
#pragma once

#include "viewer/picture.h"

#include <cstdint>
#include <functional>

namespace pagoda::tools {

// Pixels whose node or triangle differs from the truth's, by reason.
struct WrongPixels {
    uint64_t wrong = 0;      // neither of the others
    uint64_t tied = 0;       // at bit-equal depth: either surface is right
    uint64_t overdrawn = 0;  // of nodes that were drawn beside what refines them (RARN)
};
// `isOverdrawn` says so of a node. Both pictures have one size (asserted).
[[nodiscard]] WrongPixels countWrongPixels(const viewer::Picture& picture,
                                           const viewer::Picture& truth,
                                           const std::function<bool(ooc::NodeId)>& isOverdrawn);

// Pixels whose node or triangle differs, whatever the reason.
[[nodiscard]] uint64_t countDifferentIds(const viewer::Picture& a, const viewer::Picture& b);

// Peak signal-to-noise ratio, dB, of luma and chroma (BT.601, full range); equal pictures have
// kEqualDb.
inline constexpr double kEqualDb = 99.0;
struct Psnr {
    double luma = 0, cb = 0, cr = 0;
};
[[nodiscard]] Psnr psnr(const viewer::Picture& picture, const viewer::Picture& reference);

}  // namespace pagoda::tools
