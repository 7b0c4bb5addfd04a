// `--reference` of real models against an independent ray cast of the files they were built from.
#include "cache/page_source.h"
#include "hlod/build/build.h"
#include "hlod/strategies/strategies.h"
#include "tests/viewer/embree_reference.h"
#include "tests/viewer/gl_fixture.h"
#include "viewer/renderer.h"

#include <algorithm>
#include <cstdio>

namespace pagoda::viewer {
namespace {

struct Case {
    const char* model;
    const char* view;
    double halfSize = 0;  // of a box around the middle corner of the file to look at, model units;
                          // 0: all of the model
};
// For gtest's own messages.
void PrintTo(const Case& c, std::ostream* out) {
    *out << c.model << " from " << c.view;
}

class ReferenceTest : public GlTest, public ::testing::WithParamInterface<Case> {
protected:
    void SetUp() override {
        model_ = std::filesystem::path(PAGODA_TEST_DATA) / GetParam().model;
        if (!std::filesystem::exists(model_)) {
            GTEST_SKIP() << "no model " << model_ << ": set PAGODA_TEST_DATA";
        }
        // Tests of one model run side by side.
        std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
        std::replace(test.begin(), test.end(), '/', '_');
        folder_ = std::filesystem::temp_directory_path() / ("pagoda_reference_" + test);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override {
        if (!folder_.empty()) std::filesystem::remove_all(folder_);
    }
    ooc::Database build() {
        hlod::BuildOptions options;
        options.inputs = hlod::expandInputs({model_.string()});
        options.target = folder_ / "model.pagoda";
        options.force = true;
        Progress quiet;
        static_cast<void>(hlod::buildDatabase(options, quiet));
        return ooc::Database::open(options.target);
    }
    // Around one corner of the model, for models that are mostly gaps.
    static Box3d closeUp(const std::vector<Vec3d>& corners) {
        const Vec3d centre = corners.at(corners.size() / 2);
        return {centre - GetParam().halfSize, centre + GetParam().halfSize};
    }
    std::filesystem::path model_, folder_;
};

TEST_P(ReferenceTest, AgreesWithARayCastOfTheFile) {
    const ooc::Database database = build();
    cache::DatabaseSource source(database);
    Renderer renderer(database.header().lattice, source, {});
    hlod::Camera camera;
    camera.widthPx = 400;
    camera.heightPx = 400;
    // On the database's lattice: how far snapping moves a corner is the builder's affair.
    const ooc::Lattice& lattice = database.header().lattice;
    std::vector<Vec3d> corners = test::TriangleCollector::read(model_);
    for (Vec3d& corner : corners) corner = lattice.toModel(lattice.snap(corner));
    const Box3d box = renderer.sceneBox();
    camera = hlod::frameBox(camera, GetParam().halfSize > 0 ? closeUp(corners) : box,
                            hlod::viewDirection(GetParam().view, hlod::UpAxis::Z), hlod::UpAxis::Z);
    hlod::FrameRecord record = renderer.renderReference(camera, {});
    const Picture picture = renderer.read(record);
    ASSERT_TRUE(record.faults.empty());

    // DESIGN: 0.1 % of covered pixels; depth to 1e-4; 0.01 px around a silhouette exempt and
    // counted.
    const hlod::View view(camera, box);
    const test::EmbreeReference reference(corners, view);
    uint64_t covered = 0, wrong = 0, exempt = 0;
    for (int y = 0; y < camera.heightPx; ++y) {
        for (int x = 0; x < camera.widthPx; ++x) {
            const double drawn = static_cast<double>(
                picture.depthsModelUnits[static_cast<size_t>(y * camera.widthPx + x)]);
            const double cast = reference.depthAt(x + 0.5, y + 0.5);
            covered += std::isinf(cast) ? 0u : 1u;
            const bool isRight =
                std::isinf(cast) ? std::isinf(drawn) : std::abs(drawn - cast) <= 1e-4 * cast;
            if (isRight) continue;
            if (reference.isNearEdge(x + 0.5, y + 0.5, 0.01, 1e-4)) {
                ++exempt;
            } else {
                ++wrong;
            }
        }
    }
    std::printf("%s from %s: %lu covered, %lu wrong, %lu exempt\n", GetParam().model,
                GetParam().view, static_cast<unsigned long>(covered),
                static_cast<unsigned long>(wrong), static_cast<unsigned long>(exempt));
    EXPECT_GE(covered, 10000u);
    EXPECT_LE(wrong, covered / 1000);
    EXPECT_LE(exempt, covered / 100);
}

// A leaf's own quantisation is all that tau 0 shows, on a database read from disk as well.
TEST_P(ReferenceTest, IsTheCutAtTauZero) {
    const ooc::Database database = build();
    cache::DatabaseSource source(database);
    Renderer renderer(database.header().lattice, source, {});
    const hlod::Camera camera = hlod::frameBox(
        {}, renderer.sceneBox(), hlod::viewDirection("iso", hlod::UpAxis::Z), hlod::UpAxis::Z);
    hlod::FrameRecord reference = renderer.renderReference(camera, {});
    const Picture expected = renderer.read(reference);
    hlod::FrameRecord cut =
        renderer.render(camera, *hlod::makeStrategy("frustum"), {.tauPx = 0, .background = {}});
    const Picture picture = renderer.read(cut);
    EXPECT_EQ(cut.drawnTriangles, reference.drawnTriangles);
    EXPECT_TRUE(picture.colours == expected.colours);
    EXPECT_TRUE(picture.triangles == expected.triangles);
}

INSTANTIATE_TEST_SUITE_P(Models, ReferenceTest,
                         ::testing::Values(Case{"scan/nefertiti.obj", "iso"},
                                           Case{"geo/delft.obj", "top"},
                                           Case{"geo/zurich-lod2-double.ply", "iso", 20},
                                           Case{"cad/piperack-steel.obj", "+x+y+z"},
                                           Case{"bim/duplex.glb", "iso"}));

}  // namespace
}  // namespace pagoda::viewer
