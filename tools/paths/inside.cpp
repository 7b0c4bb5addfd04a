#include "ooc/base/error.h"
#include "tools/paths/walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pagoda::tools {
namespace {

constexpr double kPersonEyeMetres = 1.7;
// Cells to the eye's height: 9 cm for a person. At 12 cm, half of the doors of a furnished office
// close; finer costs memory.
constexpr double kCellsToEye = 18;
constexpr size_t kMaxBlocks = size_t{2} << 20;  // 250 MB
constexpr size_t kMaxSpots = size_t{12} << 20;  // 400 MB with the tour's share

// In shares of the eye height, so for any unit; the metres are for an eye at 1.7.
TourStyle tourStyle() {
    constexpr double kMetre = kCellsToEye / kPersonEyeMetres;
    return {.bodyRadius = 1.4,  // a cell on either side and half one: doors, not cracks
            .likedClearance = 0.7 * kMetre,
            .placeClearance = 0.5 * kMetre,
            .placeOpenness = 2.0 * kMetre,
            .placeSpacing = 4.3 * kMetre,
            .seenRadius = 1.9 * kMetre,
            .eyeHeight = kCellsToEye};
}

}  // namespace

WalkScale walkScale(const PathScene& scene, const PathOptions& options) {
    const double diagonal = scene.diagonalModelUnits;
    double eye = options.eyeHeight;
    if (eye <= 0) {
        const bool looksLikeMetres = diagonal >= 6 && diagonal <= 5000;
        eye = looksLikeMetres ? kPersonEyeMetres : diagonal / 40;
        if (!looksLikeMetres) {
            scene.progress.note(
                fmt::format("this model is hardly in metres (diagonal {:g}): eye height {:g}, 1/40 "
                            "of the diagonal; --eye-height chooses another",
                            diagonal, eye));
        }
    }
    return {eye, eye / kCellsToEye};
}

Inside::Inside(const PathScene& scene, const PathOptions& options)
    : scale_(walkScale(scene, options)) {
    readTriangles(scene, options);
    const double step = options.stepHeight > 0 ? options.stepHeight : 0.15 * scale_.eyeHeight;
    const WalkerCells walker{.height = static_cast<int>(kCellsToEye) + 2,
                             .step = std::max(1, static_cast<int>(std::lround(step / scale_.cell))),
                             .ceiling = static_cast<int>(12 * kCellsToEye)};
    plan_ = std::make_unique<FloorPlan>(*solid_, walker, kMaxSpots, scene.progress);
    tour_ = std::make_unique<Tour>(*solid_, *plan_, tourStyle(), options.seed, scene.progress);
    if (tour_->isEmpty()) {
        throw Error(
            scene.database.path(), "",
            fmt::format("has no indoor floor to walk on at eye height {:g}", scale_.eyeHeight),
            "use --kind fly, or give --eye-height in model units");
    }
}

void Inside::readTriangles(const PathScene& scene, const PathOptions& options) {
    Box3d bounds = scene.box;
    if (options.box) {
        const Box3d chosen = scene.upright.fromModel(*options.box);
        bounds = {glm::max(bounds.min, chosen.min), glm::min(bounds.max, chosen.max)};
        if (bounds.isEmpty()) {
            throw Error("--box", "", "holds nothing of the model", "see `pagoda info`");
        }
    }
    // A rim of free cells, so that a floor that ends with the model has one above it.
    bounds.min -= Vec3d(2 * scale_.cell);
    bounds.max += Vec3d(2 * scale_.cell);
    solid_ = std::make_unique<Occupancy>(bounds, scale_.cell, kMaxBlocks);
    scene.progress.beginStage("Reading triangles", scene.database.header().triangleCount,
                              "triangles");
    forEachTriangle(
        scene.database, scene.upright, 0.0, bounds, scene.progress, [&](const Triangle& triangle) {
            if (solid_->addTriangle(triangle)) return;
            throw Error(scene.database.path(), "",
                        fmt::format("too large for a walk at eye height {:g}", scale_.eyeHeight),
                        "choose a part with --box, or give a larger --eye-height");
        });
}

hlod::Camera cameraAt(const PathScene& scene, const Vec3d& eye, const Vec3d& gaze, double ahead,
                      double fovyDegrees) {
    hlod::Camera camera;
    camera.eye = scene.upright.toModel(eye);
    camera.target = scene.upright.toModel(eye + ahead * gaze);
    camera.up = scene.upright.toModel({0, 0, 1});
    camera.fovyDegrees = fovyDegrees;
    return camera;
}

}  // namespace pagoda::tools
