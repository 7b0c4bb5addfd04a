// torus.cpp: a closed surface with the noise of a scan: a torus whose skin is pushed along its
// normal by fractal noise, its vertices a little off the regular grid, its diagonals at random.
// Every vertex is a function of its place in the grid alone, so that patches meet in equal bits and
// each edge belongs to exactly two triangles.
#include "ooc/base/error.h"
#include "tools/generate/generator.h"
#include "tools/generate/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kMajorRadius = 10.0, kMinorRadius = 3.6;  // metres
constexpr uint32_t kPatch = 32;                            // quads a side: one batch
constexpr uint64_t kMinTriangles = 32;

class TorusSurface {
public:
    TorusSurface(uint64_t triangles, uint64_t seed) : seed_(scramble(seed + 1)) {
        // Squares on average: the long way round is about 2.8 times the short one.
        const double quads = static_cast<double>(triangles) / 2;
        rows = static_cast<uint32_t>(
            std::max(4.0, std::round(std::sqrt(quads * kMinorRadius / kMajorRadius))));
        columns = static_cast<uint32_t>(std::max(4.0, std::round(quads / rows)));
        const double spacing = 2 * std::numbers::pi * kMinorRadius / rows;
        octaves_ = std::clamp(static_cast<int>(std::log2(2.0 / spacing)), 1, 9);
        roughness_ = 0.12 * spacing;
    }

    uint32_t columns = 0, rows = 0;

    [[nodiscard]] Vec3d vertex(uint32_t column, uint32_t row) const {
        column %= columns;
        row %= rows;
        const uint64_t hash = scramble(seed_ ^ (uint64_t{column} << 32 | row));
        const auto jitter = [&](unsigned shift) {
            return static_cast<double>(hash >> shift & 0xFFFFu) / 65535.0 - 0.5;
        };
        const double u = 2 * std::numbers::pi * (column + 0.5 * jitter(0)) / columns;
        const double v = 2 * std::numbers::pi * (row + 0.5 * jitter(16)) / rows;
        const Vec3d out(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
        const Vec3d centre(kMajorRadius * std::cos(u), kMajorRadius * std::sin(u), 0.0);
        const Vec3d smooth = centre + kMinorRadius * out;
        const double height =
            0.45 * fractalNoise(smooth * 0.5, octaves_, seed_ + 7) + roughness_ * jitter(32);
        // A grid of 2^-20 m: floats hold it up to 16 m from the origin.
        return glm::round((smooth + height * out) * 0x1p20) * 0x1p-20;
    }

    [[nodiscard]] bool flipsDiagonal(uint32_t column, uint32_t row) const {
        return (scramble(seed_ + (uint64_t{row} << 32 | column)) & 1u) != 0;
    }

private:
    uint64_t seed_;
    int octaves_ = 1;
    double roughness_ = 0;  // metres, of single vertices
};

void addPatch(const TorusSurface& surface, uint32_t column0, uint32_t row0,
              ooc::TriangleBatch& batch) {
    const uint32_t width = std::min(kPatch, surface.columns - column0);
    const uint32_t height = std::min(kPatch, surface.rows - row0);
    std::array<Vec3d, (kPatch + 1) * (kPatch + 1)> grid;
    for (uint32_t j = 0; j <= height; ++j) {
        for (uint32_t i = 0; i <= width; ++i) {
            grid[j * (kPatch + 1) + i] = surface.vertex(column0 + i, row0 + j);
        }
    }
    for (uint32_t j = 0; j < height; ++j) {
        for (uint32_t i = 0; i < width; ++i) {
            const Vec3d& a = grid[j * (kPatch + 1) + i];
            const Vec3d& b = grid[j * (kPatch + 1) + i + 1];
            const Vec3d& c = grid[(j + 1) * (kPatch + 1) + i + 1];
            const Vec3d& d = grid[(j + 1) * (kPatch + 1) + i];
            if (surface.flipsDiagonal(column0 + i, row0 + j)) {
                batch.positions.insert(batch.positions.end(), {a, b, d, b, c, d});
            } else {
                batch.positions.insert(batch.positions.end(), {a, b, c, a, c, d});
            }
        }
    }
}

}  // namespace

SceneViews generateTorus(ooc::TriangleSink& sink, const GenerateOptions& options) {
    if (options.triangles < kMinTriangles) {
        throw Error("", "", "a torus needs at least 32 triangles", "raise --triangles");
    }
    const TorusSurface surface(options.triangles, options.seed);
    ooc::TriangleBatch batch;
    batch.object = sink.addObject({.name = "torus"});
    batch.material = sink.addMaterial({.name = "plaster", .colour = 0xFFC4CDD6u});
    for (uint32_t row = 0; row < surface.rows; row += kPatch) {
        for (uint32_t column = 0; column < surface.columns; column += kPatch) {
            batch.clear();
            addPatch(surface, column, row, batch);
            sink.addTriangles(batch);
        }
    }
    const Vec3d centre(0.0);
    return {.walk = {},
            .outside = {{{14, -20, 14}, centre}, {{0, -26, 6}, centre}, {{2, -2, 30}, centre}}};
}

}  // namespace pagoda::tools
