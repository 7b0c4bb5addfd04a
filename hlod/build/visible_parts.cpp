#include "hlod/build/visible_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pagoda::hlod {
namespace {

// A parallel projection with a depth buffer of triangle numbers.
class ParallelView {
public:
    ParallelView(const Vec3f& direction, float halfExtent, int resolution)
        : resolution_(resolution),
          scale_(static_cast<float>(resolution) / (2 * halfExtent)),
          depths_(static_cast<size_t>(resolution) * static_cast<size_t>(resolution),
                  std::numeric_limits<float>::infinity()),
          numbers_(depths_.size(), UINT32_MAX) {
        forward_ = glm::normalize(direction);
        const Vec3f other = std::abs(forward_.z) < 0.9f ? Vec3f(0, 0, 1) : Vec3f(1, 0, 0);
        right_ = glm::normalize(glm::cross(forward_, other));
        up_ = glm::cross(right_, forward_);
    }

    void draw(uint32_t number, const std::array<Vec3f, 3>& corners) {
        std::array<Vec3f, 3> p;
        const float centre = static_cast<float>(resolution_) / 2;
        for (size_t i = 0; i < 3; ++i) {
            p[i] = {glm::dot(corners[i], right_) * scale_ + centre,
                    glm::dot(corners[i], up_) * scale_ + centre, glm::dot(corners[i], forward_)};
        }
        const float area =
            (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
        if (std::abs(area) < 1e-6f) return;
        const int left = first(std::min({p[0].x, p[1].x, p[2].x})),
                  right = last(std::max({p[0].x, p[1].x, p[2].x}));
        const int top = first(std::min({p[0].y, p[1].y, p[2].y})),
                  bottom = last(std::max({p[0].y, p[1].y, p[2].y}));
        for (int y = top; y <= bottom; ++y) {
            for (int x = left; x <= right; ++x) {
                const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
                const float w1 =
                    ((px - p[0].x) * (p[2].y - p[0].y) - (py - p[0].y) * (p[2].x - p[0].x)) / area;
                const float w2 =
                    ((p[1].x - p[0].x) * (py - p[0].y) - (p[1].y - p[0].y) * (px - p[0].x)) / area;
                if (w1 < 0 || w2 < 0 || w1 + w2 > 1) continue;
                const float depth = p[0].z + w1 * (p[1].z - p[0].z) + w2 * (p[2].z - p[0].z);
                const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(resolution_) +
                                     static_cast<size_t>(x);
                if (depth < depths_[pixel]) {
                    depths_[pixel] = depth;
                    numbers_[pixel] = number;
                }
            }
        }
    }

    void count(std::vector<uint32_t>& pixels) const {
        for (const uint32_t number : numbers_) {
            if (number != UINT32_MAX) ++pixels[number];
        }
    }

private:
    [[nodiscard]] int first(float low) const {
        return std::max(0, static_cast<int>(std::ceil(low - 0.5f)));
    }
    [[nodiscard]] int last(float high) const {
        return std::min(resolution_ - 1, static_cast<int>(std::floor(high - 0.5f)));
    }

    int resolution_;
    float scale_;
    Vec3f forward_, right_, up_;
    std::vector<float> depths_;
    std::vector<uint32_t> numbers_;
};

}  // namespace

std::vector<uint32_t> countVisiblePixels(std::span<const SoupTriangle> triangles, int resolution) {
    std::vector<uint32_t> pixels(triangles.size(), 0);
    Box3i box;
    for (const SoupTriangle& triangle : triangles) {
        for (const Vec3i& corner : triangle.corners) box.extend(corner);
    }
    const Vec3d centre = (Vec3d(box.min) + Vec3d(box.max)) * 0.5;
    const auto halfExtent =
        static_cast<float>(0.5 * glm::length(Vec3d(box.max) - Vec3d(box.min)) + 1);
    for (int code = 0; code < 27; ++code) {
        const Vec3f direction(static_cast<float>(code % 3 - 1),
                              static_cast<float>(code / 3 % 3 - 1),
                              static_cast<float>(code / 9 - 1));
        if (code == 13) continue;  // no direction
        ParallelView view(direction, halfExtent, resolution);
        for (uint32_t i = 0; i < triangles.size(); ++i) {
            const auto& c = triangles[i].corners;
            view.draw(i, {Vec3f(Vec3d(c[0]) - centre), Vec3f(Vec3d(c[1]) - centre),
                          Vec3f(Vec3d(c[2]) - centre)});
        }
        view.count(pixels);
    }
    return pixels;
}

}  // namespace pagoda::hlod
