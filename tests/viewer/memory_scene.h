// memory_scene.h: a small octree HLOD made in memory, for tests: leaves hold the given triangles,
// inner nodes the same triangles clustered on a coarse grid. Seams of mixed cuts are not closed.
// Pages and blocks can be made to fail.
#pragma once

#include "cache/page_source.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace pagoda::test {

struct Triangle {
    Vec3i corners[3];
    uint32_t colour = 0xFFB0B0B0u;  // translucent when its alpha is below 255
    uint32_t object = 0;
};

class MemoryScene final : public cache::PageSource {
public:
    ooc::Lattice lattice;
    ooc::IndexBlock block;
    std::map<ooc::NodeId, ooc::Page> pages;
    std::set<ooc::NodeId> failing;

    // There are no bytes: what is decoded is looked up.
    std::string read(uint64_t, std::span<std::byte>) const override { return {}; }
    ooc::Loaded<ooc::Page> decodePage(const ooc::NodeRecord& node,
                                      std::span<const std::byte>) const override {
        if (failing.contains(node.id)) return {std::nullopt, "checksum is wrong"};
        return {pages.at(node.id), ""};
    }
    uint32_t blockCount() const override { return 1; }
    cache::ByteRange blockRange(uint32_t) const override {
        return {uint64_t{1} << 40, 96 * block.nodes.size()};
    }
    ooc::Loaded<ooc::IndexBlock> decodeBlock(uint32_t, std::span<const std::byte>) const override {
        return {block, ""};
    }

    // A leaf holds at most `leafTriangles`, or its cell is a single lattice cell.
    static MemoryScene make(const ooc::Lattice& lattice, const std::vector<Triangle>& triangles,
                            size_t leafTriangles) {
        MemoryScene scene;
        scene.lattice = lattice;
        scene.block.nodes.resize(1);
        scene.fillNode(0, ooc::NodeId::root(), Vec3i(0), lattice.extentBits, triangles,
                       leafTriangles);
        return scene;
    }

    // A root and its children as leaves, by octant: what each holds is the test's own choice.
    static MemoryScene withLeaves(const ooc::Lattice& lattice,
                                  const std::map<uint32_t, std::vector<Triangle>>& leaves) {
        MemoryScene scene;
        scene.lattice = lattice;
        scene.block.nodes.resize(1 + leaves.size());
        std::vector<Triangle> all;
        size_t next = 1;
        for (const auto& [octant, triangles] : leaves) {
            scene.setNode(next++, ooc::NodeId::root().child(octant), triangles, 0.0);
            scene.block.nodes[0].childMask |= static_cast<uint16_t>(1u << octant);
            all.insert(all.end(), triangles.begin(), triangles.end());
        }
        scene.block.nodes[0].childIndex = 1;
        scene.setNode(0, ooc::NodeId::root(), all, lattice.step());
        return scene;
    }

    // Fills in a node's page and all of its record but the links to its children.
    void setNode(size_t index, ooc::NodeId id, const std::vector<Triangle>& triangles,
                 double errorModelUnits) {
        const ooc::Page page = makePage(triangles);
        ooc::NodeRecord& record = block.nodes[index];
        record.id = id;
        record.box = page.mesh.box();
        record.errorModelUnits = errorModelUnits;
        record.flags = ooc::kNodeHasColours;
        record.triangleCount = page.mesh.triangleCount();
        record.opaqueTriangleCount = page.mesh.opaqueTriangleCount();
        record.vertexCount = page.mesh.vertexCount();
        if (record.opaqueTriangleCount < record.triangleCount)
            record.flags |= ooc::kNodeHasTranslucent;
        record.pageBytes = 1;
        record.pageOffset = index;
        pages[id] = page;
    }

