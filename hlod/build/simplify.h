// simplify.h: children's merged triangles -> the triangles of their parent. The seam where a
// stronger simplifier takes over: it gets the same input and gives the same output.
#pragma once

#include "hlod/build/assemble.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

struct SimplifyRequest {
    std::span<const SoupTriangle> triangles;  // of all children; corners carry their wedges
    // The same surface where it is finer than `triangles`, for clustering: children that were
    // clustered themselves give their proxy, the others their mesh. Empty: `triangles`.
    std::span<const SoupTriangle> finer;
    CellFrame cell;
    uint32_t targetTriangles = 0;                      // aimed at
    uint32_t budgetTriangles = 0;                      // N: more than this is not acceptable
    const std::vector<bool>* isTranslucent = nullptr;  // by material
};

struct SimplifyResult {
    std::vector<SoupTriangle> triangles;
    std::vector<SoupTriangle>
        proxy;  // of a sloppy result: what its parent clusters from, finer than `triangles`
    bool isSloppy = false;    // clustered: not closed against its neighbours
    bool isStuck = false;     // above the target because borders and seams are locked
    uint64_t bentWedges = 0;  // corners whose stored normal is over 60 degrees off the triangle
};

// Edge collapse with every border locked, so that nodes stay closed at every cut; where that leaves
// more than the budget, clusterVisible().
[[nodiscard]] SimplifyResult simplifyNode(const SimplifyRequest& request);

// meshopt_simplify (0.18) with LockBorder. Edges where objects, materials or colours meet are
// protected (wedges of different vertices); normals are not: each corner takes the wedge of its new
// place that suits the triangle best. Every triangle keeps one object and one material.
[[nodiscard]] SimplifyResult collapseEdges(const SimplifyRequest& request);

// For nodes whose parts cannot merge: clusterToBudget(); in the coarse cells only of what is
// visible from outside.
[[nodiscard]] SimplifyResult clusterVisible(const SimplifyRequest& request);

// Greatest sampled distance between two sets of triangles, both ways, in lattice steps.
[[nodiscard]] double sampledDistance(std::span<const SoupTriangle> fine,
                                     std::span<const SoupTriangle> coarse, const Vec3i& origin);

}  // namespace pagoda::hlod
