// stl_reader.h: STL, binary and ASCII; each solid is an object.
// Streams: memory stays flat.
#pragma once

#include "ooc/readers/reader.h"

namespace pagoda::ooc {

// Opens and looks at the start; throws Error where that is not STL.
// The reader belongs to one thread.
[[nodiscard]] std::unique_ptr<Reader> openStlReader(const std::filesystem::path& path,
                                                    const ReaderOptions& options);

}  // namespace pagoda::ooc
