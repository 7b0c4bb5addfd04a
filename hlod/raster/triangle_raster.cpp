#include "hlod/raster/triangle_raster.h"

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

// Projected corners are rounded, edges are not: no pixel centre may fall between the two.
constexpr double kSlackPx = 1e-6;

// Of two triangles on both sides of an edge, one has this edge's normal and the other its negative.
bool ownsItsPoints(const Vec3d& normal) {
    if (normal.x != 0.0) return normal.x > 0.0;
    return normal.y != 0.0 ? normal.y > 0.0 : normal.z > 0.0;
}

struct Edge {
    Vec3d normal;
    bool isOwner;
    Edge(const Vec3d& from, const Vec3d& to, double side)
        : normal(side * glm::cross(from, to)), isOwner(ownsItsPoints(normal)) {}
    [[nodiscard]] bool holds(double x, double y) const {
        const double distance = normal.x * x + (normal.y * y + normal.z);
        return distance > 0.0 || (distance == 0.0 && isOwner);
    }
};

}  // namespace

uint64_t SoftwarePicture::coveredPixels() const {
    return pixelCount() -
           static_cast<uint64_t>(std::count(nodeOrdinals.begin(), nodeOrdinals.end(), 0u));
}

void TriangleRaster::begin(const View& view) {
    const int width = view.camera().widthPx, height = view.camera().heightPx;
    const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
    picture_.widthPx = width;
    picture_.heightPx = height;
    picture_.depths.assign(pixels, 0.0f);
    picture_.nodeOrdinals.assign(pixels, 0);
    picture_.triangles.assign(pixels, 0);
    picture_.nodes.clear();
    near_ = view.nearModelUnits();
    const auto place = [&](const Vec3d& fromEye) {
        const double w = glm::dot(view.forward(), fromEye);
        return Vec3d(0.5 * width * (glm::dot(view.right(), fromEye) / view.tanX() + w),
                     0.5 * height * (glm::dot(view.up(), fromEye) / view.tanY() + w), w);
    };
    const double step = lattice_.step();
    columns_[0] = place({step, 0, 0});
    columns_[1] = place({0, step, 0});
    columns_[2] = place({0, 0, step});
    offset_ = place(lattice_.origin - view.eye());
}

void TriangleRaster::draw(const SoftwareMesh& mesh, ooc::NodeId node) {
    picture_.nodes.push_back(node);
    corners_.clear();
    for (const Vec3i& point : mesh.positions) {
        const Vec3d p(point);
        Corner corner{columns_[0] * p.x + columns_[1] * p.y + columns_[2] * p.z + offset_, 0, 0,
                      false};
        corner.isInFront = !(corner.place.z >= near_);
        if (!corner.isInFront) {
            corner.x = corner.place.x / corner.place.z;
            corner.y = corner.place.y / corner.place.z;
        }
        corners_.push_back(corner);
    }
    Span span;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const Corner &a = corners_[mesh.indices[i]], &b = corners_[mesh.indices[i + 1]],
                     &c = corners_[mesh.indices[i + 2]];
        if (findSpan(a, b, c, span)) fill(a, b, c, span, static_cast<uint32_t>(i / 3));
    }
}

bool TriangleRaster::findSpan(const Corner& a, const Corner& b, const Corner& c, Span& span) const {
    const int width = picture_.widthPx, height = picture_.heightPx;
    if (a.isInFront && b.isInFront && c.isInFront) return false;
    if (a.isInFront || b.isInFront || c.isInFront) {
        span = {0, 0, width - 1, height - 1};
        return true;
    }
    const auto first = [](double least, int size) {
        return static_cast<int>(std::clamp(std::ceil(least - 0.5 - kSlackPx), 0.0, 1.0 * size));
    };
    const auto last = [](double most, int size) {
        return static_cast<int>(std::clamp(std::floor(most - 0.5 + kSlackPx), -1.0, size - 1.0));
    };
    span = {first(std::min({a.x, b.x, c.x}), width), first(std::min({a.y, b.y, c.y}), height),
            last(std::max({a.x, b.x, c.x}), width), last(std::max({a.y, b.y, c.y}), height)};
    return span.x0 <= span.x1 && span.y0 <= span.y1;
}

void TriangleRaster::fill(const Corner& a, const Corner& b, const Corner& c, const Span& span,
                          uint32_t triangle) {
    const Vec3d normal = glm::cross(b.place - a.place, c.place - a.place);
    const double distance = glm::dot(normal, a.place);
    if (!(distance != 0.0)) return;  // edge-on
    const double side = distance > 0.0 ? 1.0 : -1.0;
    const Edge edges[3] = {
        {b.place, c.place, side}, {c.place, a.place, side}, {a.place, b.place, side}};
    const Vec3d plane = normal * (near_ / distance);
    // Nearly edge-on, the plane may say anything: what it says stays between the corners.
    const double farthest = near_ / std::max({a.place.z, b.place.z, c.place.z});
    const double nearest = a.isInFront || b.isInFront || c.isInFront
                               ? 2.0
                               : near_ / std::min({a.place.z, b.place.z, c.place.z});
    for (int row = span.y0; row <= span.y1; ++row) {
        const double y = row + 0.5;
        for (int column = span.x0; column <= span.x1; ++column) {
            const double x = column + 0.5;
            if (!edges[0].holds(x, y) || !edges[1].holds(x, y) || !edges[2].holds(x, y)) continue;
            const double depth =
                std::clamp(plane.x * x + (plane.y * y + plane.z), farthest, nearest);
            const size_t pixel = static_cast<size_t>(row) * static_cast<size_t>(picture_.widthPx) +
                                 static_cast<size_t>(column);
            const auto stored = static_cast<float>(depth);
            if (depth > 1.0 || !(stored > picture_.depths[pixel])) continue;
            picture_.depths[pixel] = stored;
            picture_.nodeOrdinals[pixel] = static_cast<uint32_t>(picture_.nodes.size());
            picture_.triangles[pixel] = triangle;
        }
    }
}

}  // namespace pagoda::hlod
