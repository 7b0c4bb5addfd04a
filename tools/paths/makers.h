// makers.h: camera paths for a model: around it, past it, through its rooms, from place to place.
// The same database, options and seed give the same path, on any machine and for any thread count.
#pragma once

#include "hlod/view/camera_path.h"
#include "ooc/base/progress.h"
#include "ooc/store/database.h"
#include "tools/paths/upright.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pagoda::tools {

struct PathOptions {
    size_t frames = 200;
    uint64_t seed = 1;
    double speed = 1;          // times the usual steps; no step gets less than the least one
    double fovyDegrees = 0;    // 0: the kind's own
    double zoom = 1;           // orbit: 1 sees all of the model, 2 half of it
    double eyeHeight = 0;      // model units; 0: guessed
    double stepHeight = 0;     // what a person steps up, model units; 0: 0.15 of the eye height
    size_t holdFrames = 30;    // teleport: frames at a place
    std::optional<Box3d> box;  // walk: stay inside; as the model lies, not upright
};

// What a maker may look at.
struct PathScene {
    const ooc::Database& database;
    Upright upright;
    Box3d box;  // of the model, upright
    double diagonalModelUnits;
    Progress& progress;
};

// Frames alone. Throw Error where the model has no place for such a path.
using PathFrames = std::vector<hlod::Camera>;

// At least a full turn around the box, all of it in view; the eye's height sways a little.
[[nodiscard]] PathFrames makeOrbit(const PathScene& scene, const PathOptions& options);
// A closed curve outside of the model: close by its surface, away, and back.
[[nodiscard]] PathFrames makeFly(const PathScene& scene, const PathOptions& options);
// On foot through rooms, at eye height, never through anything.
[[nodiscard]] PathFrames makeWalk(const PathScene& scene, const PathOptions& options);
// Places of the walk, or of the flight where there is none; still for `holdFrames` at each.
[[nodiscard]] PathFrames makeTeleport(const PathScene& scene, const PathOptions& options);

struct PathKind {
    std::string_view name;
    PathFrames (*make)(const PathScene& scene, const PathOptions& options);
};
[[nodiscard]] const std::vector<PathKind>& pathKinds();

// `kind` is a name of pathKinds().
[[nodiscard]] hlod::CameraPath makePath(const ooc::Database& database, hlod::UpAxis up,
                                        std::string_view kind, const PathOptions& options,
                                        Progress& progress);

}  // namespace pagoda::tools
