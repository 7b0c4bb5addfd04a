#include "tests/hlod/room_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

namespace pagoda::hlod::test {
namespace {

using pagoda::test::MemoryScene;
using pagoda::test::Triangle;

constexpr int kFirst = 200, kRoom = 600, kHeight = 256, kEye = 140;
constexpr int kDoorHeight = 190, kDoorFrom = 230, kDoorTo = 370;
constexpr int kExtentBits = 12, kGridBits = 4;  // of the scene; cells of an inner node's grid
constexpr uint64_t kBlockOffset = uint64_t{1} << 40, kBlockSpacing = 1 << 20;
constexpr int kDepthOfSubtreeBlocks = 2;

void addQuad(std::vector<Triangle>& out, const Vec3i& corner, const Vec3i& u, const Vec3i& v) {
    const Vec3i a = corner, b = corner + u, c = corner + u + v, d = corner + v;
    out.push_back({{a, b, c}});
    out.push_back({{a, c, d}});
}

void addBox(std::vector<Triangle>& out, const Vec3i& least, const Vec3i& size) {
    const Vec3i x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    for (const Vec3i& corner : {least, least + z}) addQuad(out, corner, x, y);
    for (const Vec3i& corner : {least, least + y}) addQuad(out, corner, x, z);
    for (const Vec3i& corner : {least, least + x}) addQuad(out, corner, y, z);
}

// From `corner` along `along` (one room), with or without a door.
void addWall(std::vector<Triangle>& out, const Vec3i& corner, const Vec3i& along, bool hasDoor) {
    const Vec3i up(0, 0, kHeight);
    if (!hasDoor) return addQuad(out, corner, along * kRoom, up);
    addQuad(out, corner, along * kDoorFrom, up);
    addQuad(out, corner + along * kDoorTo, along * (kRoom - kDoorTo), up);
    addQuad(out, corner + along * kDoorFrom + Vec3i(0, 0, kDoorHeight),
            along * (kDoorTo - kDoorFrom), {0, 0, kHeight - kDoorHeight});
}

// Corners on a grid of `cell`; what has no area any more, and what is there already, goes.
std::vector<Triangle> clustered(const std::vector<Triangle>& triangles, int cell) {
    std::vector<Triangle> result;
    std::set<std::array<std::array<int, 3>, 3>> seen;
    for (Triangle t : triangles) {
        std::array<std::array<int, 3>, 3> key;
        for (size_t i = 0; i < 3; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                t.corners[i][axis] = (t.corners[i][axis] + cell / 2) / cell * cell;
            }
            key[i] = {t.corners[i].x, t.corners[i].y, t.corners[i].z};
        }
        const Vec3d u(t.corners[1] - t.corners[0]), v(t.corners[2] - t.corners[0]);
        std::sort(key.begin(), key.end());
        if (glm::cross(u, v) != Vec3d(0.0) && seen.insert(key).second) result.push_back(t);
    }
    if (result.empty()) result.push_back(triangles.front());
    return result;
}

}  // namespace

RoomScene::RoomScene(const Options& options) : options_(options) {
    lattice.extentBits = kExtentBits;
    blocks.resize(1);
    blocks[0].nodes.resize(1);
    build({0, 0}, ooc::NodeId::root(), Vec3i(0), kExtentBits, makeTriangles());
}

RoomScene::Triangles RoomScene::makeTriangles() const {
    std::mt19937 random(options_.seed);
    const auto whole = [&](int least, int most) {
        return std::uniform_int_distribution<int>(least, most)(random);
    };
    const auto isDoor = [&] { return whole(0, 999) < 1000 * options_.doorShare; };
    Triangles out;
    const int rooms = options_.roomsAcross;
    for (int y = 0; y <= rooms; ++y) {
        for (int x = 0; x <= rooms; ++x) {
            const Vec3i corner(kFirst + kRoom * x, kFirst + kRoom * y, 0);
            if (x < rooms) addWall(out, corner, {1, 0, 0}, y > 0 && y < rooms && isDoor());
            if (y < rooms) addWall(out, corner, {0, 1, 0}, x > 0 && x < rooms && isDoor());
            if (x == rooms || y == rooms) continue;
            for (const int z : {0, kHeight}) {
                addQuad(out, corner + Vec3i(0, 0, z), {kRoom, 0, 0}, {0, kRoom, 0});
            }
            for (int i = 0; i < options_.boxesPerRoom; ++i) {
                const Vec3i size(whole(12, 70), whole(12, 70), whole(12, 110));
                const Vec3i at(whole(0, kRoom - size.x), whole(0, kRoom - size.y),
                               i % 4 == 0 ? kHeight - size.z : 0);
                addBox(out, corner + at, size);
            }
        }
    }
    return out;
}

