#include "hlod/build/simplify.h"
#include "hlod/build/vertex_table.h"

#include <algorithm>
#include <cmath>

namespace pagoda::hlod {
namespace {

// One cell of the clustering grid; opaque and translucent surfaces never share one.
struct ClusterKey {
    Vec3i cell;
    bool isTranslucent = false;

    [[nodiscard]] bool operator==(const ClusterKey&) const = default;
    [[nodiscard]] uint64_t hash() const {
        uint64_t h = mixHash(0x9E3779B1, static_cast<uint32_t>(cell.x) |
                                             (uint64_t{static_cast<uint32_t>(cell.y)} << 32));
        return mixHash(h, static_cast<uint32_t>(cell.z) | (uint64_t{isTranslucent} << 32));
    }
};

struct TripleKey {
    std::array<uint32_t, 3> clusters;  // ascending: both windings are one surface, drawn two-sided

    [[nodiscard]] bool operator==(const TripleKey&) const = default;
    [[nodiscard]] uint64_t hash() const {
        return mixHash(mixHash(0xB5297A4D, clusters[0] | (uint64_t{clusters[1]} << 32)), clusters[2]);
    }
};

// Area-weighted sums over the triangles that touch a cluster, about the cell's centre.
struct Cluster {
    glm::dmat3 planes{0.0};  // sum of w n n^T
    Vec3d target{0.0};       // sum of w n (n . p)
    Vec3d mean{0.0};         // sum of w p
    double weight = 0;
    glm::dvec4 colour{0.0};  // sum of w RGBA
};

int32_t floorDiv(int32_t value, int32_t divisor) {
    return value >= 0 ? value / divisor : -((-value + divisor - 1) / divisor);
}

class Clustering {
public:
    Clustering(const SimplifyRequest& request, int32_t cellSteps) : request_(request), cellSteps_(cellSteps) {
        const size_t count = request.triangles.size();
        clusters_.reset(count * 3);
        triples_.reset(count);
        cornerCluster_.reserve(count * 3);
        for (const SoupTriangle& triangle : request.triangles) {
            const bool isTranslucent = (*request.isTranslucent)[triangle.material];
            std::array<uint32_t, 3> triple;
            for (size_t corner = 0; corner < 3; ++corner) {
                const Vec3i& p = triangle.corners[corner];
                triple[corner] = clusters_.add({{floorDiv(p.x, cellSteps), floorDiv(p.y, cellSteps),
                                                 floorDiv(p.z, cellSteps)},
                                                isTranslucent});
                cornerCluster_.push_back(triple[corner]);
            }
            std::sort(triple.begin(), triple.end());
            if (triple[0] != triple[1] && triple[1] != triple[2]) (void)triples_.add({triple});
        }
    }

    [[nodiscard]] size_t triangleCount() const { return triples_.keys().size(); }
    [[nodiscard]] std::vector<SoupTriangle> triangles() const;

private:
    [[nodiscard]] std::vector<Cluster> sums() const;
    [[nodiscard]] Vec3i representative(const Cluster& cluster, const ClusterKey& key) const;

