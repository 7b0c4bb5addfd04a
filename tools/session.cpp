#include "tools/session.h"

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace pagoda::tools {
namespace {

constexpr std::array<std::pair<std::string_view, uint64_t>, 12> kByteUnits{{
    {"", 1},
    {"B", 1},
    {"KB", 1'000},
    {"kB", 1'000},
    {"MB", 1'000'000},
    {"GB", 1'000'000'000},
    {"TB", 1'000'000'000'000},
    {"KiB", uint64_t{1} << 10},
    {"kiB", uint64_t{1} << 10},
    {"MiB", uint64_t{1} << 20},
    {"GiB", uint64_t{1} << 30},
    {"TiB", uint64_t{1} << 40},
}};

[[noreturn]] void refuseBytes(const std::string& text) {
    throw CLI::ValidationError("'" + text + "' is no size; write 512MiB, 4GB or a number of bytes");
}

}  // namespace

uint64_t parseBytes(const std::string& text) {
    const char* const end = text.data() + text.size();
    uint64_t number = 0;
    const auto [unitBegin, failure] = std::from_chars(text.data(), end, number);
    if (failure != std::errc{}) refuseBytes(text);
    const std::string_view unitName(unitBegin, static_cast<size_t>(end - unitBegin));
    for (const auto& [name, bytes] : kByteUnits) {
        if (name != unitName) continue;
        if (number > std::numeric_limits<uint64_t>::max() / bytes) refuseBytes(text);
        return number * bytes;
    }
    refuseBytes(text);
}

std::string formatBytes(uint64_t bytes) {
    constexpr std::array<std::string_view, 7> kUnits{"B", "kB", "MB", "GB", "TB", "PB", "EB"};
    if (bytes < 1000) return fmt::format("{} B", bytes);
    double value = static_cast<double>(bytes);
    size_t unit = 0;
    // 999.95 would print as 1000.0 of the smaller unit.
    while (value >= 999.95 && unit + 1 < kUnits.size()) {
        value /= 1000.0;
        ++unit;
    }
    return fmt::format("{:.1f} {}", value, kUnits[unit]);
}

std::string formatCount(uint64_t count) {
    std::string digits = std::to_string(count);
    for (size_t behind = 3; behind < digits.size(); behind += 4) {
        digits.insert(digits.size() - behind, 1, ',');
    }
    return digits;
}

}  // namespace pagoda::tools
