#include "ooc/base/number_text.h"

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace pagoda {

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

}  // namespace pagoda
