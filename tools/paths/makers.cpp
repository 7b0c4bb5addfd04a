#include "tools/paths/makers.h"

#include "ooc/base/error.h"
#include "tools/paths/triangle_stream.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <utility>

namespace pagoda::tools {

const std::vector<PathKind>& pathKinds() {
    static const std::vector<PathKind> kKinds{
        {"orbit", makeOrbit}, {"walk", makeWalk}, {"fly", makeFly}, {"teleport", makeTeleport}};
    return kKinds;
}

hlod::CameraPath makePath(const ooc::Database& database, hlod::UpAxis up, std::string_view kind,
                          const PathOptions& options, Progress& progress) {
    const Upright upright(up);
    const Box3d box = modelBox(database, upright);
    const double diagonal = glm::length(box.max - box.min);
    if (!(diagonal > 0)) {
        throw Error(database.path(), "", "has no extent to move around in", "");
    }
    const PathScene scene{database, upright, box, diagonal, progress};
    const auto row = std::find_if(pathKinds().begin(), pathKinds().end(),
                                  [&](const PathKind& k) { return k.name == kind; });
    assert(row != pathKinds().end());
    hlod::CameraPath path;
    path.kind = kind;
    path.seed = options.seed;
    path.modelName = std::filesystem::path(database.path()).filename().string();
    path.modelDiagonalModelUnits = diagonal;
    path.frames = row->make(scene, options);
    return path;
}

}  // namespace pagoda::tools
