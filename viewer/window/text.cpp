#include "viewer/window/text.h"

#include <fmt/format.h>

#include <array>

namespace pagoda::viewer {

std::string countText(uint64_t count) {
    std::string digits = std::to_string(count);
    for (size_t behind = 3; behind < digits.size(); behind += 4) {
        digits.insert(digits.size() - behind, 1, ',');
    }
    return digits;
}

std::string bytesText(double bytes) {
    constexpr std::array kUnits = {"B", "kB", "MB", "GB", "TB"};
    size_t unit = 0;
    while (bytes >= 999.5 && unit + 1 < kUnits.size()) {
        bytes /= 1000.0;
        ++unit;
    }
    return unit == 0 || bytes >= 99.95 ? fmt::format("{:.0f} {}", bytes, kUnits[unit])
                                       : fmt::format("{:.1f} {}", bytes, kUnits[unit]);
}

std::string lengthText(double modelUnits) {
    return fmt::format("{:.4g}", modelUnits);
}

}  // namespace pagoda::viewer
