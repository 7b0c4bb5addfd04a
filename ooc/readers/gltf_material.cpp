#include "ooc/readers/gltf_material.h"

#include <algorithm>
#include <cmath>

namespace pagoda::ooc::gltf {
namespace {

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

float clamped(double value) {
    return static_cast<float>(std::clamp(value, 0.0, 1.0));
}

void applyTransform(const tinygltf::Value& transform, TextureUse& use) {
    if (!transform.IsObject()) return;
    for (int i = 0; i < 2; ++i) {
        const auto part = static_cast<size_t>(i);
        if (transform.Has("offset")) {
            use.offset[part] =
                static_cast<float>(transform.Get("offset").Get(i).GetNumberAsDouble());
        }
        if (transform.Has("scale")) {
            use.scale[part] = static_cast<float>(transform.Get("scale").Get(i).GetNumberAsDouble());
        }
    }
    use.rotation = static_cast<float>(transform.Get("rotation").GetNumberAsDouble());
    if (transform.Has("texCoord")) use.texCoord = transform.Get("texCoord").GetNumberAsInt();
}

// The old extension replaces the base colour by a diffuse one.
void applySpecularGlossiness(const tinygltf::Value& glossy, Surface& surface) {
    surface.factor = {1, 1, 1, 1};
    surface.texture.reset();
    if (glossy.Has("diffuseFactor")) {
        for (int i = 0; i < 4; ++i) {
            surface.factor[static_cast<size_t>(i)] =
                clamped(glossy.Get("diffuseFactor").Get(i).GetNumberAsDouble());
        }
    }
    if (!glossy.Has("diffuseTexture")) return;
    const tinygltf::Value& info = glossy.Get("diffuseTexture");
    TextureUse& use = surface.texture.emplace();
    use.texture = info.Get("index").GetNumberAsInt();
    if (info.Has("texCoord")) use.texCoord = info.Get("texCoord").GetNumberAsInt();
    if (info.Has("extensions")) {
        applyTransform(info.Get("extensions").Get("KHR_texture_transform"), use);
    }
}

uint32_t toByte(float value) {
    return static_cast<uint32_t>(std::lround(std::clamp(value, 0.0F, 1.0F) * 255.0F));
}

float toSrgb(float linear) {
    return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

}  // namespace

// KHR_texture_transform: scale, then rotate counter-clockwise as seen on the image (v points down),
// then offset.
std::array<float, 4> sampleAt(const Texture& texture, const TextureUse& use, float u, float v) {
    const float su = u * use.scale[0], sv = v * use.scale[1];
    const float cosine = std::cos(use.rotation), sine = std::sin(use.rotation);
    return texture.sample(cosine * su + sine * sv + use.offset[0],
                          -sine * su + cosine * sv + use.offset[1]);
}

Surface surfaceOf(const tinygltf::Model& model, int material) {
    Surface surface;
    if (material < 0) return surface;
    const tinygltf::Material& from = model.materials[static_cast<size_t>(material)];
    surface.name = from.name;
    surface.isTranslucent = from.alphaMode == "BLEND";
    surface.isMask = from.alphaMode == "MASK";
    const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
    for (size_t i = 0; i < 4; ++i) surface.factor[i] = clamped(pbr.baseColorFactor[i]);
    if (pbr.baseColorTexture.index >= 0) {
        TextureUse& use = surface.texture.emplace();
        use.texture = pbr.baseColorTexture.index;
        use.texCoord = pbr.baseColorTexture.texCoord;
        const auto transform = pbr.baseColorTexture.extensions.find("KHR_texture_transform");
        if (transform != pbr.baseColorTexture.extensions.end()) {
            applyTransform(transform->second, use);
        }
    }
    const auto glossy = from.extensions.find(kSpecularGlossiness);
    if (glossy != from.extensions.end()) applySpecularGlossiness(glossy->second, surface);
    return surface;
}

MaterialInfo materialInfo(const Surface& surface) {
    MaterialInfo info;
    info.name = surface.name;
    info.isTranslucent = surface.isTranslucent;
    info.colour = packColour(surface.factor, surface.isTranslucent);
    return info;
}

uint32_t packColour(const std::array<float, 4>& linear, bool keepsAlpha) {
    const uint32_t alpha = keepsAlpha ? toByte(linear[3]) : 255;
    return toByte(toSrgb(linear[0])) | toByte(toSrgb(linear[1])) << 8 |
           toByte(toSrgb(linear[2])) << 16 | alpha << 24;
}

Materials::Materials(const Document& document, Buffers& buffers, MemoryBudget& budget)
    : document_(document), textures_(document, buffers, budget) {
}

const Surface& Materials::surface(int material) {
    const auto found = surfaces_.find(material);
    if (found != surfaces_.end()) return found->second;
    return surfaces_[material] = surfaceOf(document_.model, material);
}

const Texture* Materials::texture(int index, std::string_view& ignored) {
    return textures_.find(index, ignored);
}

}  // namespace pagoda::ooc::gltf
