#include "ooc/readers/gltf_texture.h"

#include "ooc/base/error.h"

#include <webp/decode.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pagoda::ooc::gltf {
namespace {

constexpr uint64_t kMaxPixels = uint64_t{1} << 28;  // 16384 x 16384: GPUs take no more

struct Size {
    uint64_t width = 0, height = 0;
};

uint32_t bigEndian(std::span<const std::byte> bytes, size_t at, size_t count) {
    uint32_t value = 0;
    for (size_t i = 0; i < count; ++i)
        value = value << 8 | std::to_integer<uint32_t>(bytes[at + i]);
    return value;
}

bool startsWith(std::span<const std::byte> bytes, std::string_view magic) {
    return bytes.size() >= magic.size() &&
           std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

// The size from the header, before a decoder allocates it. Zero where it is not found.
Size pngSize(std::span<const std::byte> bytes) {
    if (bytes.size() < 24) return {};
    return {bigEndian(bytes, 16, 4), bigEndian(bytes, 20, 4)};
}

// Walks the segments to the start of frame (SOF0 to SOF15 without DHT, JPG, DAC).
Size jpegSize(std::span<const std::byte> bytes) {
    for (size_t at = 2; at + 9 <= bytes.size();) {
        if (bytes[at] != std::byte{0xFF}) return {};
        const uint32_t marker = bigEndian(bytes, at + 1, 1);
        if (marker == 0xFF) {
            ++at;
            continue;
        }
        const bool isFrame =
            marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
        if (isFrame) return {bigEndian(bytes, at + 7, 2), bigEndian(bytes, at + 5, 2)};
        at += 2 + bigEndian(bytes, at + 2, 2);
    }
    return {};
}

Size webpSize(std::span<const std::byte> bytes) {
    int width = 0, height = 0;
    const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
    if (WebPGetInfo(data, bytes.size(), &width, &height) == 0) return {};
    return {static_cast<uint64_t>(width), static_cast<uint64_t>(height)};
}

bool decodeWebp(std::span<const std::byte> bytes, Size size, std::vector<uint8_t>& pixels) {
    pixels.resize(4 * size.width * size.height);
    return WebPDecodeRGBAInto(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(),
                              pixels.data(), pixels.size(),
                              static_cast<int>(4 * size.width)) != nullptr;
}

bool decodeByStb(std::span<const std::byte> bytes, Size size, std::vector<uint8_t>& pixels) {
    tinygltf::Image decoded;
    std::string errors, warnings;
    const bool isDecoded = tinygltf::LoadImageData(&decoded, 0, &errors, &warnings, 0, 0,
                                                   reinterpret_cast<const uint8_t*>(bytes.data()),
                                                   static_cast<int>(bytes.size()), nullptr);
    if (!isDecoded || decoded.component != 4 ||
        static_cast<uint64_t>(decoded.width) != size.width ||
        static_cast<uint64_t>(decoded.height) != size.height) {
        return false;
    }
    if (decoded.bits == 8) {
        pixels = std::move(decoded.image);
        return true;
    }
    if (decoded.bits != 16) return false;
    pixels.resize(4 * size.width * size.height);
    for (size_t i = 0; i < pixels.size(); ++i) {
        uint16_t value = 0;
        std::memcpy(&value, decoded.image.data() + 2 * i, 2);
        pixels[i] = static_cast<uint8_t>(value >> 8);
    }
    return true;
}

Wrap wrapOf(int mode) {
    if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::Clamp;
    return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::Mirror : Wrap::Repeat;
}

// A texel index beyond the image, brought back into it.
uint32_t wrapped(int64_t index, uint32_t size, Wrap wrap) {
    const auto length = static_cast<int64_t>(size);
    if (wrap == Wrap::Clamp)
        return static_cast<uint32_t>(std::clamp<int64_t>(index, 0, length - 1));
    const int64_t period = wrap == Wrap::Mirror ? 2 * length : length;
    int64_t rest = index % period;
    if (rest < 0) rest += period;
    return static_cast<uint32_t>(rest < length ? rest : period - 1 - rest);
}

const std::array<float, 256>& linearOfSrgb() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (size_t i = 0; i < values.size(); ++i) {
            const float s = static_cast<float>(i) / 255.0F;
            values[i] = s <= 0.04045F ? s / 12.92F : std::pow((s + 0.055F) / 1.055F, 2.4F);
        }
        return values;
    }();
    return table;
}

}  // namespace

