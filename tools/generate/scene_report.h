// scene_report.h: the figures of `pagoda generate --report`, measured on the triangles themselves.
#pragma once

#include "tools/generate/collected_scene.h"
#include "tools/generate/coplanar_faces.h"
#include "tools/generate/generator.h"
#include "tools/generate/item_buffer.h"

#include <cstdint>
#include <string>

namespace pagoda::tools {

struct SceneReport {
    uint64_t triangles = 0, translucentTriangles = 0, degenerateTriangles = 0;
    uint64_t objects = 0;         // with triangles
    uint64_t distinctShapes = 0;  // objects that differ by more than a move
    Box3d box;
    CoplanarFaces coplanar;
    VisibleShare visible;  // of the walk, 640x480
    size_t views = 0;
};

[[nodiscard]] SceneReport measureScene(const CollectedScene& scene, const SceneViews& views);
[[nodiscard]] std::string reportText(const SceneReport& report);
[[nodiscard]] std::string reportJson(const SceneReport& report);

}  // namespace pagoda::tools
