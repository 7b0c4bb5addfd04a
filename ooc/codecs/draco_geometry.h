// draco_geometry.h: the codec `draco` for a mesh's vertices and triangles: the smallest pages and
// the slowest to decode. Lossless: positions are integers here and nothing is quantised. Draco
// orders vertices and triangles as it likes. Triangles find back into their runs by an attribute
// that holds each corner's run; vertices that this or Draco split are joined again. Bytes:
// ooc/FORMAT.md, "Draco". Used by page_codec.cpp only.
#pragma once

#include "ooc/codecs/geometry.h"

#include <span>
#include <string>

namespace pagoda::ooc {

// False, with nothing appended, for a mesh that Draco does not give back as it was (triangles that
// name a vertex twice, vertices of no triangle, two vertices alike): decoded and compared each
// time. The caller then writes another codec.
[[nodiscard]] bool encodeDraco(const GeometryView& geometry, std::span<const MeshRun> runs,
                               ByteWriter& out);

// Takes all that `in` has left. Returns what is wrong, empty when `out` is whole.
[[nodiscard]] std::string decodeDraco(ByteReader& in, std::span<const MeshRun> runs, Geometry& out);

}  // namespace pagoda::ooc
