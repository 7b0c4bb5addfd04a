// simplify.h: children's merged triangles -> the triangles of their parent. The seam where a stronger
// simplifier takes over: it gets the same input and gives the same output.
#pragma once

#include "hlod/build/assemble.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::hlod {

struct SimplifyRequest {
    std::span<const SoupTriangle> triangles;  // of all children; corners carry their wedges
    CellFrame cell;
    uint32_t targetTriangles = 0;   // aimed at
    uint32_t budgetTriangles = 0;   // N: more than this is not acceptable
    const std::vector<bool>* isTranslucent = nullptr;  // by material
};

struct SimplifyResult {
    std::vector<SoupTriangle> triangles;
    bool isSloppy = false;  // clustered: not closed against its neighbours
    bool isStuck = false;   // above the target because borders and seams are locked
    uint64_t bentWedges = 0;  // corners whose stored normal is over 60 degrees off the triangle
};

// Edge collapse with every border locked, so that nodes stay closed at every cut (SEAMS.md, candidate L);
// where that leaves more than the budget, clusterTriangles().
[[nodiscard]] SimplifyResult simplifyNode(const SimplifyRequest& request);

// meshopt_simplify (0.18) with LockBorder. Edges where objects, materials or colours meet are protected
// (wedges of different vertices); normals are not: each corner takes the wedge of its new
// place that suits the triangle best. Every triangle keeps one object and one material.
[[nodiscard]] SimplifyResult collapseEdges(const SimplifyRequest& request);

// Vertex clustering on a grid made as fine as `budgetTriangles` allow (Rossignac and Borrel 1993), with
// quadric-optimal representatives (Lindstrom 2000) and mean colours. For nodes whose parts cannot merge.
[[nodiscard]] SimplifyResult clusterTriangles(const SimplifyRequest& request);

// Greatest sampled distance between two sets of triangles, both ways, in lattice steps.
[[nodiscard]] double sampledDistance(std::span<const SoupTriangle> fine, std::span<const SoupTriangle> coarse,
                                     const Vec3i& origin);

}  // namespace pagoda::hlod
