// ply_reader.h: PLY, ASCII and binary of both byte orders: faces, polygons, tristrips, colours and
// normals.
// Vertices go to scratch on the first read(); faces stream in blocks, so memory stays flat.
#pragma once

#include "ooc/readers/reader.h"

namespace pagoda::ooc {

// Opens and looks at the start; throws Error where that is not PLY.
// The reader belongs to one thread.
[[nodiscard]] std::unique_ptr<Reader> openPlyReader(const std::filesystem::path& path,
                                                    const ReaderOptions& options);

}  // namespace pagoda::ooc
