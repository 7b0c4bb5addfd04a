// Rays over the leaves against every triangle in turn: another test of a triangle (Moeller and
// Trumbore) in long double, without tree or lattice.
#include "hlod/view/leaf_ray.h"

#include "hlod/build/build.h"
#include "ooc/readers/reader.h"
#include "tests/viewer/memory_scene.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <random>

namespace pagoda::hlod {
namespace {

using pagoda::test::MemoryScene;
using pagoda::test::Triangle;
using Real = long double;
using Point = glm::vec<3, Real, glm::defaultp>;

struct Solid {
    Vec3d corners[3];
    uint32_t object = 0;
    bool isTranslucent = false;
};

// Where the ray meets the triangle's plane inside of it.
std::optional<Real> meets(const Solid& solid, const LeafRay& ray) {
    const Point a(solid.corners[0]), ab = Point(solid.corners[1]) - a,
                                     ac = Point(solid.corners[2]) - a;
    const Point direction(ray.direction), across = glm::cross(direction, ac);
    const Real determinant = glm::dot(ab, across);
    if (determinant == 0) return std::nullopt;
    const Point from = Point(ray.originModel) - a;
    const Real u = glm::dot(from, across) / determinant;
    const Point other = glm::cross(from, ab);
    const Real v = glm::dot(direction, other) / determinant;
    if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
    return glm::dot(ac, other) / determinant;
}

// The nearest of those that the ray may hit; infinite for none.
Real bruteForce(const std::vector<Solid>& solids, const LeafRay& ray, bool isTranslucent) {
    Real nearest = std::numeric_limits<Real>::infinity();
    for (const Solid& solid : solids) {
        if (solid.isTranslucent != isTranslucent) continue;
        if (ray.clip.hidden && ray.clip.hidden->contains(solid.object)) continue;
        const auto along = meets(solid, ray);
        if (!along || *along < ray.leastAlong || *along >= nearest) continue;
        const Vec3d point = ray.originModel + static_cast<double>(*along) * ray.direction;
        if (ray.clip.section && ray.clip.section->above(point) > 0.0) continue;
        nearest = *along;
    }
    return nearest;
}

// Three bumpy balls in a row, the middle one of glass, far from the origin.
struct Balls {
    MemoryScene scene;
    std::vector<Solid> solids;
    Vec3d centre;