void RoomScene::build(Place place, ooc::NodeId id, const Vec3i& cell, int bits,
                      Triangles triangles) {
    Box3i box;
    for (const Triangle& t : triangles) {
        for (const Vec3i& corner : t.corners) box.extend(corner);
    }
    const bool isLeaf = triangles.size() <= options_.leafTriangles || bits <= kGridBits;
    if (!isLeaf) box.extend(addChildren(place, id, cell, bits, triangles));
    const int grid = 1 << (bits - kGridBits);
    const ooc::Page page = MemoryScene::makePage(isLeaf ? triangles : clustered(triangles, grid));
    box.extend(page.mesh.box());
    ooc::NodeRecord& record = blocks[place.block].nodes[place.index];
    record.id = id;
    record.box = box;
    // A corner moves by half a cell in each direction.
    record.errorModelUnits = isLeaf ? 0.0 : 0.5 * std::sqrt(3.0) * grid * lattice.step();
    record.flags = ooc::kNodeHasColours;
    record.triangleCount = page.mesh.triangleCount();
    record.opaqueTriangleCount = page.mesh.opaqueTriangleCount();
    record.vertexCount = page.mesh.vertexCount();
    record.pageBytes = 64 + 16 * record.triangleCount;
    record.pageOffset = fileBytes_;
    fileBytes_ += record.pageBytes;
    pages[id.value] = page;
}

Box3i RoomScene::addChildren(Place place, ooc::NodeId id, const Vec3i& cell, int bits,
                             const Triangles& triangles) {
    const int half = 1 << (bits - 1);
    std::map<uint32_t, Triangles> octants;
    for (const Triangle& t : triangles) {
        const Vec3i sum = t.corners[0] + t.corners[1] + t.corners[2];
        uint32_t octant = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (sum[axis] >= 3 * (cell[axis] + half)) octant |= 1u << axis;
        }
        octants[octant].push_back(t);
    }
    uint32_t block = place.block;
    if (id.depth() == kDepthOfSubtreeBlocks) {
        block = static_cast<uint32_t>(blocks.size());
        blocks.emplace_back();
    }
    const auto first = static_cast<uint32_t>(blocks[block].nodes.size());
    blocks[block].nodes.resize(first + octants.size());
    ooc::NodeRecord& record = blocks[place.block].nodes[place.index];
    record.childBlock = block;
    record.childIndex = first;
    for (const auto& [octant, part] : octants) {
        record.childMask |= static_cast<uint16_t>(1u << octant);
    }
    Box3i box;
    uint32_t next = first;
    for (auto& [octant, part] : octants) {
        Vec3i corner = cell;
        for (int axis = 0; axis < 3; ++axis)
            corner[axis] += ((octant >> axis) & 1u) != 0 ? half : 0;
        build({block, next}, id.child(octant), corner, bits - 1, std::move(part));
        box.extend(blocks[block].nodes[next++].box);
    }
    return box;
}

ooc::Loaded<ooc::Page> RoomScene::decodePage(const ooc::NodeRecord& node,
                                             std::span<const std::byte>) const {
    if (failing.contains(node.id)) return {std::nullopt, "checksum is wrong"};
    return {pages.at(node.id.value), ""};
}

cache::ByteRange RoomScene::blockRange(uint32_t block) const {
    return {kBlockOffset + block * kBlockSpacing, 96 * blocks[block].nodes.size()};
}

ooc::Loaded<ooc::IndexBlock> RoomScene::decodeBlock(uint32_t block,
                                                    std::span<const std::byte>) const {
    if (failingBlocks.contains(block)) return {std::nullopt, "checksum is wrong"};
    return {blocks[block], ""};
}

Vec3d RoomScene::roomCentre(int x, int y) const {
    return {kFirst + kRoom * (x + 0.5), kFirst + kRoom * (y + 0.5), kEye};
}

// Along the diagonal of rooms, through walls where need be, swaying.
Camera RoomScene::walk(int step, int steps) const {
    const double s = static_cast<double>(step) / steps;
    const double last = options_.roomsAcross - 1;
    const auto at = [&](double t) {
        return Vec3d(kFirst + kRoom * (0.5 + last * t), kFirst + kRoom * (0.5 + 0.9 * last * t * t),
                     kEye + 20 * std::sin(9 * t));
    };
    Camera camera;
    camera.eye = at(s);
    const double yaw = 2.5 * std::sin(7 * s);
    camera.target = camera.eye + Vec3d(std::cos(yaw), std::sin(yaw), -0.1);
    camera.up = {0.03, 0, 1};
    camera.fovyDegrees = 60;
    camera.widthPx = 64;
    camera.heightPx = 48;
    return camera;
}

const ooc::NodeRecord& RoomScene::record(ooc::NodeId node) const {
    const ooc::NodeRecord* found = nullptr;
    for (const ooc::IndexBlock& block : blocks) {
        for (const ooc::NodeRecord& candidate : block.nodes) {
            if (candidate.id == node) found = &candidate;
        }
    }
    return *found;
}

}  // namespace pagoda::hlod::test
