#include "hlod/build/visible_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pagoda::hlod {
namespace {

// A parallel projection seen from both ends: the nearest and the farthest triangle of every pixel.
class ParallelView {
public:
    ParallelView(const Vec3f& direction, float halfExtent, int resolution)
        : resolution_(resolution),
          scale_(static_cast<float>(resolution) / (2 * halfExtent)),
          near_(static_cast<size_t>(resolution) * static_cast<size_t>(resolution)),
          far_(near_) {
        forward_ = glm::normalize(direction);
        const Vec3f other = std::abs(forward_.z) < 0.9f ? Vec3f(0, 0, 1) : Vec3f(1, 0, 0);
        right_ = glm::normalize(glm::cross(forward_, other));
        up_ = glm::cross(right_, forward_);
        for (Pixel& pixel : far_) pixel.depth = -pixel.depth;
    }

    void draw(uint32_t number, const std::array<Vec3f, 3>& corners) {
        std::array<Vec3f, 3> p;
        const float centre = static_cast<float>(resolution_) / 2;
        for (size_t i = 0; i < 3; ++i) {
            p[i] = {glm::dot(corners[i], right_) * scale_ + centre,
                    glm::dot(corners[i], up_) * scale_ + centre, glm::dot(corners[i], forward_)};
        }
        const int top = first(std::min({p[0].y, p[1].y, p[2].y}));
        const int bottom = last(std::max({p[0].y, p[1].y, p[2].y}));
        const int left = first(std::min({p[0].x, p[1].x, p[2].x}));
        const int right = last(std::max({p[0].x, p[1].x, p[2].x}));
        const Vec3f u = p[1] - p[0], v = p[2] - p[0];
        const float area = u.x * v.y - u.y * v.x;
        if (top > bottom || left > right || std::abs(area) < 1e-6f) return;
        const float perArea = 1 / area;
        for (int y = top; y <= bottom; ++y) {
            const float py = static_cast<float>(y) + 0.5f - p[0].y;
            for (int x = left; x <= right; ++x) {
                const float px = static_cast<float>(x) + 0.5f - p[0].x;
                const float w1 = (px * v.y - py * v.x) * perArea,
                            w2 = (u.x * py - u.y * px) * perArea;
                if (w1 < 0 || w2 < 0 || w1 + w2 > 1) continue;
                put(x, y, number, p[0].z + w1 * u.z + w2 * v.z);
            }
        }
    }

    void count(std::vector<uint32_t>& pixels) const {
        for (const std::vector<Pixel>* side : {&near_, &far_}) {
            for (const Pixel& pixel : *side) {
                if (pixel.number != UINT32_MAX) ++pixels[pixel.number];
            }
        }
    }

private:
    struct Pixel {
        float depth = std::numeric_limits<float>::infinity();
        uint32_t number = UINT32_MAX;
    };

    void put(int x, int y, uint32_t number, float depth) {
        const size_t place =
            static_cast<size_t>(y) * static_cast<size_t>(resolution_) + static_cast<size_t>(x);
        if (depth < near_[place].depth) near_[place] = {depth, number};
        if (depth > far_[place].depth) far_[place] = {depth, number};
    }
    [[nodiscard]] int first(float low) const {
        return std::max(0, static_cast<int>(std::ceil(low - 0.5f)));
    }
    [[nodiscard]] int last(float high) const {
        return std::min(resolution_ - 1, static_cast<int>(std::floor(high - 0.5f)));
    }

    int resolution_;
    float scale_;
    Vec3f forward_, right_, up_;
    std::vector<Pixel> near_, far_;
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
    std::vector<std::array<Vec3f, 3>> local(triangles.size());
    for (size_t i = 0; i < triangles.size(); ++i) {
        for (size_t corner = 0; corner < 3; ++corner) {
            local[i][corner] = Vec3f(Vec3d(triangles[i].corners[corner]) - centre);
        }
    }
    // One of each pair of opposite directions: a view has two ends.
    for (int code = 14; code < 27; ++code) {
        const Vec3f direction(static_cast<float>(code % 3 - 1),
                              static_cast<float>(code / 3 % 3 - 1),
                              static_cast<float>(code / 9 - 1));
        ParallelView view(direction, halfExtent, resolution);
        for (uint32_t i = 0; i < local.size(); ++i) view.draw(i, local[i]);
        view.count(pixels);
    }
    return pixels;
}

}  // namespace pagoda::hlod