    Balls() {
        ooc::Lattice lattice;
        lattice.origin = Vec3d(2'600'000.0, 1'200'000.0, 400.0);
        lattice.stepExponent = -10;
        lattice.extentBits = 16;  // 64 units
        std::vector<Triangle> triangles;
        for (uint32_t i = 0; i < 3; ++i) {
            const uint32_t colour = i == 1 ? 0x60FFFFFFu : 0xFFFFFFFFu;
            auto ball = pagoda::test::bumpySphere(Vec3d(12'000.0 + 20'000.0 * i, 32'768, 32'768),
                                                  9'000, 24, colour);
            for (Triangle& t : ball) t.object = i;
            triangles.insert(triangles.end(), ball.begin(), ball.end());
        }
        for (const Triangle& t : triangles) {
            solids.push_back({{lattice.toModel(t.corners[0]), lattice.toModel(t.corners[1]),
                               lattice.toModel(t.corners[2])},
                              t.object,
                              t.colour >> 24 != 255});
        }
        centre = lattice.toModel(Vec3i(32'768));
        scene = MemoryScene::make(lattice, std::move(triangles), 100);
    }
};

const Balls& balls() {
    static const Balls made;
    return made;
}

LeafRay randomRay(std::mt19937& random, const Balls& scene) {
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    LeafRay ray;
    ray.originModel =
        scene.centre + 90.0 * glm::normalize(Vec3d(number(random), number(random), number(random)));
    const Vec3d at = scene.centre +
                     Vec3d(30.0, 9.0, 9.0) * Vec3d(number(random), number(random), number(random));
    ray.direction = (at - ray.originModel) * (1.5 + number(random));
    return ray;
}

void expectNearest(const Balls& scene, const LeafRay& ray, int& hits) {
    const LeafRayResult result = castLeafRay(scene.scene, scene.scene.lattice, ray);
    ASSERT_TRUE(result.faults.empty());
    const Real opaque = bruteForce(scene.solids, ray, false);
    const Real expected = std::isinf(opaque) ? bruteForce(scene.solids, ray, true) : opaque;
    ASSERT_EQ(result.isHit, !std::isinf(expected));
    if (!result.isHit) return;
    ++hits;
    ASSERT_EQ(result.hit.isTranslucent, std::isinf(opaque));
    ASSERT_NEAR(result.hit.along, static_cast<double>(expected), 1e-9);
    const Vec3d point = ray.originModel + static_cast<double>(expected) * ray.direction;
    ASSERT_LT(glm::distance(point, result.hit.pointModel), 1e-6);
    // It is the triangle that it says it is.
    const ooc::PageMesh& mesh = scene.scene.pages.at(result.hit.leaf).mesh;
    for (size_t i = 0; i < 3; ++i) {
        const uint32_t index = mesh.indices[size_t{3} * result.hit.triangle + i];
        ASSERT_EQ(scene.scene.lattice.toModel(mesh.positions[index]), result.hit.cornersModel[i]);
    }
}

TEST(LeafRay, HitsTheNearestTriangleOfAll) {
    std::mt19937 random(1);
    int hits = 0;
    for (int i = 0; i < 400; ++i) expectNearest(balls(), randomRay(random, balls()), hits);
    EXPECT_GT(hits, 100);
}

TEST(LeafRay, PassesThroughWhatIsHiddenAndWhatIsCutAway) {
    std::mt19937 random(2);
    int hits = 0;
    for (int i = 0; i < 400; ++i) {
        LeafRay ray = randomRay(random, balls());
        auto hidden = std::make_shared<ooc::ObjectSet>(3);
        for (uint32_t object = 0; object < 3; ++object) {
            if (random() % 3 == 0) hidden->insert(object);
        }
        ray.clip.hidden = hidden;
        const LeafRay normal = randomRay(random, balls());
        SectionPlane plane;
        plane.normal = glm::normalize(normal.direction);
        plane.offset = glm::dot(plane.normal, balls().centre) +
                       std::uniform_real_distribution<double>(-9, 9)(random);
        ray.clip.section = plane;
        expectNearest(balls(), ray, hits);
    }
    EXPECT_GT(hits, 100);
}

// Closed surfaces: a ray at a corner or at the middle of an edge may not slip through.
TEST(LeafRay, DoesNotSlipThroughEdgesAndCorners) {
    for (const Solid& solid : balls().solids) {
        if (solid.object != 0) continue;
        for (const double weight : {0.0, 0.5}) {
            LeafRay ray;
            ray.originModel = balls().centre - Vec3d(20.0, 0.0, 0.0);
            ray.direction = glm::mix(solid.corners[0], solid.corners[1], weight) - ray.originModel;
            const LeafRayResult result = castLeafRay(balls().scene, balls().scene.lattice, ray);
            ASSERT_TRUE(result.isHit);
            ASSERT_NEAR(result.hit.along, 1.0, 1e-9);
        }
    }
}

TEST(LeafRay, ReadsLittleMoreThanWhatTheRayPasses) {
    std::mt19937 random(3);
    for (int i = 0; i < 50; ++i) {
        const LeafRay ray = randomRay(random, balls());
        const LeafRayResult result = castLeafRay(balls().scene, balls().scene.lattice, ray);
        EXPECT_LT(result.readPages, balls().scene.pages.size() / 4);
    }
}

TEST(LeafRay, SaysWhatCouldNotBeRead) {
    MemoryScene scene = balls().scene;
    LeafRay ray;
    ray.originModel = balls().centre - Vec3d(90.0, 0.0, 0.0);
    ray.direction = Vec3d(1.0, 1e-3, 2e-3);
    const LeafRayResult whole = castLeafRay(scene, scene.lattice, ray);
    ASSERT_TRUE(whole.isHit);
    scene.failing.insert(whole.hit.leaf);
    const LeafRayResult broken = castLeafRay(scene, scene.lattice, ray);
    EXPECT_EQ(broken.faults.size(), 1u);
    ASSERT_TRUE(broken.isHit);
    EXPECT_GT(broken.hit.along, whole.hit.along);
    EXPECT_TRUE(castLeafRay(scene, scene.lattice, ray, [] { return true; }).isCancelled);
}

// Triangles of a file as they are, before any lattice.
class Collector final : public ooc::TriangleSink {
public:
    std::vector<Solid> solids;
    uint32_t addObject(const ooc::ObjectInfo&) override { return objects_++; }
    uint32_t addMaterial(const ooc::MaterialInfo&) override { return materials_++; }
    void addTriangles(const ooc::TriangleBatch& batch) override {
        for (size_t i = 0; i + 2 < batch.positions.size(); i += 3) {
            solids.push_back(
                {{batch.positions[i], batch.positions[i + 1], batch.positions[i + 2]}});
        }
    }
    void dropped(ooc::DropReason, uint64_t) override {}
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t) override {}

private:
    uint32_t objects_ = 0, materials_ = 0;
};

double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
    const Vec3d ab = b - a;
    const double t = glm::clamp(glm::dot(p - a, ab) / std::max(glm::dot(ab, ab), 1e-300), 0.0, 1.0);
    return glm::distance(p, a + t * ab);
}

double distanceTo(const Vec3d& p, const Solid& s) {
    const Vec3d normal = glm::cross(s.corners[1] - s.corners[0], s.corners[2] - s.corners[0]);
    const double size = glm::length(normal);
    double nearest = std::numeric_limits<double>::infinity();
    bool isOver = size > 0.0;
    for (int i = 0; i < 3; ++i) {
        const Vec3d &a = s.corners[i], &b = s.corners[(i + 1) % 3];
        nearest = std::min(nearest, distanceToSegment(p, a, b));
        isOver = isOver && glm::dot(glm::cross(normal, b - a), p - a) >= 0.0;
    }
    return isOver ? std::abs(glm::dot(normal, p - s.corners[0])) / size : nearest;
}

// Far from the origin, in double: what is picked lies on the model to the leaf's stated error.
class LeafRayOnModel : public testing::TestWithParam<const char*> {};

TEST_P(LeafRayOnModel, AgreesWithTheFileToTheStatedError) {
    const std::filesystem::path model = std::filesystem::path(PAGODA_TEST_DATA) / GetParam();
    if (!std::filesystem::exists(model)) {
        GTEST_SKIP() << "no model " << model << ": set PAGODA_TEST_DATA";
    }
    const auto target = std::filesystem::temp_directory_path() /
                        ("pagoda_leaf_ray_" + model.stem().string() + ".pagoda");
    BuildOptions options;
    options.inputs = expandInputs({model.string()});
    options.target = target;
    options.force = true;
    options.nodeTriangles = 512;
    Progress quiet;
    static_cast<void>(buildDatabase(options, quiet));
    const ooc::Database database = ooc::Database::open(target);
    const cache::DatabaseSource source(database);
    std::map<ooc::NodeId, double> errors;
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            errors[node.id] = node.errorModelUnits;
            return true;
        },
        [](uint32_t, const std::string& why) { FAIL() << why; });
    Collector file;
    ooc::openReader(model, {})->read(file);

