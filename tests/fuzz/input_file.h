// input_file.h: an input as a file with a name, in memory where the system has a place for that.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace pagoda::fuzz {

// A folder of this process' own, made once and removed at exit.
[[nodiscard]] const std::filesystem::path& inputFolder();

// Writes `bytes` to input`extension` in it, replacing what was there.
[[nodiscard]] std::filesystem::path writeInput(std::span<const std::byte> bytes,
                                               std::string_view extension);

}  // namespace pagoda::fuzz
