// shapes.cpp: the shapes of SceneKit.
#include "tools/generate/scene_kit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSmoothCosine = 0.6;  // profile corners sharper than about 53 degrees stay sharp

double cross2(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

bool isInside(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return cross2(b - a, p - a) >= 0 && cross2(c - b, p - b) >= 0 && cross2(a - c, p - c) >= 0;
}

// Ear clipping; outlines have a dozen corners.
std::vector<uint32_t> triangulate(std::span<const glm::dvec2> outline) {
    std::vector<uint32_t> left(outline.size()), result;
    for (uint32_t i = 0; i < left.size(); ++i) left[i] = i;
    while (left.size() > 2) {
        size_t ear = 0;
        for (; ear < left.size(); ++ear) {
            const uint32_t a = left[(ear + left.size() - 1) % left.size()], b = left[ear],
                           c = left[(ear + 1) % left.size()];
            if (cross2(outline[b] - outline[a], outline[c] - outline[a]) <= 0) continue;
            const bool isClear = std::none_of(left.begin(), left.end(), [&](uint32_t p) {
                return p != a && p != b && p != c &&
                       isInside(outline[p], outline[a], outline[b], outline[c]);
            });
            if (isClear) break;
        }
        if (ear == left.size()) ear = 0;  // not simple: keep the count all the same
        result.insert(result.end(), {left[(ear + left.size() - 1) % left.size()], left[ear],
                                     left[(ear + 1) % left.size()]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    return result;
}

std::vector<double> sortedUnique(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

}  // namespace

void SceneKit::box(const Frame& at, const Vec3d& low, const Vec3d& high, unsigned omit) {
    if (sink_ == nullptr) {
        triangles_ += 12u - ((omit & kNoBottom) != 0 ? 2u : 0u) - ((omit & kNoTop) != 0 ? 2u : 0u);
        return;
    }
    Vec3d corners[8];
    for (int i = 0; i < 8; ++i) {
        corners[i] = at.point({(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                               (i & 4) != 0 ? high.z : low.z});
    }
    if ((omit & kNoBottom) == 0) quad(corners[0], corners[2], corners[3], corners[1]);
    if ((omit & kNoTop) == 0) quad(corners[4], corners[5], corners[7], corners[6]);
    quad(corners[0], corners[1], corners[5], corners[4]);
    quad(corners[1], corners[3], corners[7], corners[5]);
    quad(corners[3], corners[2], corners[6], corners[7]);
    quad(corners[2], corners[0], corners[4], corners[6]);
}

// The holes' edges, prolonged, cut the plate into cells: two quads for each full cell, one for each
// side of it that faces a hole or the outside.
void SceneKit::plate(const Frame& at, double u, double v, double w,
                     std::span<const Rectangle> holes) {
    std::vector<double> us{0, u}, vs{0, v};
    for (const Rectangle& hole : holes) {
        us.insert(us.end(), {hole.u0, hole.u1});
        vs.insert(vs.end(), {hole.v0, hole.v1});
    }
    us = sortedUnique(std::move(us));
    vs = sortedUnique(std::move(vs));
    const size_t nu = us.size() - 1, nv = vs.size() - 1;
    std::vector<bool> isFull((nu + 2) * (nv + 2), false);  // with a rim of nothing
    const auto cell = [&](size_t i, size_t j) { return (j + 1) * (nu + 2) + i + 1; };
    for (size_t j = 0; j < nv; ++j) {
        for (size_t i = 0; i < nu; ++i) {
            const double x = (us[i] + us[i + 1]) / 2, y = (vs[j] + vs[j + 1]) / 2;
            isFull[cell(i, j)] = std::none_of(holes.begin(), holes.end(), [&](const Rectangle& h) {
                return h.u0 < x && x < h.u1 && h.v0 < y && y < h.v1;
            });
        }
    }
    const auto face = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
        if (sink_ == nullptr) {
            triangles_ += 2;
        } else {
            quad(at.point(a), at.point(b), at.point(c), at.point(d));
        }
    };
    for (size_t j = 0; j < nv; ++j) {
        for (size_t i = 0; i < nu; ++i) {
            if (!isFull[cell(i, j)]) continue;
            const double x0 = us[i], x1 = us[i + 1], y0 = vs[j], y1 = vs[j + 1];
            face({x0, y0, w}, {x1, y0, w}, {x1, y1, w}, {x0, y1, w});
            face({x0, y0, 0}, {x0, y1, 0}, {x1, y1, 0}, {x1, y0, 0});
            if (!isFull[cell(i, j) - 1]) face({x0, y1, 0}, {x0, y0, 0}, {x0, y0, w}, {x0, y1, w});
            if (!isFull[cell(i, j) + 1]) face({x1, y0, 0}, {x1, y1, 0}, {x1, y1, w}, {x1, y0, w});
            if (!isFull[cell(i, j) - (nu + 2)]) {
                face({x0, y0, 0}, {x1, y0, 0}, {x1, y0, w}, {x0, y0, w});
            }
            if (!isFull[cell(i, j) + (nu + 2)]) {
                face({x1, y1, 0}, {x0, y1, 0}, {x0, y1, w}, {x1, y1, w});
            }
        }
    }
}

void SceneKit::prism(const Frame& at, std::span<const glm::dvec2> outline, double z0, double z1) {
    if (sink_ == nullptr) {
        triangles_ += 2 * outline.size() + 2 * (outline.size() - 2);
        return;
    }
    const auto corner = [&](size_t i, double z) {
        return at.point({outline[i].x, outline[i].y, z});
    };
    for (size_t i = 0; i < outline.size(); ++i) {
        const size_t next = (i + 1) % outline.size();
        quad(corner(i, z0), corner(next, z0), corner(next, z1), corner(i, z1));
    }
    const std::vector<uint32_t> cap = triangulate(outline);
    for (size_t i = 0; i + 2 < cap.size(); i += 3) {
        triangle(corner(cap[i], z1), corner(cap[i + 1], z1), corner(cap[i + 2], z1));
        triangle(corner(cap[i], z0), corner(cap[i + 2], z0), corner(cap[i + 1], z0));
    }
}

void SceneKit::rod(const Frame& at, const Vec3d& a, const Vec3d& b, double radius) {
    const Frame along = at.aligned(a, b - a);
    const Ring rings[2] = {{along.origin, along.x, along.y}, {at.point(b), along.x, along.y}};
    sweep(rings, radius, true, false);
}

void SceneKit::tube(const Frame& at, std::span<const Vec3d> path, double radius, double bend,
                    bool capped) {
    struct Step {
        Vec3d centre, tangent;
    };
    std::vector<Step> steps;
    const auto towards = [&](size_t from, size_t to) {
        return glm::normalize(path[to] - path[from]);
    };
    steps.push_back({path.front(), towards(0, 1)});
    for (size_t i = 1; i + 1 < path.size(); ++i) {
        const Vec3d before = towards(i - 1, i), after = towards(i, i + 1);
        const double angle = std::acos(std::clamp(glm::dot(before, after), -1.0, 1.0));
        if (angle < 0.02) {  // hardly a corner
            steps.push_back({path[i], glm::normalize(before + after)});
            continue;
        }
        const double room = 0.45 * std::min(glm::distance(path[i - 1], path[i]),
                                            glm::distance(path[i], path[i + 1]));
        const double reach = std::min(bend * std::tan(angle / 2), room);
        const double arc = reach / std::max(1e-9, std::tan(angle / 2));  // radius after clamping
        const Vec3d side = after - glm::dot(after, before) * before;
        const Vec3d inward = glm::normalize(side);
        const Vec3d start = path[i] - reach * before;
        const int pieces = std::max(
            1, static_cast<int>(std::lround(angle / (kPi / 2) * 4.0 * std::sqrt(detail_))));
        for (int piece = 0; piece <= pieces; ++piece) {
            const double turn = angle * piece / pieces;
            steps.push_back(
                {start + arc * std::sin(turn) * before + arc * (1 - std::cos(turn)) * inward,
                 std::cos(turn) * before + std::sin(turn) * inward});
        }
    }
    steps.push_back({path.back(), towards(path.size() - 2, path.size() - 1)});

    std::vector<Ring> rings(steps.size());
    Vec3d before = at.direction(steps[0].tangent);
    Vec3d u = at.aligned(steps[0].centre, steps[0].tangent).x;
    for (size_t i = 0; i < steps.size(); ++i) {
        // The least turn that takes one tangent to the next, so that the pipe does not twist.
        const Vec3d tangent = at.direction(steps[i].tangent);
        u -= glm::dot(u, tangent) / (1 + glm::dot(before, tangent)) * (before + tangent);
        u = glm::normalize(u - glm::dot(u, tangent) * tangent);
        before = tangent;
        rings[i] = {at.point(steps[i].centre), u, glm::cross(tangent, u)};
    }
    sweep(rings, radius, capped, false);
}

void SceneKit::ring(const Frame& at, double radius, double thickness) {
    const int count = std::max(8, sides(radius) * 3 / 2);
    std::vector<Ring> rings(static_cast<size_t>(count));
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * kPi * i / count;
        const Vec3d out = std::cos(angle) * at.x + std::sin(angle) * at.y;
        // Tangent x out = -z: the tube's own axes, right-handed along its way.
        rings[static_cast<size_t>(i)] = {at.origin + radius * out, out, at.z * -1.0};
    }
    sweep(rings, thickness, false, true);
}

void SceneKit::lathe(const Frame& at, std::span<const ProfilePoint> profile) {
    double largest = 0;
    for (const ProfilePoint& point : profile) largest = std::max(largest, point.radius);
    const int count = sides(largest);
    const size_t spans = profile.size() - 1;
    if (sink_ == nullptr) {
        for (size_t s = 0; s < spans; ++s) {
            const bool isTip = profile[s].radius == 0 || profile[s + 1].radius == 0;
            triangles_ += static_cast<uint64_t>(count) * (isTip ? 1 : 2);
        }
        return;
    }
    prepareCircle(count);
    const auto normalOf = [&](size_t s) {
        return glm::normalize(glm::dvec2(profile[s + 1].height - profile[s].height,
                                         profile[s].radius - profile[s + 1].radius));
    };
    const auto blend = [&](size_t s, size_t other) {
        const glm::dvec2 own = normalOf(s), beside = normalOf(other);
        return glm::dot(own, beside) < kSmoothCosine ? own : glm::normalize(own + beside);
    };
    const auto turn = [&](const glm::dvec2& p, size_t i) {
        return p.x * (circle_[i].x * at.x + circle_[i].y * at.y) + p.y * at.z;
    };
    for (size_t s = 0; s < spans; ++s) {
        const glm::dvec2 low = s > 0 ? blend(s, s - 1) : normalOf(s);
        const glm::dvec2 high = s + 1 < spans ? blend(s, s + 1) : normalOf(s);
        const glm::dvec2 from{profile[s].radius, profile[s].height};
        const glm::dvec2 to{profile[s + 1].radius, profile[s + 1].height};
        for (size_t i = 0; i < static_cast<size_t>(count); ++i) {
            const Vec3d a = at.origin + turn(from, i), b = at.origin + turn(from, i + 1);
            const Vec3d c = at.origin + turn(to, i + 1), d = at.origin + turn(to, i);
            const Vec3d na = turn(low, i), nb = turn(low, i + 1), nc = turn(high, i + 1),
                        nd = turn(high, i);
            if (from.x == 0) {
                smoothTriangle({a, c, d}, {na, nc, nd});
            } else if (to.x == 0) {
                smoothTriangle({a, b, c}, {na, nb, nc});
            } else {
                smoothQuad({a, b, c, d}, {na, nb, nc, nd});
            }
        }
    }
}

void SceneKit::ball(const Frame& at, double radius) {
    const int rows = std::max(3, sides(radius) / 2);
    std::vector<ProfilePoint> profile(static_cast<size_t>(rows) + 1);
    for (int i = 0; i <= rows; ++i) {
        const double angle = kPi * i / rows;
        const bool isTip = i == 0 || i == rows;
        profile[static_cast<size_t>(i)] = {isTip ? 0 : radius * std::sin(angle),
                                           -radius * std::cos(angle)};
    }
    lathe(at, profile);
}

void SceneKit::blob(const Frame& at, const Vec3d& radii, double roughness, uint64_t seed) {
    const int columns = std::max(6, sides(std::max({radii.x, radii.y, radii.z})));
    const int rows = columns / 2;
    if (sink_ == nullptr) {
        triangles_ += 2 * static_cast<uint64_t>(columns) * static_cast<uint64_t>(rows - 1);
        return;
    }
    const auto corner = [&](int row, int column) {
        const double polar = kPi * row / rows, angle = 2 * kPi * (column % columns) / columns;
        const double rim = row == 0 || row == rows ? 0.0 : std::sin(polar);
        const Vec3d out(rim * std::cos(angle), rim * std::sin(angle), -std::cos(polar));
        const double lumps = 1 + roughness * fractalNoise(out * 2.5, 3, seed);
        return at.point(radii * out * lumps);
    };
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const Vec3d a = corner(row, column), b = corner(row, column + 1);
            const Vec3d c = corner(row + 1, column + 1), d = corner(row + 1, column);
            if (row > 0) triangle(a, b, c);
            if (row + 1 < rows) triangle(a, c, d);
        }
    }
}

}  // namespace pagoda::tools
