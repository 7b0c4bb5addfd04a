// drc_reader.h: raw Draco files (.drc): meshes of all bitstream versions that draco decodes, with
// positions, colours (bytes as they are: sRGB) and normals. A point cloud holds no triangles.
// The file and its decoded mesh are held in memory during read(), within memoryBytes.
#pragma once

#include "ooc/readers/reader.h"

#include <filesystem>
#include <memory>

namespace pagoda::ooc {

// Reads the header. Throws Error for what is not Draco and for more than options.maxTriangles.
// The reader belongs to one thread.
[[nodiscard]] std::unique_ptr<Reader> openDrcReader(const std::filesystem::path& path,
                                                    const ReaderOptions& options);

}  // namespace pagoda::ooc
