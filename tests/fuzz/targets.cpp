#include "tests/fuzz/targets.h"

#include <array>
#include <cstdio>
#include <cstdlib>

namespace pagoda::fuzz {
namespace {

constexpr std::array<Target, 9> kTargets{{
    {"ply", readPly},
    {"obj", readObj},
    {"stl", readStl},
    {"off", readOff},
    {"gltf", readGltf},
    {"drc", readDrc},
    {"page", decodeAnyPage},
    {"mesh", encodeAnyMesh},
    {"database", openAnyDatabase},
}};

}  // namespace

std::span<const Target> targets() {
    return kTargets;
}

const Target* findTarget(std::string_view name) {
    for (const Target& target : kTargets) {
        if (target.name == name) return &target;
    }
    return nullptr;
}

void require(bool isKept, std::string_view promise) {
    if (isKept) return;
    std::fprintf(stderr, "broken promise: %.*s\n", static_cast<int>(promise.size()),
                 promise.data());
    std::abort();
}

}  // namespace pagoda::fuzz
