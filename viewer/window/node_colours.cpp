#include "viewer/window/node_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pagoda::viewer {
namespace {

// How much of the node's own colour is covered: its shapes are told by the light alone then.
constexpr uint8_t kCover = 235;

// Ten hues of similar brightness (after Paul Tol's bright and muted schemes), coarse to fine.
constexpr std::array<glm::u8vec3, 10> kLevelColours = {{{204, 80, 62},
                                                        {238, 153, 58},
                                                        {222, 205, 87},
                                                        {143, 186, 77},
                                                        {56, 163, 112},
                                                        {68, 170, 183},
                                                        {75, 126, 196},
                                                        {126, 100, 190},
                                                        {190, 105, 178},
                                                        {160, 160, 165}}};

uint64_t mixed(uint64_t value) {
    value ^= value >> 31;
    value *= 0x9E3779B97F4A7C15ull;
    value ^= value >> 29;
    value *= 0xBF58476D1CE4E5B9ull;
    return value ^ (value >> 32);
}

glm::u8vec3 nodeColour(uint64_t id) {
    const double hue = 6.0 * static_cast<double>(mixed(id) & 0xFFFFu) / 65536.0;
    const double light = 0.62 + 0.3 * static_cast<double>((mixed(id) >> 16) & 0xFFFFu) / 65536.0;
    const auto channel = [&](double offset) {
        const double k = std::fmod(hue + offset, 6.0);
        const double value = light * (1.0 - 0.55 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
        return static_cast<uint8_t>(std::lround(255.0 * value));
    };
    return {channel(5.0), channel(3.0), channel(1.0)};
}

}  // namespace

glm::u8vec3 levelColour(int depth) {
    return kLevelColours[static_cast<size_t>(std::max(depth, 0)) % kLevelColours.size()];
}

glm::u8vec3 errorColour(double share) {
    // Six halvings of what is allowed: most errors are far below it.
    const double t = share > 0.0 ? std::clamp(1.0 + std::log2(share) / 6.0, 0.0, 1.0) : 0.0;
    const Vec3d low(62, 104, 190), middle(110, 186, 110), high(214, 66, 52);
    const Vec3d colour =
        t < 0.5 ? glm::mix(low, middle, 2.0 * t) : glm::mix(middle, high, 2.0 * t - 1.0);
    return {static_cast<uint8_t>(colour.x), static_cast<uint8_t>(colour.y),
            static_cast<uint8_t>(colour.z)};
}

NodeTint tintOf(Colouring colouring, double tauPx) {
    const auto covered = [](const glm::u8vec3& c) { return glm::u8vec4(c, kCover); };
    switch (colouring) {
        case Colouring::Model:
            return {};
        case Colouring::Level:
            return [=](const hlod::Node& node, const hlod::View&) {
                return covered(levelColour(node.record->id.depth()));
            };
        case Colouring::Node:
            return [=](const hlod::Node& node, const hlod::View&) {
                return covered(nodeColour(node.record->id.value));
            };
        case Colouring::Error:
            return [=](const hlod::Node& node, const hlod::View& view) {
                const double ssePx = view.ssePx(node.record->errorModelUnits, *node.boxModel);
                return covered(errorColour(ssePx / tauPx));
            };
    }
    return {};
}

}  // namespace pagoda::viewer
