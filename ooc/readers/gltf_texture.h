// gltf_texture.h: images of a glTF file, decoded (PNG, JPEG, WebP) and sampled.
#pragma once

#include "ooc/readers/gltf_buffers.h"

#include <array>
#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

namespace pagoda::ooc::gltf {

enum class Wrap : uint8_t { Repeat, Mirror, Clamp };

struct Texture {
    uint32_t width = 0, height = 0;
    const std::vector<uint8_t>* pixels = nullptr;  // RGBA8, top row first
    Wrap wrapS = Wrap::Repeat, wrapT = Wrap::Repeat;
    bool isNearest = false;

    // Linear RGBA at (u, v), bilinear (between linear values) unless isNearest; (0, 0) is the
    // upper left corner of the image.
    [[nodiscard]] std::array<float, 4> sample(float u, float v) const;
};

// Decodes images when first asked for. Whatever is wrong with an image costs its texture only.
class TextureStore {
public:
    TextureStore(const Document& document, Buffers& buffers, MemoryBudget& budget)
        : document_(document), buffers_(buffers), budget_(budget) {}
    ~TextureStore() { letGo(); }
    TextureStore(const TextureStore&) = delete;
    TextureStore& operator=(const TextureStore&) = delete;

    // Null where it cannot be had; then `ignored` is a constant phrase saying why. Valid until the
    // next call.
    [[nodiscard]] const Texture* find(int texture, std::string_view& ignored);

private:
    struct Image {
        uint32_t width = 0, height = 0;
        std::vector<uint8_t> pixels;
        std::string_view problem;  // empty: decoded
    };
    void letGo() noexcept;
    [[nodiscard]] const Image& image(int index);
    void decode(int index, Image& image);
    [[nodiscard]] bool makeRoom(uint64_t bytes);

    const Document& document_;
    Buffers& buffers_;
    MemoryBudget& budget_;
    std::map<int, Image> images_;
    uint64_t imageBytes_ = 0;
    Texture texture_;
};

}  // namespace pagoda::ooc::gltf
