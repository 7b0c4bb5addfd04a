// targets.h: what is fuzzed: every reader, the page codec and the database file.
// A target takes any bytes and returns; it aborts where a promise of the code under it is broken,
// and the sanitizers abort for the rest. Each run stands alone: no state is kept between inputs.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace pagoda::fuzz {

struct Target {
    std::string_view name;  // also its folder in tests/fuzz/corpus/
    void (*run)(std::span<const std::byte> input);
};

[[nodiscard]] std::span<const Target> targets();
[[nodiscard]] const Target* findTarget(std::string_view name);  // nullptr: there is none

// Prints `promise` and aborts unless `isKept`.
void require(bool isKept, std::string_view promise);

// One row each in targets().
void readPly(std::span<const std::byte> input);
void readObj(std::span<const std::byte> input);
void readStl(std::span<const std::byte> input);
void readOff(std::span<const std::byte> input);
void readGltf(std::span<const std::byte> input);
void readDrc(std::span<const std::byte> input);
void decodeAnyPage(std::span<const std::byte> input);
void encodeAnyMesh(std::span<const std::byte> input);
void openAnyDatabase(std::span<const std::byte> input);

}  // namespace pagoda::fuzz
