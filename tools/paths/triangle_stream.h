// triangle_stream.h: the triangles of a cut of a database, one page in memory at a time.
#pragma once

#include "ooc/base/box.h"
#include "ooc/base/progress.h"
#include "ooc/store/database.h"
#include "tools/paths/upright.h"

#include <array>
#include <functional>
#include <optional>

namespace pagoda::tools {

using Triangle = std::array<Vec3d, 3>;

// Visits the coarsest cut whose nodes are off by at most `errorModelUnits` (0: the leaves), turned
// upright, in the order of the store; nodes outside `box` (upright) are not read. A page or block
// that cannot be read throws Error: a path through what is missing could cross a wall.
void forEachTriangle(const ooc::Database& database, const Upright& upright, double errorModelUnits,
                     const std::optional<Box3d>& box, Progress& progress,
                     const std::function<void(const Triangle&)>& visit);

// All of the model, upright. Throws Error when the root cannot be read.
[[nodiscard]] Box3d modelBox(const ooc::Database& database, const Upright& upright);

}  // namespace pagoda::tools