    static ooc::Page makePage(const std::vector<Triangle>& triangles) {
        ooc::Page page;
        ooc::PageMesh& mesh = page.mesh;
        std::vector<Triangle> sorted = triangles;
        const auto isTranslucent = [](const Triangle& t) { return t.colour >> 24 != 255; };
        std::stable_sort(sorted.begin(), sorted.end(), [&](const Triangle& a, const Triangle& b) {
            return std::pair(isTranslucent(a), a.object) < std::pair(isTranslucent(b), b.object);
        });
        std::map<std::pair<std::vector<int>, uint32_t>, uint32_t> welded;
        for (const Triangle& t : sorted) {
            const bool isFirst = &t == &sorted.front();
            if (isFirst || t.object != (&t)[-1].object ||
                isTranslucent(t) != isTranslucent((&t)[-1])) {
                mesh.runs.push_back({0, t.object, isTranslucent(t) ? 1u : 0u});
            }
            ++mesh.runs.back().triangleCount;
            for (const Vec3i& p : t.corners) {
                const auto next = static_cast<uint32_t>(mesh.positions.size());
                const auto [at, isNew] =
                    welded.emplace(std::pair{std::vector<int>{p.x, p.y, p.z}, t.colour}, next);
                if (isNew) {
                    mesh.positions.push_back(p);
                    mesh.colours.push_back(t.colour);
                }
                mesh.indices.push_back(at->second);
            }
        }
        const auto opaque = static_cast<uint32_t>(std::count_if(
            sorted.begin(), sorted.end(), [&](const Triangle& t) { return !isTranslucent(t); }));
        mesh.partStart.fill(opaque);
        mesh.partStart[0] = 0;
        mesh.partStart[ooc::kPageParts] = mesh.triangleCount();
        return page;
    }

private:
    void fillNode(size_t index, ooc::NodeId id, const Vec3i& cell, int bits,
                  const std::vector<Triangle>& triangles, size_t leafTriangles) {
        Box3i box;
        for (const Triangle& t : triangles) {
            for (const Vec3i& corner : t.corners) box.extend(corner);
        }
        const bool isLeaf = triangles.size() <= leafTriangles || bits == 0;
        if (!isLeaf) addChildren(index, id, cell, bits, triangles, leafTriangles, box);
        const double error = isLeaf ? 0.0 : std::ldexp(lattice.step(), bits - kClusterBits + 1);
        setNode(index, id, isLeaf ? triangles : clustered(triangles, bits), error);
        block.nodes[index].box.extend(box);
    }

    void addChildren(size_t index, ooc::NodeId id, const Vec3i& cell, int bits,
                     const std::vector<Triangle>& triangles, size_t leafTriangles, Box3i& box) {
        const int half = 1 << (bits - 1);
        std::map<uint32_t, std::vector<Triangle>> octants;
        for (const Triangle& t : triangles) {
            const glm::dvec3 centre =
                (Vec3d(t.corners[0]) + Vec3d(t.corners[1]) + Vec3d(t.corners[2])) / 3.0;
            uint32_t octant = 0;
            for (int axis = 0; axis < 3; ++axis) {
                if (centre[axis] >= cell[axis] + half) octant |= 1u << axis;
            }
            octants[octant].push_back(t);
        }
        const size_t first = block.nodes.size();
        block.nodes.resize(first + octants.size());
        block.nodes[index].childIndex = static_cast<uint32_t>(first);
        size_t next = first;
        for (auto& [octant, part] : octants) {
            block.nodes[index].childMask |= static_cast<uint16_t>(1u << octant);
            Vec3i corner = cell;
            for (int axis = 0; axis < 3; ++axis)
                corner[axis] += ((octant >> axis) & 1u) != 0 ? half : 0;
            fillNode(next, id.child(octant), corner, bits - 1, part, leafTriangles);
            box.extend(block.nodes[next++].box);
        }
    }

    static constexpr int kClusterBits = 4;
    static std::vector<Triangle> clustered(const std::vector<Triangle>& triangles, int bits) {
        const int shift = std::max(0, bits - kClusterBits);
        std::vector<Triangle> result;
        for (Triangle t : triangles) {
            // Every other corner stays where it is, so that nodes of different levels share points.
            for (Vec3i& p : t.corners) {
                if (((p.x ^ p.y ^ p.z) & 1) != 0) p = (p >> shift) << shift;
            }
            if (t.corners[0] == t.corners[1] || t.corners[1] == t.corners[2] ||
                t.corners[2] == t.corners[0]) {
                continue;
            }
            result.push_back(t);
        }
        if (result.empty()) result.push_back(triangles.front());
        return result;
    }
};

// A bumpy closed sphere of 2 * rings * (2 * rings) triangles around `centre`.
inline std::vector<Triangle> bumpySphere(const Vec3d& centre, double radius, int rings,
                                         uint32_t colour = 0xFF60A0E0u) {
    const int columns = 2 * rings;
    const auto point = [&](int row, int column) {
        const double theta = 3.14159265358979 * row / rings;
        const double phi = 2 * 3.14159265358979 * (column % columns) / columns;
        const double r = radius * (1.0 + 0.05 * std::sin(5 * phi) * std::sin(7 * theta));
        const Vec3d p = centre + r * Vec3d(std::sin(theta) * std::cos(phi),
                                           std::sin(theta) * std::sin(phi), std::cos(theta));
        return Vec3i(glm::round(p));
    };
    std::vector<Triangle> triangles;
    const auto add = [&](Vec3i a, Vec3i b, Vec3i c) {
        if (a != b && b != c && c != a) triangles.push_back({{a, b, c}, colour});
    };
    for (int row = 0; row < rings; ++row) {
        for (int column = 0; column < columns; ++column) {
            const Vec3i a = point(row, column), b = point(row + 1, column);
            const Vec3i c = point(row + 1, column + 1), d = point(row, column + 1);
            add(a, b, c);
            add(a, c, d);
        }
    }
    return triangles;
}

}  // namespace pagoda::test
