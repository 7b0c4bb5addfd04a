#include "hlod/build/surface_distance.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace pagoda::hlod {
namespace {

constexpr uint32_t kLeafTriangles = 4;

float squared(const Vec3f& v) {
    return glm::dot(v, v);
}

// Ericson, Real-Time Collision Detection, section 5.1.5.
float toTriangle(const Vec3f& point, const Vec3f& a, const Vec3f& ab, const Vec3f& ac) {
    const Vec3f ap = point - a;
    const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return squared(ap);
    const Vec3f bp = ap - ab;
    const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return squared(bp);
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(ap - ab * (d1 / (d1 - d3)));
    const Vec3f cp = ap - ac;
    const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return squared(cp);
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(ap - ac * (d2 / (d2 - d6)));
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const float w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return squared(bp - (ac - ab) * w);
    }
    const float sum = va + vb + vc;
    if (!(sum > 0)) return std::min({squared(ap), squared(bp), squared(cp)});  // a needle in float
    return squared(ap - ab * (vb / sum) - ac * (vc / sum));
}

float toBox(const Vec3f& point, const Vec3f& min, const Vec3f& max) {
    return squared(glm::max(glm::max(min - point, point - max), Vec3f(0.0f)));
}

}  // namespace

SurfaceDistance::SurfaceDistance(std::span<const Vec3f> positions,
                                 std::span<const uint32_t> indices) {
    const auto count = static_cast<uint32_t>(indices.size() / 3);
    std::vector<Vec3f> centroids(count);
    for (uint32_t i = 0; i < count; ++i) {
        centroids[i] = positions[indices[3 * size_t{i}]] + positions[indices[3 * size_t{i} + 1]] +
                       positions[indices[3 * size_t{i} + 2]];
    }
    treeOrder_.resize(count);
    std::iota(treeOrder_.begin(), treeOrder_.end(), 0u);
    nodes_.reserve(count);
    nodes_.emplace_back();
    split(0, centroids, treeOrder_, 0, count, positions, indices);
    triangles_.resize(count);
    treePlace_.resize(count);
    for (uint32_t place = 0; place < count; ++place) {
        const size_t i = size_t{treeOrder_[place]} * 3;
        const Vec3f a = positions[indices[i]];
        triangles_[place] = {a, positions[indices[i + 1]] - a, positions[indices[i + 2]] - a};
        treePlace_[treeOrder_[place]] = place;
    }
}

void SurfaceDistance::split(uint32_t node, std::vector<Vec3f>& centroids,
                            std::vector<uint32_t>& order, uint32_t begin, uint32_t end,
                            std::span<const Vec3f> positions, std::span<const uint32_t> indices) {
    Vec3f min(std::numeric_limits<float>::max()), max(std::numeric_limits<float>::lowest());
    Vec3f centroidMin = min, centroidMax = max;
    for (uint32_t i = begin; i < end; ++i) {
        for (size_t corner = 0; corner < 3; ++corner) {
            const Vec3f& p = positions[indices[3 * size_t{order[i]} + corner]];
            min = glm::min(min, p);
            max = glm::max(max, p);
        }
        centroidMin = glm::min(centroidMin, centroids[order[i]]);
        centroidMax = glm::max(centroidMax, centroids[order[i]]);
    }
    nodes_[node].min = min;
    nodes_[node].max = max;
    if (end - begin <= kLeafTriangles) {
        nodes_[node].first = begin;
        nodes_[node].count = end - begin;
        return;
    }
    const Vec3f size = centroidMax - centroidMin;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(
        order.begin() + begin, order.begin() + middle, order.begin() + end,
        [&](uint32_t a, uint32_t b) { return centroids[a][axis] < centroids[b][axis]; });
    const auto left = static_cast<uint32_t>(nodes_.size());
    nodes_[node].first = left;
    nodes_.emplace_back();
    nodes_.emplace_back();
    split(left, centroids, order, begin, middle, positions, indices);
    split(left + 1, centroids, order, middle, end, positions, indices);
}

float SurfaceDistance::squaredDistance(const Vec3f& point, uint32_t& nearTriangle,
                                       float enough) const {
    const Corners& guess = triangles_[treePlace_[nearTriangle]];
    float best = toTriangle(point, guess.a, guess.ab, guess.ac);
    struct Entry {
        uint32_t node;
        float distance;
    };
    std::array<Entry, 64> stack;  // the tree halves: 32 levels at most
    size_t depth = 0;
    stack[depth++] = {0, 0.0f};
    while (depth > 0 && best > enough) {
        const Entry entry = stack[--depth];
        if (entry.distance >= best) continue;
        const Node& node = nodes_[entry.node];
        if (node.count > 0) {
            for (uint32_t i = node.first; i < node.first + node.count; ++i) {
                const float distance =
                    toTriangle(point, triangles_[i].a, triangles_[i].ab, triangles_[i].ac);
                if (distance < best) {
                    best = distance;
                    nearTriangle = treeOrder_[i];
                }
            }
            continue;
        }
        Entry near{node.first, toBox(point, nodes_[node.first].min, nodes_[node.first].max)};
        Entry far{node.first + 1,
                  toBox(point, nodes_[node.first + 1].min, nodes_[node.first + 1].max)};
        if (far.distance < near.distance) std::swap(near, far);
        if (far.distance < best) stack[depth++] = far;
        if (near.distance < best) stack[depth++] = near;
    }
    return best;
}

}  // namespace pagoda::hlod
