// number_text.h: numbers as people read them.
#pragma once

#include <cstdint>
#include <string>

namespace pagoda {

// 1234567 -> "1.2 MB"; 1234567 -> "1,234,567".
[[nodiscard]] std::string formatBytes(uint64_t bytes);
[[nodiscard]] std::string formatCount(uint64_t count);

}  // namespace pagoda
