// utf16.h: text in UTF-16, which a few exporters write, turned into UTF-8.
#pragma once

#include "ooc/base/file.h"

#include <cstdint>

namespace pagoda::ooc {

class SourceFile;

// Appends the text behind the two bytes of the mark to `copy` and returns how many bytes that were.
// Halves of surrogate pairs that stand alone become U+FFFD.
uint64_t copyUtf16AsUtf8(const SourceFile& source, bool isBigEndian, File& copy);

}  // namespace pagoda::ooc
