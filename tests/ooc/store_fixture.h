// store_fixture.h: random meshes, what must survive a round trip, and small databases to break.
#pragma once

#include "ooc/store/database.h"
#include "ooc/store/database_writer.h"

#include <array>
#include <filesystem>
#include <functional>
#include <random>
#include <tuple>
#include <vector>

namespace pagoda::ooc::test {

struct MeshOptions {
    uint32_t triangleCount = 200;
    int32_t extent = 1000;  // lattice points lie in [origin, origin + extent]
    Vec3i origin{0};
    bool hasColours = true, hasNormals = true, hasTranslucent = true;
    uint32_t objectCount = 5, materialCount = 3;
};

// Vertices shared by several triangles, a part for every octant, several runs a part.
[[nodiscard]] PageMesh randomMesh(std::mt19937& random, const MeshOptions& options);

// A corner with all that it carries, and a triangle with its run, part and object: what a page must
// keep. Of a triangle's three rotations the least, so that rotation does not matter.
using Corner = std::tuple<int32_t, int32_t, int32_t, uint32_t, int8_t, int8_t>;
using TriangleKey = std::tuple<uint32_t, uint32_t, std::array<Corner, 3>>;  // part, run
[[nodiscard]] std::vector<TriangleKey> sortedTriangles(const PageMesh& mesh);

// A folder of its own under the system's, removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

// A sound database: a random octree over `leafMeshes`-like leaves, three objects and two materials
// (the second translucent). Parents hold their leaves' first triangles. Deterministic.
struct DatabaseOptions {
    Codec codec = Codec::Raw;
    uint32_t depth = 2;  // levels below the root
    uint32_t childrenPerNode = 3;
    uint32_t leafTriangles = 6;
    bool hasExtraLeaf = true;  // below the root
    uint32_t seed = 1;
    std::function<void(DatabaseWriter::Content&)> spoil{};  // the last word before publish()
};
[[nodiscard]] DatabaseWriter::Content writeDatabase(const std::filesystem::path& path,
                                                    const DatabaseOptions& options);

}  // namespace pagoda::ooc::test
