// off_reader.h: OFF, COFF, NOFF: vertices to scratch, then faces stream.
// Colours a vertex or a face; comments anywhere.
#pragma once

#include "ooc/readers/reader.h"

namespace pagoda::ooc {

// Opens and looks at the start; throws Error where that is not OFF.
// The reader belongs to one thread.
[[nodiscard]] std::unique_ptr<Reader> openOffReader(const std::filesystem::path& path,
                                                    const ReaderOptions& options);

}  // namespace pagoda::ooc
