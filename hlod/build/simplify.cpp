#include "hlod/build/simplify.h"

#include "hlod/build/cluster.h"
#include "hlod/build/visible_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pagoda::hlod {
namespace {

// A proxy may be this many times finer than a node: cracks and colours of clustered children are
// then below a cell of the parent's grid.
constexpr uint32_t kProxyFactor = 8;

// Deeper cells are cut open on all sides: little of them is hidden, and there are many.
constexpr int kVisibilityDepth = 4;

// Pixels along the mesh for the visibility count: triangles should not fall between them, cost
// grows with the square.
int visibilityResolution(size_t triangleCount) {
    return std::clamp(static_cast<int>(3.0 * std::sqrt(static_cast<double>(triangleCount))), 64,
                      512);
}

std::vector<SoupTriangle> visibleOf(std::span<const SoupTriangle> triangles) {
    const std::vector<uint32_t> pixels =
        countVisiblePixels(triangles, visibilityResolution(triangles.size()));
    std::vector<SoupTriangle> visible;
    for (size_t i = 0; i < triangles.size(); ++i) {
        if (pixels[i] > 0) visible.push_back(triangles[i]);
    }
    return visible;
}

double doubleArea(const SoupTriangle& triangle) {
    const auto& c = triangle.corners;
    return glm::length(glm::cross(Vec3d(c[1] - c[0]), Vec3d(c[2] - c[0])));
}

// The largest triangles, in their order.
std::vector<SoupTriangle> largest(std::span<const SoupTriangle> triangles, uint32_t count) {
    std::vector<uint32_t> order(triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const double areaA = doubleArea(triangles[a]), areaB = doubleArea(triangles[b]);
        return areaA != areaB ? areaA > areaB : a < b;
    });
    order.resize(std::min<size_t>(order.size(), count));
    std::sort(order.begin(), order.end());
    std::vector<SoupTriangle> chosen;
    for (const uint32_t i : order) chosen.push_back(triangles[i]);
    return chosen;
}

}  // namespace

SimplifyResult clusterVisible(const SimplifyRequest& request) {
    const std::span<const SoupTriangle> source =
        request.finer.empty() ? request.triangles : request.finer;
    const uint32_t proxyBudget = request.budgetTriangles * kProxyFactor;
    const bool isCoarse = request.cell.extentBits - request.cell.bits <= kVisibilityDepth;
    const auto cluster = [&](std::span<const SoupTriangle> triangles, uint32_t budget,
                             Outline outline) {
        return clusterToBudget(triangles, budget, request.cell.extentBits, *request.isTranslucent,
                               outline);
    };
    SimplifyResult result;
    result.isSloppy = true;
    result.proxy =
        isCoarse ? visibleOf(source) : std::vector<SoupTriangle>(source.begin(), source.end());
    if (isCoarse && result.proxy.size() > proxyBudget) {
        result.proxy = cluster(result.proxy, proxyBudget, Outline::AsClustered);
    }
    result.triangles = cluster(result.proxy, request.budgetTriangles, Outline::Unshrunk);
    // Nothing spans three cells at any size that keeps the budget: the largest stand in.
    if (result.triangles.empty()) result.triangles = largest(source, request.budgetTriangles);
    if (result.proxy.empty()) result.proxy = result.triangles;
    return result;
}

SimplifyResult simplifyNode(const SimplifyRequest& request) {
    if (request.triangles.size() <= request.targetTriangles) {
        SimplifyResult same;
        same.triangles.assign(request.triangles.begin(), request.triangles.end());
        return same;
    }
    SimplifyResult result = collapseEdges(request);
    if (!result.triangles.empty() && result.triangles.size() <= request.budgetTriangles)
        return result;
    return clusterVisible(request);
}

}  // namespace pagoda::hlod
