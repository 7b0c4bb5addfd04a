// What a writer wrote, our readers read back: the same triangles, colours, names and materials.
#include "ooc/writers/mesh_writer.h"

#include "ooc/base/error.h"
#include "tests/ooc/readers/collecting_sink.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <tuple>
#include <vector>

namespace pagoda::ooc::test {
namespace {

namespace fs = std::filesystem;

struct Folder {
    fs::path path = fs::path(testing::TempDir()) / ("pagoda_writers_" + std::to_string(getpid()));
    Folder() {
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() { fs::remove_all(path); }
};

struct ModelOptions {
    Vec3d origin{0.0};
    bool isFloat = true, hasColours = false, hasNormals = false;
    size_t trianglesPerBatch = 300;
};

// Objects: hall > (pump, pane); materials: steel, glass (translucent), white.
class Model {
public:
    explicit Model(const ModelOptions& options) {
        std::mt19937 random(7);
        for (uint32_t i = 0; i < 6; ++i) {
            TriangleBatch batch;
            batch.object = 1 + i % 2;
            batch.material = i % 3;
            for (size_t corner = 0; corner < 3 * options.trianglesPerBatch; ++corner) {
                // A coarse grid: corners coincide, as in a real mesh.
                Vec3d point;
                for (int axis = 0; axis < 3; ++axis) {
                    point[axis] = static_cast<double>(random() % 64) / 8 + 10.0 * batch.object;
                }
                point += options.origin;
                batch.positions.push_back(options.isFloat ? point : point + Vec3d(0.1, 0.2, 0.3));
                if (options.hasColours && i >= 3) {
                    batch.colours.push_back(static_cast<uint32_t>(random()) | 0xFF000000u);
                }
                if (options.hasNormals && i >= 2) {
                    batch.normals.push_back(corner % 2 == 0 ? Vec3f(0, 0, 1)
                                                            : Vec3f(0.6f, 0.8f, 0));
                }
            }
            batches.push_back(std::move(batch));
        }
    }

    void write(const fs::path& target, UpAxis up = UpAxis::Unknown) const {
        const auto writer = MeshWriter::create(target, true, up);
        send(*writer);
        EXPECT_EQ(writer->finish() > 0, true);
    }
    void send(TriangleSink& sink) const {
        sink.addObject({.name = "hall"});
        sink.addObject({.name = "pump \"7\"", .parent = 0});
        sink.addObject({.name = "pane", .parent = 0});
        sink.addMaterial({.name = "steel", .colour = 0xFF998877u, .isTranslucent = false});
        sink.addMaterial({.name = "glass", .colour = 0x60C0B0A0u, .isTranslucent = true});
        sink.addMaterial({.name = "white", .colour = 0xFFFFFFFFu, .isTranslucent = false});
        for (const TriangleBatch& batch : batches) sink.addTriangles(batch);
    }