std::array<float, 4> Texture::sample(float u, float v) const {
    // Beyond 2^20 repetitions a float has no place in the image left.
    constexpr float kFarthest = 1048576.0F;
    u = std::isfinite(u) ? std::clamp(u, -kFarthest, kFarthest) : 0.0F;
    v = std::isfinite(v) ? std::clamp(v, -kFarthest, kFarthest) : 0.0F;
    const auto& linear = linearOfSrgb();
    const auto texel = [&](int64_t x, int64_t y) {
        const uint8_t* from = pixels->data() + 4 * (size_t{wrapped(y, height, wrapT)} * width +
                                                    wrapped(x, width, wrapS));
        return std::array<float, 4>{linear[from[0]], linear[from[1]], linear[from[2]],
                                    static_cast<float>(from[3]) / 255.0F};
    };
    const double x = double{u} * width, y = double{v} * height;
    if (isNearest) {
        return texel(static_cast<int64_t>(std::floor(x)), static_cast<int64_t>(std::floor(y)));
    }
    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
    const auto fx = static_cast<float>(x - 0.5 - left), fy = static_cast<float>(y - 0.5 - top);
    const auto ix = static_cast<int64_t>(left), iy = static_cast<int64_t>(top);
    const auto a = texel(ix, iy), b = texel(ix + 1, iy);
    const auto c = texel(ix, iy + 1), d = texel(ix + 1, iy + 1);
    std::array<float, 4> mixed{};
    for (size_t i = 0; i < 4; ++i) {
        const float upper = a[i] + (b[i] - a[i]) * fx, lower = c[i] + (d[i] - c[i]) * fx;
        mixed[i] = upper + (lower - upper) * fy;
    }
    return mixed;
}

const Texture* TextureStore::find(int texture, std::string_view& ignored) {
    const tinygltf::Model& model = document_.model;
    const tinygltf::Texture& from = model.textures[static_cast<size_t>(texture)];
    int source = from.source;
    const auto webp = from.extensions.find("EXT_texture_webp");
    if (webp != from.extensions.end()) source = webp->second.Get("source").GetNumberAsInt();
    if (source < 0) {
        ignored = "texture without an image that is read";
        return nullptr;
    }
    const Image& decoded = image(source);
    if (!decoded.problem.empty()) {
        ignored = decoded.problem;
        return nullptr;
    }
    texture_ = {decoded.width, decoded.height, &decoded.pixels};
    if (from.sampler >= 0) {
        const tinygltf::Sampler& sampler = model.samplers[static_cast<size_t>(from.sampler)];
        texture_.wrapS = wrapOf(sampler.wrapS);
        texture_.wrapT = wrapOf(sampler.wrapT);
        texture_.isNearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    return &texture_;
}

const TextureStore::Image& TextureStore::image(int index) {
    const auto found = images_.find(index);
    if (found != images_.end()) return found->second;
    Image decoded;
    decode(index, decoded);
    return images_[index] = std::move(decoded);
}

void TextureStore::decode(int index, Image& image) {
    const ImageSource& from = document_.extras.images[static_cast<size_t>(index)];
    std::vector<std::byte> file;
    std::span<const std::byte> bytes;
    try {
        if (!from.uri.empty()) {
            file = buffers_.imageFile(from.uri, place("images", static_cast<size_t>(index)));
            bytes = file;
        } else if (from.bufferView >= 0) {
            bytes = buffers_.view(from.bufferView);
        }
    } catch (const Error&) {  // a picture that is missing does not cost the shape
        image.problem = "texture image missing";
        return;
    }
    const bool isWebp = startsWith(bytes, "RIFF");
    const Size size = startsWith(bytes, "\x89PNG")        ? pngSize(bytes)
                      : startsWith(bytes, "\xFF\xD8\xFF") ? jpegSize(bytes)
                      : isWebp                            ? webpSize(bytes)
                                                          : Size{};
    if (size.width == 0 || size.height == 0 || bytes.size() > std::numeric_limits<int>::max()) {
        image.problem = "texture image not PNG, JPEG or WebP";
        return;
    }
    // Decoders hold up to four times the pixels while they work (16 bits, two copies).
    const uint64_t pixels = size.width * size.height;
    if (pixels > kMaxPixels || !makeRoom(16 * pixels)) {
        image.problem = "texture image too large";
        return;
    }
    const bool isDecoded =
        isWebp ? decodeWebp(bytes, size, image.pixels) : decodeByStb(bytes, size, image.pixels);
    if (!isDecoded) {
        image.pixels = {};
        image.problem = "texture image broken";
        return;
    }
    image.width = static_cast<uint32_t>(size.width);
    image.height = static_cast<uint32_t>(size.height);
    budget_.take(image.pixels.size(), "images");
    imageBytes_ += image.pixels.size();
}

bool TextureStore::makeRoom(uint64_t bytes) {
    if (bytes > budget_.freeBytes()) letGo();
    return bytes <= budget_.freeBytes();
}

void TextureStore::letGo() noexcept {
    images_.clear();
    budget_.give(imageBytes_);
    imageBytes_ = 0;
}

}  // namespace pagoda::ooc::gltf
