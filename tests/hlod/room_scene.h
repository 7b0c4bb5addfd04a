// room_scene.h: a storey of rooms in memory, as a database: walls with doors, closed to the
// outside, and clutter, so that occlusion is deep. Inner nodes are clustered on grids whose cells,
// and with them the errors, double from level to level. The index has several blocks.
#pragma once

#include "cache/page_source.h"
#include "hlod/view/camera.h"
#include "tests/viewer/memory_scene.h"

#include <cstdint>
#include <set>
#include <unordered_map>
#include <vector>

namespace pagoda::hlod::test {

class RoomScene final : public cache::PageSource {
public:
    struct Options {
        int roomsAcross = 6;  // in both directions; at most 6
        int boxesPerRoom = 24;
        double doorShare = 0.4;  // of inner walls; closed ones hide what is behind for good
        size_t leafTriangles = 100;
        uint32_t seed = 1;
    };
    explicit RoomScene(const Options& options);
    RoomScene() : RoomScene(Options{}) {}

    // There are no bytes: what is decoded is looked up.
    std::string read(uint64_t, std::span<std::byte>) const override { return {}; }
    ooc::Loaded<ooc::Page> decodePage(const ooc::NodeRecord& node,
                                      std::span<const std::byte> bytes) const override;
    uint32_t blockCount() const override { return static_cast<uint32_t>(blocks.size()); }
    cache::ByteRange blockRange(uint32_t block) const override;
    ooc::Loaded<ooc::IndexBlock> decodeBlock(uint32_t block,
                                             std::span<const std::byte> bytes) const override;

    // In the middle of a room, at eye height.
    [[nodiscard]] Vec3d roomCentre(int x, int y) const;
    // A walk through the rooms' middles that looks along its way: `step` from 0 to `steps`.
    [[nodiscard]] Camera walk(int step, int steps) const;
    [[nodiscard]] const ooc::NodeRecord& record(ooc::NodeId node) const;
    [[nodiscard]] size_t nodeCount() const { return pages.size(); }

    ooc::Lattice lattice;
    std::vector<ooc::IndexBlock> blocks;
    std::unordered_map<uint64_t, ooc::Page> pages;  // by NodeId::value
    std::set<ooc::NodeId> failing;                  // pages whose bytes are broken
    std::set<uint32_t> failingBlocks;

private:
    using Triangles = std::vector<pagoda::test::Triangle>;
    struct Place {
        uint32_t block = 0, index = 0;
    };
    Triangles makeTriangles() const;
    void build(Place place, ooc::NodeId id, const Vec3i& cell, int bits, Triangles triangles);
    Box3i addChildren(Place place, ooc::NodeId id, const Vec3i& cell, int bits,
                      const Triangles& triangles);

    Options options_;
    uint64_t fileBytes_ = 4096;
};

}  // namespace pagoda::hlod::test