    std::vector<TriangleBatch> batches;
};

CollectingSink readBack(const fs::path& path) {
    CollectingSink sink;
    openReader(path, {})->read(sink);
    return sink;
}

CollectingSink given(const Model& model) {
    CollectingSink sink;
    model.send(sink);
    return sink;
}

// In an order that does not depend on how a format groups its triangles.
std::vector<CollectedTriangle> sorted(std::vector<CollectedTriangle> triangles) {
    const auto key = [](const CollectedTriangle& t) {
        std::array<double, 9> values;
        for (size_t i = 0; i < 9; ++i) {
            values[i] = t.corner[i / 3][static_cast<glm::length_t>(i % 3)];
        }
        return std::make_tuple(values, t.colour[0], t.colour[1], t.colour[2]);
    };
    std::sort(triangles.begin(), triangles.end(),
              [&](const auto& a, const auto& b) { return key(a) < key(b); });
    return triangles;
}

void expectSameCorners(const std::vector<CollectedTriangle>& got,
                       const std::vector<CollectedTriangle>& wanted, double tolerance) {
    ASSERT_EQ(got.size(), wanted.size());
    for (size_t t = 0; t < got.size(); ++t) {
        for (size_t i = 0; i < 3; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_NEAR(got[t].corner[i][axis], wanted[t].corner[i][axis], tolerance) << t;
            }
        }
    }
}

std::string textOf(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST(MeshWriter, PlyComesBackExactly) {
    const Folder folder;
    for (const bool isFloat : {true, false}) {
        const Model model({.origin = Vec3d(isFloat ? 0.0 : 5e6),
                           .isFloat = isFloat,
                           .hasColours = true,
                           .hasNormals = true});
        model.write(folder.path / "m.ply");
        // The reader gives translucent triangles apart, so the order is not the file's.
        const auto got = sorted(readBack(folder.path / "m.ply").triangles);
        const auto wanted = sorted(given(model).triangles);
        expectSameCorners(got, wanted, 0.0);
        for (size_t t = 0; t < got.size(); ++t) {
            // PLY has no materials: their colours are at the vertices.
            for (size_t i = 0; i < 3; ++i) {
                ASSERT_EQ(got[t].colour[i], wanted[t].colour[i]);
            }
        }
        const std::string header = textOf(folder.path / "m.ply").substr(0, 512);
        EXPECT_EQ(header.find("property double x") == std::string::npos, isFloat);
    }
}

TEST(MeshWriter, PlyTurnsToDoublesWhenOneCoordinateOfTheLastBatchIsNoFloat) {
    const Folder folder;
    for (int axis = 0; axis < 3; ++axis) {
        Model model({});
        model.batches.back().positions.back()[axis] = 0.1;
        model.write(folder.path / "m.ply");
        expectSameCorners(sorted(readBack(folder.path / "m.ply").triangles),
                          sorted(given(model).triangles), 0.0);
    }
}

TEST(MeshWriter, PlyOfAPlainMeshHasNeitherColoursNorNormals) {
    const Folder folder;
    const auto writer = MeshWriter::create(folder.path / "m.ply", false);
    Model model({});
    model.batches.front().material = 0;
    writer->addObject({});
    writer->addMaterial({});
    writer->addTriangles(model.batches.front());
    writer->finish();
    const std::string header = textOf(folder.path / "m.ply").substr(0, 512);
    EXPECT_EQ(header.find("red"), std::string::npos);
    EXPECT_EQ(header.find("nx"), std::string::npos);
    EXPECT_EQ(readBack(folder.path / "m.ply").triangles.size(), 300u);
}

TEST(MeshWriter, PlyWeldsWithinABatch) {
    const Folder folder;
    const Model model(
        {.trianglesPerBatch = 4000});  // 12000 corners on 64^3 points, drawn at random
    model.write(folder.path / "m.ply");
    const std::string text = textOf(folder.path / "m.ply");
    const size_t at = text.find("element vertex ") + 15;
    const size_t vertices = std::stoul(text.substr(at));
    EXPECT_LT(vertices, 6u * 12000u);
    EXPECT_EQ(readBack(folder.path / "m.ply").triangles.size(), 24000u);
}

TEST(MeshWriter, ObjComesBackWithNamesAndMaterials) {
    const Folder folder;
    const Model model({.origin = Vec3d(4.5e6, 5e6, 100), .isFloat = false, .hasNormals = true});
    model.write(folder.path / "m.obj");
    const CollectingSink got = readBack(folder.path / "m.obj"), wanted = given(model);
    expectSameCorners(got.triangles, wanted.triangles, 0.0);
    for (size_t t = 0; t < got.triangles.size(); ++t) {
        const CollectedTriangle& a = got.triangles[t];
        const CollectedTriangle& b = wanted.triangles[t];
        ASSERT_EQ(got.objects[a.object].name, wanted.objects[b.object].name);
        ASSERT_EQ(got.materials[a.material].name, wanted.materials[b.material].name);
        ASSERT_EQ(got.materials[a.material].colour, wanted.materials[b.material].colour);
        ASSERT_EQ(got.materials[a.material].isTranslucent,
                  wanted.materials[b.material].isTranslucent);
    }
}

TEST(MeshWriter, GlbComesBackWithNamesMaterialsAndColours) {
    const Folder folder;
    const Model model({.hasColours = true, .hasNormals = true});
    model.write(folder.path / "m.glb");
    const CollectingSink got = readBack(folder.path / "m.glb"), wanted = given(model);
    const auto a = sorted(got.triangles), b = sorted(wanted.triangles);
    expectSameCorners(a, b, 0.0);
    for (size_t t = 0; t < a.size(); ++t) {
        ASSERT_EQ(got.objects[a[t].object].name, wanted.objects[b[t].object].name);
        ASSERT_EQ(got.materials[a[t].material].isTranslucent,
                  wanted.materials[b[t].material].isTranslucent);
        for (size_t i = 0; i < 3; ++i) ASSERT_EQ(a[t].colour[i], b[t].colour[i]);
    }
    const auto pump = std::find_if(got.objects.begin(), got.objects.end(),
                                   [](const ObjectInfo& o) { return o.name == "pump \"7\""; });
    ASSERT_NE(pump, got.objects.end());
    ASSERT_LT(pump->parent, got.objects.size());
    EXPECT_EQ(got.objects[pump->parent].name, "hall");
}

TEST(MeshWriter, GlbFarFromTheOriginKeepsItsShape) {
    const Folder folder;
    const Model model({.origin = Vec3d(4.5e6, 5e6, 100), .isFloat = false});
    model.write(folder.path / "m.glb");
    // 8 m of extent about the object's own translation: a float resolves 1e-6 m there.
    expectSameCorners(sorted(readBack(folder.path / "m.glb").triangles),
                      sorted(given(model).triangles), 2e-6);
}

TEST(MeshWriter, GlbSplitsMeshesBeyond16BitIndices) {
    const Folder folder;
    const Model model({.hasColours = true, .trianglesPerBatch = 60000});
    model.write(folder.path / "m.glb");
    expectSameCorners(sorted(readBack(folder.path / "m.glb").triangles),
                      sorted(given(model).triangles), 0.0);
}

TEST(MeshWriter, GlbOfAZUpModelIsTurnedToYUp) {
    const Folder folder;
    const Model model({});
    model.write(folder.path / "m.glb", UpAxis::Z);
    CollectingSink wanted = given(model);
    for (CollectedTriangle& triangle : wanted.triangles) {
        for (Vec3d& corner : triangle.corner) corner = {corner.x, corner.z, -corner.y};
    }
    expectSameCorners(sorted(readBack(folder.path / "m.glb").triangles), sorted(wanted.triangles),
                      0.0);
}

TEST(MeshWriter, StlComesBackInOrder) {
    const Folder folder;
    const Model model({});
    model.write(folder.path / "m.stl");
    expectSameCorners(readBack(folder.path / "m.stl").triangles, given(model).triangles, 0.0);
}

TEST(MeshWriter, TheSameCallsGiveTheSameBytes) {
    const Folder folder;
    const Model model({.hasColours = true, .hasNormals = true});
    for (const char* kind : {".ply", ".obj", ".glb", ".stl"}) {
        const fs::path path = folder.path / (std::string("m") + kind);
        model.write(path);
        const std::string first = textOf(path);
        model.write(path);
        EXPECT_TRUE(first == textOf(path)) << kind;
    }
}

TEST(MeshWriter, AWriterThatDoesNotFinishLeavesNothing) {
    const Folder folder;
    for (const char* kind : {".ply", ".obj", ".glb", ".stl"}) {
        const auto writer = MeshWriter::create(folder.path / (std::string("m") + kind), false);
        Model({}).send(*writer);
    }
    EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(MeshWriter, AnExistingFileNeedsForce) {
    const Folder folder;
    std::ofstream(folder.path / "m.ply") << "mine";
    EXPECT_THROW((void)MeshWriter::create(folder.path / "m.ply", false), Error);
    EXPECT_EQ(textOf(folder.path / "m.ply"), "mine");
    Model({}).write(folder.path / "m.ply");
    EXPECT_NE(textOf(folder.path / "m.ply"), "mine");
}

TEST(MeshWriter, AnUnknownExtensionIsRefusedWithTheKnownOnes) {
    try {
        (void)MeshWriter::create("model.fbx", false);
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(error.remedy().find(".glb"), std::string::npos);
    }
}

}  // namespace
}  // namespace pagoda::ooc::test
