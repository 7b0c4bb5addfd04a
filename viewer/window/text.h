// text.h: numbers as people read them.
#pragma once

#include <cstdint>
#include <string>

namespace pagoda::viewer {

[[nodiscard]] std::string countText(uint64_t count);      // "1,234,567"
[[nodiscard]] std::string bytesText(double bytes);        // "12.3 MB"
[[nodiscard]] std::string lengthText(double modelUnits);  // four significant digits

}  // namespace pagoda::viewer
