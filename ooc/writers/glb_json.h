// glb_json.h: the JSON chunk of a GLB, from the tables that the writer kept.
#pragma once

#include "ooc/readers/reader.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

namespace pagoda::ooc {

// A run of triangles of one object and one material; offsets are bytes in the four streams.
struct GlbPrimitive {
    static constexpr uint64_t kAbsent = UINT64_MAX;

    uint32_t object = 0, material = 0;
    uint32_t vertexCount = 0, indexCount = 0;
    uint64_t positionOffset = 0, normalOffset = kAbsent, colourOffset = kAbsent, indexOffset = 0;
    Vec3f min{std::numeric_limits<float>::max()}, max{std::numeric_limits<float>::lowest()};
};

struct GlbObject {
    ObjectInfo info;
    Vec3d translation{0.0};  // of its positions, in the model's frame
    uint32_t primitiveCount = 0;
};

struct GlbScene {
    std::vector<GlbObject> objects;
    std::vector<MaterialInfo> materials;
    std::vector<GlbPrimitive> primitives;   // any order
    std::array<uint64_t, 4> streamBytes{};  // positions, normals, colours, indices, in this order
    bool turnsZUp = false;                  // root nodes turn z up into y up

    [[nodiscard]] uint64_t binBytes() const {
        return streamBytes[0] + streamBytes[1] + streamBytes[2] + streamBytes[3];
    }
};

[[nodiscard]] inline double srgbToLinear(uint8_t value) {
    const double share = value / 255.0;
    return share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
}

// Hands the text on piece by piece: it is never in memory as a whole.
void writeGlbJson(const GlbScene& scene, const std::function<void(std::string_view)>& write);

}  // namespace pagoda::ooc
