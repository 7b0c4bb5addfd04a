#include "tools/session.h"

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <limits>
#include <string_view>
#include <utility>

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

}  // namespace pagoda::tools
