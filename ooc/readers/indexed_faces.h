// indexed_faces.h: faces that name vertices by number, cut into triangles and handed on: what PLY
// and OFF share.
#pragma once

#include "ooc/readers/polygon.h"
#include "ooc/readers/triangle_batcher.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace pagoda::ooc {

// Two batchers, since opaque and translucent triangles never mix; the translucent material is added
// when it is first needed. All triangles belong to one object.
class OpacitySplitter {
public:
    OpacitySplitter(TriangleSink& sink, bool hasColours, bool hasNormals);

    void add(const Corner& a, const Corner& b, const Corner& c) {
        const uint32_t alpha = a.colour & b.colour & c.colour & 0xFF000000u;
        (alpha == 0xFF000000u ? opaque_ : translucent()).add(a, b, c);
    }
    // Triangles without colours go here.
    [[nodiscard]] TriangleBatcher& opaque() noexcept { return opaque_; }
    void finish();

private:
    TriangleBatcher& translucent();

    TriangleSink& sink_;
    uint32_t object_;
    TriangleBatcher opaque_;
    std::optional<TriangleBatcher> translucent_;
};

// `Vertices` has count(), position(index) and corner(index).
template <typename Vertices>
class IndexedFaces {
public:
    IndexedFaces(const Vertices& vertices, TriangleSink& sink, bool hasColours, bool hasNormals)
        : vertices_(vertices),
          out_(sink, hasColours, hasNormals),
          isPlain_(!hasColours && !hasNormals) {}

    // Colour of the faces that follow, in place of the vertices'; none: theirs.
    void setFaceColour(std::optional<uint32_t> colour) { faceColour_ = colour; }

    // Indices may be anything: negative ones (as wrapped to 64 bits) are out of range.
    void triangle(uint64_t a, uint64_t b, uint64_t c) {
        const uint64_t count = vertices_.count();
        if (a >= count || b >= count || c >= count) {
            out_.opaque().drop(DropReason::IndexOutOfRange);
        } else if (isPlain_) {
            out_.opaque().add(vertices_.position(a), vertices_.position(b), vertices_.position(c));
        } else {
            out_.add(corner(a), corner(b), corner(c));
        }
    }

    void face(std::span<const uint64_t> indices) {
        const size_t n = indices.size();
        if (n == 3) return triangle(indices[0], indices[1], indices[2]);
        if (n < 3) return out_.opaque().drop(DropReason::TooFewCorners);
        positions_.clear();
        for (const uint64_t index : indices) {
            if (n > kMaxCutCorners || index >= vertices_.count()) break;
            positions_.push_back(vertices_.position(index));
        }
        if (positions_.size() < n) {  // a fan drops least where a corner is bad
            for (size_t k = 2; k < n; ++k) triangle(indices[0], indices[k - 1], indices[k]);
            return;
        }
        for (const PolygonCutter::Triangle& t : cutter_.cut(positions_)) {
            triangle(indices[t[0]], indices[t[1]], indices[t[2]]);
        }
    }
    void drop(DropReason reason, uint64_t triangles = 1) { out_.opaque().drop(reason, triangles); }
    void finish() { out_.finish(); }

private:
    Corner corner(uint64_t index) const {
        Corner corner = vertices_.corner(index);
        if (faceColour_) corner.colour = *faceColour_;
        return corner;
    }

    const Vertices& vertices_;
    OpacitySplitter out_;
    bool isPlain_;
    std::optional<uint32_t> faceColour_;
    PolygonCutter cutter_;
    std::vector<Vec3d> positions_;
};

}  // namespace pagoda::ooc
