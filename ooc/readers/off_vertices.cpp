#include "ooc/readers/off_vertices.h"

#include <algorithm>
#include <array>

namespace pagoda::ooc {

std::optional<uint32_t> offColour(TextCursor cursor) {
    std::array<double, 4> values = {0, 0, 0, 0};
    size_t found = 0;
    bool isWhole = true;
    while (found < 4) {
        TextCursor word = cursor;
        if (!cursor.number(values[found])) break;
        const std::string_view text = word.word();
        isWhole &= text.find_first_of(".eEnN") == text.npos;
        ++found;
    }
    if (found < 3) return std::nullopt;
    if (found == 3) values[3] = isWhole ? 255.0 : 1.0;
    uint32_t colour = 0;
    for (size_t k = 0; k < 4; ++k) {
        const double value = isWhole ? values[k] : values[k] * 255.0;
        const double clamped = value > 0.0 ? std::min(value, 255.0) : 0.0;
        colour |= static_cast<uint32_t>(clamped + 0.5) << 8 * k;
    }
    return colour;
}

bool OffVertices::add(TextCursor& cursor) {
    Corner corner;
    Vec3d& position = corner.position;
    if (!cursor.number(position.x) || !cursor.number(position.y) || !cursor.number(position.z)) {
        return false;
    }
    Vec3d normal(0);
    if (hasNormals_ && cursor.number(normal.x) && cursor.number(normal.y) &&
        cursor.number(normal.z)) {
        corner.normal = unitNormal(normal.x, normal.y, normal.z);
    }
    if (hasColours_) corner.colour = offColour(cursor).value_or(corner.colour);
    scratch_->append(std::as_bytes(std::span(&corner, 1)));
    ++count_;
    return true;
}

}  // namespace pagoda::ooc
