// walk.h: the inside of a model as a walker meets it; what walk and teleport share.
#pragma once

#include "tools/paths/floor_plan.h"
#include "tools/paths/makers.h"
#include "tools/paths/tour.h"

#include <memory>

namespace pagoda::tools {

// Lengths in model units.
struct WalkScale {
    double eyeHeight = 1.7, cell = 0.09;
};

// The eye height that is given, or guessed from the diagonal; a guess is said aloud.
[[nodiscard]] WalkScale walkScale(const PathScene& scene, const PathOptions& options);

// Streams the leaves once. About 400 MB at most.
class Inside {
public:
    // Throws Error when the model has no indoor floor to walk on, or too much of it.
    Inside(const PathScene& scene, const PathOptions& options);

    [[nodiscard]] const WalkScale& scale() const noexcept { return scale_; }
    [[nodiscard]] const Occupancy& solid() const noexcept { return *solid_; }
    [[nodiscard]] const FloorPlan& plan() const noexcept { return *plan_; }
    [[nodiscard]] Tour& tour() noexcept { return *tour_; }

private:
    void readTriangles(const PathScene& scene, const PathOptions& options);

    WalkScale scale_;
    std::unique_ptr<Occupancy> solid_;
    std::unique_ptr<FloorPlan> plan_;
    std::unique_ptr<Tour> tour_;
};

// Directions in which a person at `eyes[i]`, walking along them, looks: mostly ahead, rather into
// open space than at walls, now and then to a side. Eyes are `spacing` apart.
[[nodiscard]] std::vector<Vec3d> gazesAlong(const std::vector<Vec3d>& eyes, double spacing,
                                            const Occupancy& solid, double eyeHeight,
                                            uint64_t seed);

// An upright pose as a camera of the model. Its target lies `ahead` model units before the eye.
[[nodiscard]] hlod::Camera cameraAt(const PathScene& scene, const Vec3d& eye, const Vec3d& gaze,
                                    double ahead, double fovyDegrees);

}  // namespace pagoda::tools
