#include "ooc/writers/mesh_writer.h"

#include "ooc/base/error.h"
#include "ooc/writers/writer_kinds.h"

#include <algorithm>

namespace pagoda::ooc {

std::filesystem::path folderOf(const std::filesystem::path& target) {
    return target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
}

std::unique_ptr<MeshWriter> MeshWriter::create(const std::filesystem::path& target, bool force,
                                               UpAxis up) {
    std::string extension = target.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char letter) {
        return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
    });
    if (extension == ".ply") return createPlyWriter(target, force);
    if (extension == ".obj") return createObjWriter(target, force);
    if (extension == ".glb") return createGlbWriter(target, force, up);
    if (extension == ".stl") return createStlWriter(target, force);
    throw Error(target.string(), "", "cannot write this kind of file",
                "name it .ply, .obj, .glb or .stl");
}

}  // namespace pagoda::ooc