    const SimplifyRequest& request_;
    int32_t cellSteps_;
    VertexTable<ClusterKey> clusters_;
    VertexTable<TripleKey> triples_;
    std::vector<uint32_t> cornerCluster_;
};

std::vector<Cluster> Clustering::sums() const {
    std::vector<Cluster> sums(clusters_.keys().size());
    for (size_t i = 0; i < request_.triangles.size(); ++i) {
        const SoupTriangle& triangle = request_.triangles[i];
        const Vec3d a(triangle.corners[0]), b(triangle.corners[1]), c(triangle.corners[2]);
        const Vec3d cross = glm::cross(b - a, c - a);
        const double area = glm::length(cross);
        if (area == 0) continue;
        const Vec3d normal = cross / area;
        for (size_t corner = 0; corner < 3; ++corner) {
            const uint32_t number = cornerCluster_[3 * i + corner];
            Cluster& cluster = sums[number];
            const Vec3d centre =
                (Vec3d(clusters_.keys()[number].cell) + 0.5) * static_cast<double>(cellSteps_);
            const Vec3d p = Vec3d(triangle.corners[corner]) - centre;
            cluster.planes += area * glm::outerProduct(normal, normal);
            cluster.target += area * normal * glm::dot(normal, p);
            cluster.mean += area * p;
            cluster.weight += area;
            const uint32_t rgba = triangle.colours[corner];
            cluster.colour += area * glm::dvec4(rgba & 255u, (rgba >> 8) & 255u, (rgba >> 16) & 255u, rgba >> 24);
        }
    }
    return sums;
}

// Minimises the planes' quadric with a weak pull to the mean (flat and straight spots have no unique
// minimum), kept inside the cell.
Vec3i Clustering::representative(const Cluster& cluster, const ClusterKey& key) const {
    constexpr double kPull = 1e-2;  // of the trace: below 1e-3 needles throw points to the cell's corners
    const Vec3d mean = cluster.mean / cluster.weight;
    const double pull = kPull * (cluster.planes[0][0] + cluster.planes[1][1] + cluster.planes[2][2]);
    const glm::dmat3 matrix = cluster.planes + glm::dmat3(pull);
    Vec3d best = glm::inverse(matrix) * (cluster.target + pull * mean);
    if (!std::isfinite(best.x + best.y + best.z)) best = mean;
    const double half = 0.5 * static_cast<double>(cellSteps_);
    best = glm::clamp(best, Vec3d(-half), Vec3d(half));
    const Vec3d centre = (Vec3d(key.cell) + 0.5) * static_cast<double>(cellSteps_);
    const double last = std::ldexp(1.0, request_.cell.extentBits);
    return Vec3i(glm::clamp(glm::floor(centre + best + 0.5), Vec3d(0.0), Vec3d(last)));
}

uint32_t meanColour(const Cluster& cluster) {
    uint32_t rgba = 0;
    for (int channel = 0; channel < 4; ++channel) {
        const double value = cluster.colour[channel] / cluster.weight;
        rgba |= static_cast<uint32_t>(std::clamp(value + 0.5, 0.0, 255.0)) << (8 * channel);
    }
    return rgba;
}

std::vector<SoupTriangle> Clustering::triangles() const {
    const std::vector<Cluster> clusters = sums();
    std::vector<SoupTriangle> result;
    VertexTable<TripleKey> seen;
    seen.reset(triangleCount());
    for (size_t i = 0; i < request_.triangles.size(); ++i) {
        const std::array<uint32_t, 3> triple = {cornerCluster_[3 * i], cornerCluster_[3 * i + 1],
                                                cornerCluster_[3 * i + 2]};
        std::array<uint32_t, 3> sorted = triple;
        std::sort(sorted.begin(), sorted.end());
        if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) continue;
        const size_t before = seen.keys().size();
        if (seen.add({sorted}) < before) continue;
        SoupTriangle triangle;
        triangle.object = request_.triangles[i].object;
        triangle.material = request_.triangles[i].material;
        bool isWhole = true;
        for (size_t corner = 0; corner < 3; ++corner) {
            const Cluster& cluster = clusters[triple[corner]];
            isWhole &= cluster.weight > 0;
            if (!isWhole) break;
            triangle.corners[corner] = representative(cluster, clusters_.keys()[triple[corner]]);
            triangle.colours[corner] = meanColour(cluster);
        }
        if (isWhole && !hasNoArea(triangle.corners)) result.push_back(triangle);
    }
    return result;
}

}  // namespace

SimplifyResult clusterTriangles(const SimplifyRequest& request) {
    // The finest grid that keeps the budget; counts are nearly monotone in the cell size, so bisect.
    Vec3i min(INT32_MAX), max(INT32_MIN);
    for (const SoupTriangle& triangle : request.triangles) {
        for (const Vec3i& corner : triangle.corners) {
            min = glm::min(min, corner);
            max = glm::max(max, corner);
        }
    }
    const Vec3i size = max - min;
    int32_t tooFine = 1, fits = std::max({size.x, size.y, size.z, 2});
    while (fits - tooFine > std::max(1, fits / 64)) {  // within 2% of the best cell size
        const int32_t middle = tooFine + (fits - tooFine) / 2;
        (Clustering(request, middle).triangleCount() <= request.budgetTriangles ? fits : tooFine) = middle;
    }
    SimplifyResult result;
    result.triangles = Clustering(request, fits).triangles();
    result.isSloppy = true;
    if (result.triangles.empty()) {
        // Nothing spans three cells at any size that keeps the budget: the largest triangles stand in.
        std::vector<uint32_t> order(request.triangles.size());
        for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
        const auto area = [&](uint32_t i) {
            const auto& c = request.triangles[i].corners;
            return glm::length(glm::cross(Vec3d(c[1] - c[0]), Vec3d(c[2] - c[0])));
        };
        std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
            const double areaA = area(a), areaB = area(b);
            return areaA != areaB ? areaA > areaB : a < b;
        });
        order.resize(std::min<size_t>(order.size(), request.budgetTriangles));
        std::sort(order.begin(), order.end());
        for (const uint32_t i : order) result.triangles.push_back(request.triangles[i]);
    }
    return result;
}

}  // namespace pagoda::hlod