    std::mt19937 random(4);
    const ooc::Lattice& lattice = database.header().lattice;
    int hits = 0;
    double greatest = 0.0, stated = 0.0;
    for (int i = 0; i < 100; ++i) {
        // From above and aside, at a corner of the model.
        const Solid& at = file.solids[random() % file.solids.size()];
        std::uniform_real_distribution<double> number(0.1, 1.0);
        const Vec3d middle = (at.corners[0] + at.corners[1] + at.corners[2]) / 3.0;
        LeafRay ray;
        ray.originModel =
            middle + 200.0 * Vec3d(number(random) - 0.5, number(random) - 0.5, number(random));
        ray.direction = middle - ray.originModel;
        const LeafRayResult result = castLeafRay(source, lattice, ray);
        const Real expected = bruteForce(file.solids, ray, false);
        if (!result.isHit) continue;
        ++hits;
        // On the file's surface, and nothing of it is nearer: what is in front of a silhouette by
        // less than the error may be missed.
        const double error = errors.at(result.hit.leaf);
        double distance = std::numeric_limits<double>::infinity();
        for (const Solid& solid : file.solids) {
            distance = std::min(distance, distanceTo(result.hit.pointModel, solid));
        }
        greatest = std::max(greatest, distance);
        stated = std::max(stated, error);
        EXPECT_LE(distance, error * (1 + 1e-9)) << "ray " << i;
        // Grazing the surface, the same distance from it is farther along the ray.
        const double apart =
            std::abs(result.hit.along - static_cast<double>(expected)) * glm::length(ray.direction);
        const Vec3d normal = glm::cross(result.hit.cornersModel[1] - result.hit.cornersModel[0],
                                        result.hit.cornersModel[2] - result.hit.cornersModel[0]);
        const double slant =
            std::abs(glm::dot(glm::normalize(normal), ray.direction)) / glm::length(ray.direction);
        if (slant > 0.2 && !std::isinf(expected)) {
            EXPECT_LE(apart, 6.0 * error) << "ray " << i;
        }
    }
    EXPECT_GT(hits, 90);
    std::printf("%s: %d hits, at most %.3g from the file, stated error %.3g\n", GetParam(), hits,
                greatest, stated);
    std::filesystem::remove(target);
}

INSTANTIATE_TEST_SUITE_P(Georeferenced, LeafRayOnModel,
                         testing::Values("geo/zurich-lod2-double.ply", "geo/zurich-lod2.obj",
                                         "geo/delft.obj"),
                         [](const auto& item) {
                             std::string name = item.param;
                             for (char& c : name) {
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             }
                             return name;
                         });

}  // namespace
}  // namespace pagoda::hlod
