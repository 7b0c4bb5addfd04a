#include "tools/generate/scene_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace pagoda::tools {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr double kSameShape = 2e-3;  // relative; rounding to the grid moves areas by far less

// What no move or turn of an object changes.
struct Shape {
    uint64_t triangles = 0;
    double area = 0;    // square metres
    double spread = 0;  // root mean square distance of its surface from its centre, metres
};

bool isClose(double a, double b) {
    return std::abs(a - b) <= kSameShape * std::max(a, b);
}

uint64_t countDistinct(std::vector<Shape> shapes) {
    std::sort(shapes.begin(), shapes.end(), [](const Shape& a, const Shape& b) {
        return a.triangles != b.triangles ? a.triangles < b.triangles : a.area < b.area;
    });
    uint64_t distinct = 0;
    for (size_t i = 0; i < shapes.size(); ++i) {
        bool isNew = true;
        for (size_t j = i; j-- > 0 && shapes[j].triangles == shapes[i].triangles &&
                           isClose(shapes[j].area, shapes[i].area);) {
            if (isClose(shapes[j].spread, shapes[i].spread)) isNew = false;
        }
        if (isNew) ++distinct;
    }
    return distinct;
}

struct Moments {
    uint64_t triangles = 0;
    double area = 0, squares = 0;
    Vec3d first{0.0}, origin{0.0};
};

}  // namespace

SceneReport measureScene(const CollectedScene& scene, const SceneViews& views) {
    SceneReport report;
    report.triangles = scene.triangleCount();
    std::vector<Moments> moments(scene.objects.size());
    for (size_t t = 0; t < scene.triangleCount(); ++t) {
        const Vec3d a(scene.corners[3 * t]), b(scene.corners[3 * t + 1]),
            c(scene.corners[3 * t + 2]);
        for (const Vec3d& corner : {a, b, c}) report.box.extend(corner);
        const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
        if (!(area > 0)) ++report.degenerateTriangles;
        if (scene.isTranslucent(t)) ++report.translucentTriangles;
        Moments& sum = moments[scene.objectOf[t]];
        if (sum.triangles++ == 0) sum.origin = a;
        const Vec3d centre = (a + b + c) / 3.0 - sum.origin;
        sum.area += area;
        sum.first += area * centre;
        sum.squares += area * glm::dot(centre, centre);
    }
    std::vector<Shape> shapes;
    for (const Moments& sum : moments) {
        if (sum.triangles == 0) continue;
        const Vec3d mean = sum.first / std::max(sum.area, 1e-300);
        const double variance = sum.squares / std::max(sum.area, 1e-300) - glm::dot(mean, mean);
        shapes.push_back({sum.triangles, sum.area, std::sqrt(std::max(0.0, variance))});
    }
    report.objects = shapes.size();
    report.distinctShapes = countDistinct(std::move(shapes));
    report.coplanar = findCoplanarFaces(scene.corners);
    report.visible = measureVisibleShare(scene, views.walk, kWidth, kHeight);
    report.views = views.walk.size();
    return report;
}

std::string reportText(const SceneReport& report) {
    std::string text = fmt::format(
        "triangles                {}\n"
        "  translucent            {}\n"
        "  degenerate             {}\n"
        "objects                  {}\n"
        "  distinct shapes        {}\n"
        "bounds (m)               {:.3f} {:.3f} {:.3f} .. {:.3f} {:.3f} {:.3f}\n"
        "coplanar overlapping     {}\n",
        report.triangles, report.translucentTriangles, report.degenerateTriangles, report.objects,
        report.distinctShapes, report.box.min.x, report.box.min.y, report.box.min.z,
        report.box.max.x, report.box.max.y, report.box.max.z, report.coplanar.triangles);
    if (report.views == 0) return text;
    return text + fmt::format(
                      "walk, {} views, {}x{}\n"
                      "  in the frustum         {:.0f} (median)\n"
                      "  visible                {:.0f} (median)\n"
                      "  visible share          {:.2f}% (median), {:.2f}% (largest)\n",
                      report.views, kWidth, kHeight, report.visible.medianInFrustum,
                      report.visible.medianVisible, 100 * report.visible.median,
                      100 * report.visible.largest);
}

std::string reportJson(const SceneReport& report) {
    const auto point = [](const Vec3d& p) { return nlohmann::ordered_json{p.x, p.y, p.z}; };
    nlohmann::ordered_json json{
        {"triangles", report.triangles},
        {"translucent_triangles", report.translucentTriangles},
        {"degenerate_triangles", report.degenerateTriangles},
        {"objects", report.objects},
        {"distinct_shapes", report.distinctShapes},
        {"bounds", {{"min", point(report.box.min)}, {"max", point(report.box.max)}}},
        {"coplanar_overlapping", report.coplanar.triangles}};
    if (report.views > 0) {
        json["walk"] = {{"views", report.views},
                        {"width", kWidth},
                        {"height", kHeight},
                        {"in_frustum_median", report.visible.medianInFrustum},
                        {"visible_median", report.visible.medianVisible},
                        {"visible_share_median", report.visible.median},
                        {"visible_share_largest", report.visible.largest}};
    }
    return json.dump(2) + "\n";
}

}  // namespace pagoda::tools
