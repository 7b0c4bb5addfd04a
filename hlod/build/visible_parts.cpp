#include "hlod/build/visible_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pagoda::hlod {
namespace {

// Directions as three digits of -1, 0, 1; one of each opposite pair comes after (0, 0, 0), code 13.
constexpr int kFirstCode = 14;

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
        if (top > bottom || left > right) return;
        const std::array<Edge, 3> edges = {Edge(p[1], p[2]), Edge(p[2], p[0]), Edge(p[0], p[1])};
        for (int y = top; y <= bottom; ++y) {
            for (int x = left; x <= right; ++x) {
                const Vec3d w(edges[0].side(x + 0.5, y + 0.5), edges[1].side(x + 0.5, y + 0.5),
                              edges[2].side(x + 0.5, y + 0.5));
                const bool isInside =
                    (w.x >= 0 && w.y >= 0 && w.z >= 0) || (w.x <= 0 && w.y <= 0 && w.z <= 0);
                const double area = w.x + w.y + w.z;
                if (!isInside || std::abs(area) < 1e-6) continue;  // below: seen edge-on
                put(x, y, number,
                    static_cast<float>((w.x * p[0].z + w.y * p[1].z + w.z * p[2].z) / area));
            }
        }
    }

    [[nodiscard]] SeenNumbers numbers() const {
        SeenNumbers numbers;
        for (const Pixel& pixel : near_) numbers[0].push_back(pixel.number);
        for (const Pixel& pixel : far_) numbers[1].push_back(pixel.number);
        return numbers;
    }

private:
    // Twice the area to a point, positive on the left. From the lower end whichever way the edge is
    // named: triangles that share it round alike, and no pixel falls between them.
    class Edge {
    public:
        Edge(const Vec3f& a, const Vec3f& b)
            : isTurned_(b.x < a.x || (b.x == a.x && b.y < a.y)),
              from_(isTurned_ ? b : a),
              along_(Vec3d(isTurned_ ? a : b) - from_) {}

        [[nodiscard]] double side(double x, double y) const {
            const double area = along_.x * (y - from_.y) - along_.y * (x - from_.x);
            return isTurned_ ? -area : area;
        }

    private:
        bool isTurned_;
        Vec3d from_, along_;
    };

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

SeenNumbers seenAlong(int line, std::span<const SoupTriangle> triangles, const Box3i& box,
                      int resolution) {
    const Vec3d centre = (Vec3d(box.min) + Vec3d(box.max)) * 0.5;
    const auto halfExtent =
        static_cast<float>(0.5 * glm::length(Vec3d(box.max) - Vec3d(box.min)) + 1);
    const int code = kFirstCode + line;
    ParallelView view(Vec3f(Vec3i(code % 3, code / 3 % 3, code / 9) - 1), halfExtent, resolution);
    for (uint32_t i = 0; i < triangles.size(); ++i) {
        std::array<Vec3f, 3> local;
        for (size_t corner = 0; corner < 3; ++corner) {
            local[corner] = Vec3f(Vec3d(triangles[i].corners[corner]) - centre);
        }
        view.draw(i, local);
    }
    return view.numbers();
}

std::vector<uint32_t> countVisiblePixels(std::span<const SoupTriangle> triangles, int resolution) {
    std::vector<uint32_t> pixels(triangles.size(), 0);
    Box3i box;
    for (const SoupTriangle& triangle : triangles) {
        for (const Vec3i& corner : triangle.corners) box.extend(corner);
    }
    for (int line = 0; line < kViewLines; ++line) {
        for (const std::vector<uint32_t>& end : seenAlong(line, triangles, box, resolution)) {
            for (const uint32_t number : end) {
                if (number != UINT32_MAX) ++pixels[number];
            }
        }
    }
    return pixels;
}

}  // namespace pagoda::hlod
