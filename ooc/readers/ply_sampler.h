// ply_sampler.h: triangles from all over a binary PLY file without reading it:
// SampledReader::sample(). Works where every face has the same number of bytes, so that the n-th
// can be found: triangles or quads throughout, as nearly all large files are.
#pragma once

#include "ooc/readers/ply_faces.h"
#include "ooc/readers/ply_header.h"

#include <cstdint>
#include <functional>
#include <optional>

namespace pagoda::ooc {

// Where the rows of a sampled file lie.
struct PlySampleLayout {
    size_t vertexElement = 0, faceElement = 0;
    uint64_t vertexOffset = 0, faceOffset = 0;  // bytes in the file
    size_t vertexBytes = 0, faceBytes = 0;      // of one row
    uint64_t corners = 3;                       // of every face
    PlyFaceLayout faces;
};

// Nothing where faces cannot be found by their number. O(elements).
[[nodiscard]] std::optional<PlySampleLayout> findPlySampleLayout(const SourceFile& source,
                                                                 const PlyHeader& header);

// SampledReader::sample() for a file of that layout.
void samplePly(const SourceFile& source, const PlyHeader& header, const PlySampleLayout& layout,
               TriangleSink& sink, uint64_t triangles, const std::function<bool()>& isEnough);

}  // namespace pagoda::ooc
