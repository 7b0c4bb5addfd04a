// scene_kit.h: what the generators build their scenes from: objects, materials and shapes, written
// as triangles the moment they are made. Metres, z up, right-handed; triangles face outwards.
//
// A kit without a sink only counts: that is how a generator finds the detail at which its scene has
// the number of triangles asked for, before it makes the first one. Everything is deterministic.
//
// No two faces may lie on each other (z-fighting, and worthless for measuring visibility): shapes
// that touch poke into each other by a few millimetres, or leave a gap. `generate --report` checks.
#pragma once

#include "ooc/readers/reader.h"
#include "tools/generate/random.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pagoda::tools {

// A place to build at: its own origin and right-handed axes, in world metres.
struct Frame {
    Vec3d origin{0.0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

    [[nodiscard]] Vec3d point(const Vec3d& local) const {
        return origin + local.x * x + local.y * y + local.z * z;
    }
    [[nodiscard]] Vec3d direction(const Vec3d& local) const {
        return local.x * x + local.y * y + local.z * z;
    }
    [[nodiscard]] Frame moved(const Vec3d& local) const { return {point(local), x, y, z}; }
    // About its own z; quarter turns are exact.
    [[nodiscard]] Frame turned(double radians) const;
    [[nodiscard]] Frame quarterTurned(int quarters) const;
    // Its z along `axis` (local, any length), at the local point.
    [[nodiscard]] Frame aligned(const Vec3d& at, const Vec3d& axis) const;
};

struct Rectangle {
    double u0, v0, u1, v1;
};

struct ProfilePoint {
    double radius, height;
};

// Faces of a box to leave out because nothing can see them.
enum BoxFaces : unsigned { kNoBottom = 1, kNoTop = 2 };

class SceneKit {
public:
    // `sink` null: count only. `detail` 1 is the look the scene was designed for; below it,
    // optional parts go and round shapes get fewer sides, above it round shapes get more.
    SceneKit(ooc::TriangleSink* sink, double detail) : sink_(sink), detail_(detail) {}

    [[nodiscard]] double detail() const noexcept { return detail_; }
    [[nodiscard]] uint64_t triangleCount() const noexcept { return triangles_; }
    [[nodiscard]] uint32_t objectCount() const noexcept { return objects_; }

    // `rgb` as 0xRRGGBB, sRGB. Opacity below 1 makes it translucent.
    uint32_t addMaterial(std::string_view name, uint32_t rgb, double opacity = 1.0);
    // Objects: what follows belongs to the last one begun, within the innermost open group.
    void beginGroup(const std::string& name);
    void endGroup();
    void beginObject(const std::string& name);
    void paint(uint32_t material);
    // Must end the scene: the last batches are still here.
    void flush();

    // True for a share of the asks that shrinks with detail below 1/4: wrap optional parts in it.
    // The answer depends on `random` alone, which advances by one either way.
    [[nodiscard]] bool keeps(Random& random) const { return random.unit() < 4 * detail_; }
    // Sides of a circle of that radius.
    [[nodiscard]] int sides(double radius) const;

    // All shapes take local coordinates of `at`.
    void box(const Frame& at, const Vec3d& low, const Vec3d& high, unsigned omit = 0);
    // A plate of the size u by v by w (local x, y, z from 0) with rectangular holes through w; the
    // holes lie within the plate and do not overlap. Closed, and no face twice.
    void plate(const Frame& at, double u, double v, double w,
               std::span<const Rectangle> holes = {});
    // A closed outline (counter-clockwise seen from +z, simple) between two heights.
    void prism(const Frame& at, std::span<const glm::dvec2> outline, double z0, double z1);
    // A round bar from a to b with flat ends.
    void rod(const Frame& at, const Vec3d& a, const Vec3d& b, double radius);
    // A pipe through the points, its corners rounded with radius `bend`; open ends if not `capped`.
    void tube(const Frame& at, std::span<const Vec3d> path, double radius, double bend,
              bool capped = true);
    // A ring about local z.
    void ring(const Frame& at, double radius, double thickness);
    // A profile turned about local z, drawn with the outside on its right; shallow angles are
    // shaded smooth.
    void lathe(const Frame& at, std::span<const ProfilePoint> profile);
    void ball(const Frame& at, double radius);
    // A lumpy ball (leaves, stones).
    void blob(const Frame& at, const Vec3d& radii, double roughness, uint64_t seed);
    // A wavy sheet over [0,u] x [0,v] at height(x, y), `steps` quads along the longer side at
    // detail 1. One-sided.
    template <typename Height>
    void sheet(const Frame& at, double u, double v, int steps, Height&& height);

    void quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);  // world
    void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);              // world

private:
    struct Ring {
        Vec3d centre, u, v;  // world; u, v span its plane, unit length
    };

    void smoothQuad(const Vec3d (&corners)[4], const Vec3d (&normals)[4]);
    void smoothTriangle(const Vec3d (&corners)[3], const Vec3d (&normals)[3]);
    void sweep(std::span<const Ring> rings, double radius, bool capped, bool closed);
    void disc(const Ring& ring, double radius, bool isTurned);
    void flushBatch(ooc::TriangleBatch& batch);

    ooc::TriangleSink* sink_;
    double detail_;
    uint64_t triangles_ = 0;
    uint32_t objects_ = 0, materials_ = 0;
    uint32_t object_ = 0, material_ = 0;
    std::vector<uint32_t> groups_;
    ooc::TriangleBatch flat_, smooth_;
    int circleSides_ = 0;             // of the table below
    std::vector<glm::dvec2> circle_;  // cosines and sines

    void prepareCircle(int sides);
};

template <typename Height>
void SceneKit::sheet(const Frame& at, double u, double v, int steps, Height&& height) {
    const double spacing = glm::max(u, v) / glm::max(2.0, steps * glm::sqrt(detail_));
    const int nu = glm::max(1, static_cast<int>(std::lround(u / spacing)));
    const int nv = glm::max(1, static_cast<int>(std::lround(v / spacing)));
    if (sink_ == nullptr) {
        triangles_ += 2 * static_cast<uint64_t>(nu) * static_cast<uint64_t>(nv);
        return;
    }
    const auto corner = [&](int i, int j) {
        const double x = u * i / nu, y = v * j / nv;
        return at.point({x, y, height(x, y)});
    };
    for (int j = 0; j < nv; ++j) {
        for (int i = 0; i < nu; ++i) {
            quad(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
        }
    }
}

}  // namespace pagoda::tools
