// surface_distance.h: distance of points to a triangle mesh, exact for the mesh in float
// coordinates about a local origin. A binary tree of boxes over the triangles, median splits,
// leaves of a few.
#pragma once

#include "ooc/base/box.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

class SurfaceDistance {
public:
    // `indices`: 3 a triangle, not empty. Copies what it needs.
    SurfaceDistance(std::span<const Vec3f> positions, std::span<const uint32_t> indices);

    // Squared distance from `point` to the mesh, or any upper bound of it that is <= `enough`: who
    // seeks the greatest distance of many points passes the greatest so far and is spared nearly
    // every walk. `nearTriangle` holds a guess (any triangle's number) and receives the nearest
    // seen: pass the last answer for a nearby point.
    [[nodiscard]] float squaredDistance(const Vec3f& point, uint32_t& nearTriangle,
                                        float enough = 0.0f) const;

private:
    struct Corners {
        Vec3f a, ab, ac;
    };
    struct Node {
        Vec3f min, max;
        uint32_t first = 0;  // leaf: first triangle; inner: left child, the right one follows
        uint32_t count = 0;  // triangles of a leaf; 0: inner
    };
    void split(uint32_t node, std::vector<Vec3f>& centroids, std::vector<uint32_t>& order,
               uint32_t begin, uint32_t end, std::span<const Vec3f> positions,
               std::span<const uint32_t> indices);

    std::vector<Node> nodes_;
    std::vector<Corners> triangles_;   // in tree order
    std::vector<uint32_t> treeOrder_;  // caller's number of a tree triangle
    std::vector<uint32_t> treePlace_;  // and back
};

}  // namespace pagoda::hlod
