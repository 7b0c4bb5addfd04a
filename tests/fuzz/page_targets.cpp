// What page_codec.h promises: any bytes give a page or a fault, and a page that was encoded comes
// back with the same triangles.
#include "ooc/codecs/page_codec.h"
#include "tests/fuzz/targets.h"

#include <algorithm>
#include <array>
#include <compare>
#include <cstring>
#include <vector>

namespace pagoda::fuzz {
namespace {

using ooc::Codec;
using ooc::Page;
using ooc::PageMesh;

struct Corner {
    std::array<int32_t, 3> position{};
    uint32_t colour = 0;
    int8_t u = 0, v = 0;
    [[nodiscard]] auto operator<=>(const Corner&) const = default;
};
struct Triangle {
    size_t run = 0;
    std::array<Corner, 3> corners;
    [[nodiscard]] auto operator<=>(const Triangle&) const = default;
};

// A mesh as an unordered set of triangles with their attributes.
std::vector<Triangle> trianglesOf(const PageMesh& mesh) {
    std::vector<Triangle> triangles;
    size_t run = 0, left = mesh.runs.empty() ? 0 : mesh.runs[0].triangleCount;
    for (size_t t = 0; t < mesh.indices.size() / 3; ++t) {
        while (left == 0) left = mesh.runs[++run].triangleCount;
        --left;
        Triangle triangle{.run = run, .corners = {}};
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t vertex = mesh.indices[3 * t + k];
            const Vec3i& p = mesh.positions[vertex];
            Corner& corner = triangle.corners[k];
            corner.position = {p.x, p.y, p.z};
            corner.colour = mesh.colours.empty() ? mesh.constantColour : mesh.colours[vertex];
            if (!mesh.normals.empty()) {
                corner.u = mesh.normals[vertex].u;
                corner.v = mesh.normals[vertex].v;
            }
        }
        // Of the three rotations the least: two corners may be the same.
        auto& corners = triangle.corners;
        std::array rotated = corners;
        for (int turn = 0; turn < 2; ++turn) {
            std::rotate(rotated.begin(), rotated.begin() + 1, rotated.end());
            corners = std::min(corners, rotated);
        }
        triangles.push_back(triangle);
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

std::vector<Triangle> trianglesOf(const ooc::Zipper& zipper) {
    PageMesh mesh;
    mesh.positions = zipper.positions;
    mesh.indices = zipper.indices;
    mesh.runs.push_back({.triangleCount = mesh.triangleCount()});
    return trianglesOf(mesh);
}

void requireValid(const PageMesh& mesh) {
    uint64_t inRuns = 0;
    for (const ooc::MeshRun& run : mesh.runs) inRuns += run.triangleCount;
    require(mesh.indices.size() % 3 == 0, "whole triangles");
    require(inRuns == mesh.triangleCount(), "runs sum to the triangles");
    require(mesh.partStart[0] == 0 && mesh.partStart[ooc::kPageParts] == mesh.triangleCount() &&
                std::is_sorted(mesh.partStart.begin(), mesh.partStart.end()),
            "parts tile the triangles");
    require(mesh.colours.empty() || mesh.colours.size() == mesh.positions.size(), "colours");
    require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size(), "normals");
    for (const uint32_t index : mesh.indices) require(index < mesh.vertexCount(), "indices");
}

void requireRoundTrip(const Page& page) {
    for (const Codec codec : {Codec::Raw, Codec::Meshopt, Codec::Draco}) {
        const auto again = ooc::decodePage(ooc::encodePage(page, codec));
        require(again.page.has_value(), "what was encoded decodes");
        require(again.page->mesh.runs == page.mesh.runs, "runs survive");
        require(again.page->mesh.partStart == page.mesh.partStart, "parts survive");
        require(trianglesOf(again.page->mesh) == trianglesOf(page.mesh), "triangles survive");
        require(again.page->zippers.size() == page.zippers.size(), "zippers survive");
        for (size_t i = 0; i < page.zippers.size(); ++i) {
            const ooc::Zipper &zipper = page.zippers[i], &back = again.page->zippers[i];
            require(back.neighbour == zipper.neighbour, "a zipper's neighbour survives");
            require(trianglesOf(zipper) == trianglesOf(back), "a zipper's triangles survive");
        }
    }
}

// Takes values off the input; zeros behind its end.
class Bytes {
public:
    explicit Bytes(std::span<const std::byte> bytes) : bytes_(bytes) {}
    template <typename Value>
    [[nodiscard]] Value take() {
        Value value{};
        const size_t size = std::min(sizeof value, bytes_.size());
        if (size > 0) std::memcpy(&value, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
        return value;
    }
    [[nodiscard]] bool isEmpty() const { return bytes_.empty(); }

private:
    std::span<const std::byte> bytes_;
};

// Any valid mesh of up to 255 vertices, shaped by the input.
PageMesh takeMesh(Bytes& in) {
    PageMesh mesh;
    const auto vertexCount = in.take<uint8_t>();
    const auto features = in.take<uint8_t>();
    mesh.constantColour = in.take<uint32_t>();
    constexpr uint32_t kLatticeMask = (1u << 30) - 1;
    for (uint32_t i = 0; i < vertexCount; ++i) {
        const auto point = [&] { return static_cast<int32_t>(in.take<uint32_t>() & kLatticeMask); };
        const int32_t x = point(), y = point(), z = point();
        mesh.positions.emplace_back(x, y, z);
        if (features & 1u) mesh.colours.push_back(in.take<uint32_t>());
        if (features & 2u) mesh.normals.push_back({in.take<int8_t>(), in.take<int8_t>()});
    }
    uint32_t part = 0;
    while (vertexCount > 0 && !in.isEmpty()) {
        const auto step = in.take<uint8_t>();  // low bits: to a later part; high bit: a new run
        const uint32_t newPart = std::min<uint32_t>(part + (step & 7u), ooc::kPageParts - 1);
        while (part < newPart) mesh.partStart[++part] = mesh.triangleCount();
        for (int k = 0; k < 3; ++k) mesh.indices.push_back(in.take<uint8_t>() % vertexCount);
        const bool isNewPart = mesh.partStart[part] + 1 == mesh.triangleCount();
        if (mesh.runs.empty() || isNewPart || (step & 128u)) {
            mesh.runs.push_back({.triangleCount = 0,
                                 .object = in.take<uint16_t>(),
                                 .material = in.take<uint16_t>()});
        }
        ++mesh.runs.back().triangleCount;
    }
    while (part < ooc::kPageParts) mesh.partStart[++part] = mesh.triangleCount();
    return mesh;
}

}  // namespace

void decodeAnyPage(std::span<const std::byte> input) {
    const ooc::DecodeResult result = ooc::decodePage(input);
    require(result.page.has_value() == result.fault.empty(), "a page or a fault");
    if (!result.page) return;
    requireValid(result.page->mesh);
    requireRoundTrip(*result.page);
}

void encodeAnyMesh(std::span<const std::byte> input) {
    Bytes in(input);
    Page page{.mesh = takeMesh(in), .zippers = {}};
    requireValid(page.mesh);
    requireRoundTrip(page);
}

}  // namespace pagoda::fuzz
