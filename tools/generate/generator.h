// generator.h: the test models of `pagoda generate`, computed as they are written.
// Each generator sends its model to a TriangleSink, object by object; memory does not grow with it.
// The same kind, triangle count and seed give the same triangles in the same order.
#pragma once

#include "ooc/readers/reader.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace pagoda::tools {

struct Viewpoint {
    Vec3d eye, target;  // metres, z up
};

// Where to look at a model from.
struct SceneViews {
    std::vector<Viewpoint> walk;     // at eye height along its insides; empty: it has none
    std::vector<Viewpoint> outside;  // the whole of it
};

struct GenerateOptions {
    uint64_t triangles = 0;  // wanted; met within 5%
    uint64_t seed = 1;
};

struct Generator {
    std::string_view name, description;
    uint64_t defaultTriangles;
    // Throws Error when so few triangles cannot make the scene.
    SceneViews (*generate)(ooc::TriangleSink& sink, const GenerateOptions& options);
};

[[nodiscard]] const std::vector<Generator>& generators();
// nullptr for an unknown name.
[[nodiscard]] const Generator* findGenerator(std::string_view name);

// One a file, in the order of --list.
SceneViews generateTorus(ooc::TriangleSink& sink, const GenerateOptions& options);
SceneViews generatePowerplant(ooc::TriangleSink& sink, const GenerateOptions& options);
SceneViews generateCity(ooc::TriangleSink& sink, const GenerateOptions& options);
SceneViews generateInterior(ooc::TriangleSink& sink, const GenerateOptions& options);

}  // namespace pagoda::tools
