// obj_reader.h: Wavefront OBJ with MTL colours, groups and vertex colours; UTF-8 or UTF-16.
// The first read() sweeps the text twice: vertices to scratch, then faces; later ones once.
#pragma once

#include "ooc/readers/reader.h"

namespace pagoda::ooc {

// Opens and looks at the start; throws Error where that is not OBJ.
// The reader belongs to one thread.
[[nodiscard]] std::unique_ptr<Reader> openObjReader(const std::filesystem::path& path,
                                                    const ReaderOptions& options);

}  // namespace pagoda::ooc
