// obj_faces.h: turns the face lines of an OBJ file into triangles of objects and materials.
#pragma once

#include "ooc/readers/obj_materials.h"
#include "ooc/readers/obj_vertices.h"
#include "ooc/readers/polygon.h"
#include "ooc/readers/triangle_batcher.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pagoda::ooc {

// An object is a pair of an "o" and a "g" name: the same pair seen again is the same object. A
// group within an "o" is its child. Objects and materials reach the sink with their first face.
class ObjFaces {
public:
    ObjFaces(const ObjVertices& vertices, const ObjMaterials& materials, TriangleSink& sink);

    void setObject(std::string_view name);  // ends the group as well
    void setGroup(std::string_view name);   // all of the line: several names are one
    void setMaterial(std::string_view name);
    // What follows "f", in a file that had so many positions and normals before this line: negative
    // indices count back from there, and an index beyond is out of range.
    void face(TextCursor corners, uint64_t positionsSoFar, uint64_t normalsSoFar);
    void finish();

private:
    static constexpr uint32_t kUnknown = UINT32_MAX;
    static constexpr uint64_t kNone = UINT64_MAX;
    struct Reference {
        uint64_t position = kNone, normal = kNone;  // from 0
    };

    [[nodiscard]] Reference parseCorner(TextCursor& corners, uint64_t positionsSoFar,
                                        uint64_t normalsSoFar);
    void cutPolygon();
    void fan();
    void triangle(const Reference& a, const Reference& b, const Reference& c);
    [[nodiscard]] Corner cornerOf(const Reference& reference) const;
    void aim();
    [[nodiscard]] uint32_t objectId(const std::string& object, const std::string& group);
    [[nodiscard]] uint32_t materialId();

    const ObjVertices& vertices_;
    const ObjMaterials& library_;
    TriangleSink& sink_;
    TriangleBatcher batcher_;
    PolygonCutter cutter_;
    std::vector<Reference> corners_;
    std::vector<Vec3d> positions_;

    std::string object_, group_, material_;
    bool isAimed_ = false;  // the batcher's target is the current object and material
    uint32_t colour_ = 0xFFFFFFFFu;
    std::map<std::pair<std::string, std::string>, uint32_t> objectIds_;
    std::map<std::string, std::pair<uint32_t, uint32_t>> materialIds_;  // id, colour
    uint64_t undefinedMaterials_ = 0, textures_ = 0, missingNormals_ = 0, fans_ = 0;
};

}  // namespace pagoda::ooc
