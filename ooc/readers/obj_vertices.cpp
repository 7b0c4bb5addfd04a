#include "ooc/readers/obj_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pagoda::ooc {
namespace {

constexpr uint32_t kWhite = 0xFFFFFFFFu;

template <typename Item>
void append(ScratchArray& array, const Item& item) {
    array.append(std::as_bytes(std::span(&item, 1)));
}

}  // namespace

ObjVertices::ObjVertices(const std::filesystem::path& scratchFolder)
    : scratchFolder_(scratchFolder),
      positions_(std::make_unique<ScratchArray>(scratchFolder)),
      normals_(std::make_unique<ScratchArray>(scratchFolder)) {
}

void ObjVertices::addPosition(TextCursor numbers) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    double values[6] = {kNan, kNan, kNan, 0, 0, 0};
    int found = 0;
    while (found < 6 && numbers.number(values[found])) ++found;
    if (found < 3) {
        values[found] = kNan;
        ++badPositions_;
    }
    append(*positions_, Vec3d(values[0], values[1], values[2]));
    if (found == 6) {
        addColour({values[3], values[4], values[5]});
    } else if (colours_) {
        append(*colours_, kWhite);
    }
    ++positionCount_;
}

void ObjVertices::addColour(const Vec3d& colour) {
    if (!colours_) {
        colours_ = std::make_unique<ScratchArray>(scratchFolder_);
        for (uint64_t k = 0; k < positionCount_; ++k) append(*colours_, kWhite);
    }
    if (!std::isfinite(colour.x + colour.y + colour.z)) return append(*colours_, kWhite);
    const double largest = std::max({colour.x, colour.y, colour.z});
    const double scale = largest > 1.0 ? 1.0 : 255.0;
    const auto channel = [&](double value) {
        return static_cast<uint32_t>(std::clamp(value * scale, 0.0, 255.0) + 0.5);
    };
    append(*colours_,
           channel(colour.x) | channel(colour.y) << 8 | channel(colour.z) << 16 | 0xFF000000u);
}

void ObjVertices::addNormal(TextCursor numbers) {
    Vec3d normal(0);
    if (!numbers.number(normal.x) || !numbers.number(normal.y) || !numbers.number(normal.z)) {
        normal = Vec3d(0);  // none: the face's own stands in
    }
    append(*normals_, unitNormal(normal.x, normal.y, normal.z));
    ++normalCount_;
}

// "v/t/n" and "v//n" name a normal; "v//" does not.
void ObjVertices::lookAtFace(TextCursor corners) {
    if (usesNormals_) return;
    const std::string_view corner = corners.word();
    const size_t last = corner.rfind('/');
    usesNormals_ = last != corner.npos && corner.find('/') != last && last + 1 < corner.size();
}

void ObjVertices::finish() {
    positions_->seal();
    normals_->seal();
    if (colours_) colours_->seal();
}

}  // namespace pagoda::ooc
