// writer_kinds.h: the writers behind MeshWriter::create(), one a file.
#pragma once

#include "ooc/writers/mesh_writer.h"

namespace pagoda::ooc {

[[nodiscard]] std::unique_ptr<MeshWriter> createPlyWriter(const std::filesystem::path& target,
                                                          bool force);
[[nodiscard]] std::unique_ptr<MeshWriter> createObjWriter(const std::filesystem::path& target,
                                                          bool force);
[[nodiscard]] std::unique_ptr<MeshWriter> createGlbWriter(const std::filesystem::path& target,
                                                          bool force, UpAxis up);
[[nodiscard]] std::unique_ptr<MeshWriter> createStlWriter(const std::filesystem::path& target,
                                                          bool force);

// Where scratch of a writer goes: the target's folder has room for the target anyway.
[[nodiscard]] std::filesystem::path folderOf(const std::filesystem::path& target);

}  // namespace pagoda::ooc
