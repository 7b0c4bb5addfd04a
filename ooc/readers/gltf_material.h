// gltf_material.h: glTF materials as our one colour a material, and textures as corner colours.
#pragma once

#include "ooc/readers/gltf_buffers.h"
#include "ooc/readers/gltf_texture.h"
#include "ooc/readers/reader.h"

#include <array>
#include <map>
#include <optional>
#include <string>

namespace pagoda::ooc::gltf {

// A base colour texture and how texture coordinates get to it: uv' = offset + rotate(scale * uv).
struct TextureUse {
    int texture = -1;
    int texCoord = 0;
    std::array<float, 2> offset{0, 0}, scale{1, 1};
    float rotation = 0;
};

// Linear RGBA of the texture where a corner's coordinates (u, v) lead to.
[[nodiscard]] std::array<float, 4> sampleAt(const Texture& texture, const TextureUse& use, float u,
                                            float v);

struct Surface {
    std::string name;
    std::array<float, 4> factor{1, 1, 1, 1};  // linear RGBA
    std::optional<TextureUse> texture;
    bool isTranslucent = false;  // alphaMode BLEND; otherwise alpha is 1
    bool isMask = false;         // alphaMode MASK: drawn opaque
};

// The material of a primitive: -1 is glTF's default material.
[[nodiscard]] Surface surfaceOf(const tinygltf::Model& model, int material);
[[nodiscard]] MaterialInfo materialInfo(const Surface& surface);

// RGBA in [0, 1] to RGBA8: colours linear to sRGB, alpha as it is; 1 where it counts for nothing.
[[nodiscard]] uint32_t packColour(const std::array<float, 4>& linear, bool keepsAlpha);

// Surfaces by material, and their decoded textures (in the budget; all are let go when full).
class Materials {
public:
    Materials(const Document& document, Buffers& buffers, MemoryBudget& budget);

    [[nodiscard]] const Surface& surface(int material);
    // Null where the texture cannot be had (`ignored` is set to a constant phrase). Valid until the
    // next call.
    [[nodiscard]] const Texture* texture(int index, std::string_view& ignored);

private:
    const Document& document_;
    std::map<int, Surface> surfaces_;
    TextureStore textures_;
};

}  // namespace pagoda::ooc::gltf
