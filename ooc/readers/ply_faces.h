// ply_faces.h: streams the face and tristrips elements of a PLY file.
#pragma once

#include "ooc/readers/indexed_faces.h"
#include "ooc/readers/ply_header.h"
#include "ooc/readers/ply_vertices.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pagoda::ooc {

// Where the corners and colours of a face element are. Null if it has no list that could be them.
struct PlyFaceLayout {
    size_t cornerList = 0;  // property
    PlyColourProperties colour;
};
[[nodiscard]] std::optional<PlyFaceLayout> findPlyFaces(const PlyElement& element);

class PlyFaceReader {
public:
    PlyFaceReader(const PlyVertices& vertices, TriangleSink& sink, bool hasFaceColours)
        : sink_(sink),
          faces_(vertices, sink, vertices.hasColours() || hasFaceColours, vertices.hasNormals()),
          usesFaceColours_(hasFaceColours) {}

    template <typename Values>
    void readFaces(Values& values, const PlyElement& element, const PlyFaceLayout& layout);
    // Binary faces whose only list is the corners: several times as fast.
    void readPlainFaces(InputStream& stream, PlyFormat format, const PlyElement& element,
                        const PlyFaceLayout& layout);
    [[nodiscard]] bool isPlain(PlyFormat format, const PlyElement& element) const;
    // One list a strip; -1 ends a strip within a list.
    template <typename Values>
    void readStrips(Values& values, const PlyElement& element, size_t cornerList);
    void finish();

private:
    template <typename Values>
    void readCorners(Values& values, const PlyProperty& list);
    template <typename Index>
    void readPlain(InputStream& stream, bool swapsBytes, const PlyElement& element,
                   const PlyFaceLayout& layout);
    template <typename Index>
    uint64_t readBlock(std::span<const std::byte>& block, bool swapsBytes,
                       const PlyElement& element, const PlyFaceLayout& layout, uint64_t facesLeft);

    TriangleSink& sink_;
    IndexedFaces<PlyVertices> faces_;
    bool usesFaceColours_;
    std::vector<uint64_t> corners_;
    uint64_t fannedPolygons_ = 0;
};

}  // namespace pagoda::ooc
