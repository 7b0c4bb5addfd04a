// codec_statistics.h: what pages weigh by the codec of their mesh, encoded and decoded, and what
// decoding them took. Sums over all that was ever loaded. Plain data.
#pragma once

#include "ooc/codecs/page_codec.h"

#include <array>
#include <cstdint>

namespace pagoda::cache {

struct CodecSums {
    uint64_t pages = 0, triangles = 0, vertices = 0;
    uint64_t encodedBytes = 0, decodedBytes = 0;
    double decodeS = 0;  // of one thread; checksums included
};

inline constexpr size_t kCodecs = 3;
using CodecStatistics = std::array<CodecSums, kCodecs>;  // by ooc::Codec

}  // namespace pagoda::cache
