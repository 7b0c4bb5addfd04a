// Truth: counts of stats.json (made by other readers), positions and colours worked out by hand
// from the specification, and files stored twice (with and without compression).
#include "ooc/readers/gltf_reader.h"

#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/gltf_builder.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace pagoda::ooc::test {
namespace {

struct CountingSink : TriangleSink {
    uint64_t triangles = 0, drops = 0, bytes = 0;
    uint32_t objects = 0, materials = 0;
    uint32_t addObject(const ObjectInfo&) override { return objects++; }
    uint32_t addMaterial(const MaterialInfo&) override { return materials++; }
    void addTriangles(const TriangleBatch& batch) override { triangles += batch.triangleCount(); }
    void dropped(DropReason, uint64_t count) override { drops += count; }
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t count) override { bytes += count; }
};

Vec3d point(double x, double y, double z) {
    return {x, y, z};
}

uint32_t rgba(uint32_t r, uint32_t g, uint32_t b, uint32_t a = 255) {
    return r | g << 8 | b << 16 | a << 24;
}

void expectCorners(const CollectedTriangle& triangle, const Vec3d& a, const Vec3d& b,
                   const Vec3d& c) {
    const Vec3d expected[] = {a, b, c};
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_LT(glm::distance(triangle.corner[i], expected[i]), 1e-12)
            << "corner " << i << ": " << triangle.corner[i].x << " " << triangle.corner[i].y << " "
            << triangle.corner[i].z;
    }
}

TEST(GltfReader, EveryValidFileGivesTheTrianglesThatOtherReadersCounted) {
    PAGODA_REQUIRE_TEST_DATA();
    const Json stats = Json::parse(std::ifstream(testData() / "stats.json"));
    size_t files = 0;
    for (const auto& [name, counts] : stats.items()) {
        const std::string extension = std::filesystem::path(name).extension().string();
        if (name.starts_with("malformed/") || (extension != ".gltf" && extension != ".glb"))
            continue;
        if (name == "cad/lego-show-a.glb" && std::getenv("PAGODA_NIGHTLY") == nullptr) continue;
        SCOPED_TRACE(name);
        ++files;
        CountingSink sink;
        const auto reader = openGltfReader(testData() / name, {});
        ASSERT_NO_THROW(reader->read(sink));
        EXPECT_EQ(sink.triangles + sink.drops, counts["tris"].get<uint64_t>());
        EXPECT_EQ(reader->announcedTriangles(), counts["tris"].get<uint64_t>());
        EXPECT_EQ(sink.bytes, std::filesystem::file_size(testData() / name));
    }
    EXPECT_GT(files, 60u);
}

TEST(GltfReader, ASecondReadGivesTheSame) {
    PAGODA_REQUIRE_TEST_DATA();
    for (const char* name : {"zoo/gltf/draco-truck/CesiumMilkTruck.gltf", "zoo/gltf/pirate.glb",
                             "zoo/gltf/AlphaBlendModeTest.glb"}) {
        const auto reader = openReader(testData() / name, {});
        CollectingSink first, second;
        reader->read(first);
        reader->read(second);
        EXPECT_EQ(first.triangles, second.triangles) << name;
        EXPECT_EQ(first.objects.size(), second.objects.size()) << name;
    }
}

TEST(GltfReader, AMirroredNodeKeepsItsOutsideOutside) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.primitive()["attributes"]["NORMAL"] = file.addFloats({0, 0, 1, 0, 0, 1, 0, 0.6F, 0.8F}, 3);
    file.node()["scale"] = {-2, 1, 1};
    const CollectingSink sink = readAll(file.write(folder));
    ASSERT_EQ(sink.triangles.size(), 1u);
    // Mirrored at x, corners 2 and 3 exchanged: counter-clockwise from +z again.
    expectCorners(sink.triangles[0], point(0, 0, 0), point(0, 1, 0), point(-2, 0, 0));
    EXPECT_NEAR(sink.triangles[0].normal[0].z, 1, 1e-6);
    EXPECT_NEAR(sink.triangles[0].normal[1].y, 0.6, 1e-6);
}

TEST(GltfReader, NormalsGoByTheInverseTranspose) {
    TempFolder folder;
    GltfBuilder file;
    file.setPositions({1, 0, 0, 0, 1, 0, 0, 0, 1});
    const float third = 0.57735027F;
    file.primitive()["attributes"]["NORMAL"] =
        file.addFloats({third, third, third, third, third, third, third, third, third}, 3);
    file.node()["scale"] = {2, 1, 1};
    const CollectingSink sink = readAll(file.write(folder));
    ASSERT_EQ(sink.triangles.size(), 1u);
    // The plane x/2 + y + z = 1 has the normal (1, 2, 2) / 3.
    EXPECT_NEAR(sink.triangles[0].normal[0].x, 1.0 / 3, 1e-6);
    EXPECT_NEAR(sink.triangles[0].normal[0].y, 2.0 / 3, 1e-6);
}

TEST(GltfReader, NodesTransformInDoubleParentsAfterChildren) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.root["nodes"] = Json::parse(
        R"([{"name": "far", "translation": [5000000.25, 0, 0], "children": [1]},
            {"name": "part", "mesh": 0, "rotation": [0, 0, 0.70710678118654757, 0.70710678118654757],
             "scale": [3, 1, 1], "translation": [0.125, 0, 0]}])");
    const CollectingSink sink = readAll(file.write(folder));
    ASSERT_EQ(sink.triangles.size(), 1u);
    // Scaled, turned by 90 degrees about z, then moved.
    expectCorners(sink.triangles[0], point(5000000.375, 0, 0), point(5000000.375, 3, 0),
                  point(4999999.375, 0, 0));
    ASSERT_EQ(sink.objects.size(), 2u);
    EXPECT_EQ(sink.objects[1].name, "part");
    EXPECT_EQ(sink.objects[1].parent, 0u);
    EXPECT_EQ(sink.triangles[0].object, 1u);
}

TEST(GltfReader, InstancesMultiplyWithinTheirNode) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    const size_t translation = file.addFloats({0, 0, 0, 10, 0, 0}, 3);
    const size_t rotation = file.addAccessor(
        file.addView(std::vector<int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0}), 5122, "VEC4", 2, true);
    const size_t scale = file.addFloats({1, 1, 1, 2, 2, -2}, 3);
    file.node() = {
        {"mesh", 0},
        {"name", "bolt"},
        {"translation", {0, 0, 5}},
        {"extensions",
         {{"EXT_mesh_gpu_instancing",
           {{"attributes",
             {{"TRANSLATION", translation}, {"ROTATION", rotation}, {"SCALE", scale}}}}}}}};
    file.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const CollectingSink sink = readAll(file.write(folder));
    ASSERT_EQ(sink.triangles.size(), 2u);
    expectCorners(sink.triangles[0], point(0, 0, 5), point(1, 0, 5), point(0, 1, 5));
    // Mirrored at z (corners exchanged), turned by 180 degrees about z, moved by 10.
    expectCorners(sink.triangles[1], point(10, 0, 5), point(10, -2, 5), point(8, 0, 5));
    ASSERT_EQ(sink.objects.size(), 3u);
    EXPECT_EQ(sink.objects[2].name, "bolt#1");
    EXPECT_EQ(sink.objects[2].parent, 0u);
    EXPECT_EQ(sink.triangles[1].object, 2u);
}

template <typename Index>
void expectStripAndFan(int componentType) {
    for (const int mode : {5, 6}) {
        TempFolder folder;
        GltfBuilder file;
        file.setPositions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
        file.primitive()["mode"] = mode;
        file.primitive()["indices"] = file.addAccessor(file.addView(std::vector<Index>{0, 1, 2, 3}),
                                                       componentType, "SCALAR", 4);
        const CollectingSink sink = readAll(file.write(folder));
        ASSERT_EQ(sink.triangles.size(), 2u);
        const Vec3d a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(1, 1, 0);
        if (mode == 5) {  // (0 1 2), (1 3 2): both counter-clockwise
            expectCorners(sink.triangles[0], a, b, c);
            expectCorners(sink.triangles[1], b, d, c);
        } else {  // (1 2 0), (2 3 0), as the specification orders them
            expectCorners(sink.triangles[0], b, c, a);
            expectCorners(sink.triangles[1], c, d, a);
        }
    }
}

TEST(GltfReader, StripsAndFansOfAllIndexTypesKeepTheirWinding) {
    expectStripAndFan<uint8_t>(5121);
    expectStripAndFan<uint16_t>(5123);
    expectStripAndFan<uint32_t>(5125);
}

TEST(GltfReader, SparseAccessorsReplaceElementsWithAndWithoutBase) {
    for (const bool hasBase : {true, false}) {
        TempFolder folder;
        GltfBuilder file;
        file.setTriangle();
        Json& positions = file.root["accessors"][0];
        if (!hasBase) positions.erase("bufferView");
        const size_t indices = file.addView(std::vector<uint8_t>{1, 2});
        const size_t values = file.addView(std::vector<float>{7, 8, 9, 4, 5, 6});
        file.root["accessors"][0]["sparse"] = {
            {"count", 2},
            {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
            {"values", {{"bufferView", values}}}};
        const CollectingSink sink = readAll(file.write(folder));
        ASSERT_EQ(sink.triangles.size(), 1u);
        expectCorners(sink.triangles[0], point(0, 0, 0), point(7, 8, 9), point(4, 5, 6));
    }
}

TEST(GltfReader, QuantisedPositionsAreReadAsTheyAreOrNormalised) {
    for (const bool isNormalised : {true, false}) {
        TempFolder folder;
        GltfBuilder file;
        const size_t view =
            file.addView(std::vector<int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0});
        file.root["bufferViews"][view]["byteStride"] = 8;
        file.primitive()["attributes"]["POSITION"] =
            file.addAccessor(view, 5122, "VEC3", 3, isNormalised);
        const CollectingSink sink = readAll(file.write(folder));
        ASSERT_EQ(sink.triangles.size(), 1u);
        const double unit = isNormalised ? 1 : 32767, least = isNormalised ? -1 : -32768;
        expectCorners(sink.triangles[0], point(0, 0, 0), point(unit, 0, 0), point(0, least, 0));
    }
}

TEST(GltfReader, VertexColoursMultiplyTheFactorLinearlyAndComeOutAsSrgb) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.primitive()["attributes"]["COLOR_0"] =
        file.addAccessor(file.addView(std::vector<uint16_t>{65535, 65535, 65535, 65535, 65535, 0,
                                                            65535, 65535, 0, 0, 0, 32768}),
                         5123, "VEC4", 3, true);
    file.primitive()["material"] = 0;
    file.root["materials"] = Json::parse(
        R"([{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 0.5]}}])");
    const CollectingSink sink = readAll(file.write(folder));
    ASSERT_EQ(sink.triangles.size(), 1u);
    // sRGB of 0.5 is 0.7354 (188 of 255), of 0.25 0.5371 (137).
    EXPECT_EQ(sink.triangles[0].colour[0], rgba(188, 137, 255, 128));
    EXPECT_EQ(sink.triangles[0].colour[1], rgba(188, 0, 255, 128));
    EXPECT_EQ(sink.triangles[0].colour[2], rgba(0, 0, 0, 64));
    ASSERT_EQ(sink.materials.size(), 1u);
    EXPECT_TRUE(sink.materials[0].isTranslucent);
    EXPECT_EQ(sink.materials[0].colour, rgba(188, 137, 255, 128));
}

TEST(GltfReader, AlphaCountsForNothingWhereTheMaterialIsOpaque) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.primitive()["material"] = 0;
    file.root["materials"] =
        Json::parse(R"([{"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}])");
    const CollectingSink sink = readAll(file.write(folder));
    EXPECT_FALSE(sink.materials[0].isTranslucent);
    EXPECT_EQ(sink.materials[0].colour, rgba(255, 255, 255));
}

// A triangle whose corners have the given texture coordinates on the four colours.
GltfBuilder textured(const std::vector<float>& uvs, const Json& sampler) {
    GltfBuilder file;
    file.setTriangle();
    file.primitive()["attributes"]["TEXCOORD_0"] = file.addFloats(uvs, 2);
    file.primitive()["material"] = 0;
    file.root["images"] = {{{"uri", kFourColours}}};
    file.root["samplers"] = {sampler};
    file.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
    file.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    return file;
}

TEST(GltfReader, TexturesBecomeCornerColours) {
    TempFolder folder;
    // The centres of three pixels: red, green, blue.
    GltfBuilder file = textured({0.25F, 0.25F, 0.75F, 0.25F, 0.25F, 0.75F}, Json::object());
    const CollectingSink sink = readAll(file.write(folder));
    ASSERT_EQ(sink.triangles.size(), 1u);
    EXPECT_EQ(sink.triangles[0].colour[0], rgba(255, 0, 0));
    EXPECT_EQ(sink.triangles[0].colour[1], rgba(0, 255, 0));
    EXPECT_EQ(sink.triangles[0].colour[2], rgba(0, 0, 255));
}

TEST(GltfReader, TexturesAreFilteredBetweenLinearValuesAndWrappedAsTheSamplerSays) {
    TempFolder folder;
    // Between red and green; left of the image by half a pixel; a whole image to the left.
    const std::vector<float> uvs{0.5F, 0.25F, -0.25F, 0.25F, -0.75F, 0.25F};
    const auto colours = [&](const Json& sampler) {
        GltfBuilder file = textured(uvs, sampler);
        const CollectingSink sink = readAll(file.write(folder));
        const auto* first = sink.triangles.at(0).colour;
        return std::vector<uint32_t>(first, first + 3);
    };
    const uint32_t red = rgba(255, 0, 0), green = rgba(0, 255, 0), half = rgba(188, 188, 0);
    EXPECT_EQ(colours(Json::object()), (std::vector{half, green, red}));
    EXPECT_EQ(colours({{"wrapS", 33071}}), (std::vector{half, red, red}));
    EXPECT_EQ(colours({{"wrapS", 33648}}), (std::vector{half, red, green}));
    EXPECT_EQ(colours({{"magFilter", 9728}})[0], green);
}

TEST(GltfReader, TextureTransformsScaleTurnAndShift) {
    TempFolder folder;
    GltfBuilder file = textured({0.25F, 0.25F, 0.25F, 0.25F, 0.25F, 0.25F}, Json::object());
    const auto colour = [&](const char* transform) {
        file.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
                 ["KHR_texture_transform"] = Json::parse(transform);
        return readAll(file.write(folder)).triangles.at(0).colour[0];
    };
    EXPECT_EQ(colour(R"({"offset": [0.5, 0]})"), rgba(0, 255, 0));
    EXPECT_EQ(colour(R"({"scale": [1, 3]})"), rgba(0, 0, 255));
    // Counter-clockwise on the image by 90 degrees: (0.25, 0.25) goes to (0.25, -0.25).
    EXPECT_EQ(colour(R"({"rotation": 1.5707963267948966})"), rgba(0, 0, 255));
}

TEST(GltfReader, SpecularGlossinessGivesItsDiffuseColour) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.primitive()["material"] = 0;
    file.root["materials"] = Json::parse(R"([{"name": "old",
        "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]},
        "extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.25, 1, 1]}}}])");
    CollectingSink sink = readAll(file.write(folder));
    EXPECT_EQ(sink.materials.at(0).colour, rgba(188, 137, 255));
    EXPECT_EQ(sink.materials.at(0).name, "old");
    file.root["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = Json::object();
    sink = readAll(file.write(folder));
    EXPECT_EQ(sink.materials.at(0).colour, rgba(255, 255, 255));
}

TEST(GltfReader, PointsAndLinesAndMasksAreCountedAsIgnored) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.primitive()["material"] = 0;
    file.root["materials"] = Json::parse(R"([{"alphaMode": "MASK"}])");
    Json& primitives = file.root["meshes"][0]["primitives"];
    for (const int mode : {0, 1, 3}) {
        primitives.push_back(primitives[0]);
        primitives.back()["mode"] = mode;
    }
    const CollectingSink sink = readAll(file.write(folder));
    EXPECT_EQ(sink.triangles.size(), 1u);
    EXPECT_EQ(sink.ignoredThings.at("point primitive"), 1u);
    EXPECT_EQ(sink.ignoredThings.at("line primitive"), 2u);
    EXPECT_EQ(sink.ignoredThings.at("alpha mask (drawn opaque)"), 1u);
    EXPECT_FALSE(sink.materials.at(0).isTranslucent);
}

// Triangles each turned to begin at its least corner: the index codec turns them as it likes.
std::vector<std::vector<double>> startingAtLeast(const CollectingSink& sink) {
    std::vector<std::vector<double>> triangles;
    for (const CollectedTriangle& t : sink.triangles) {
        std::vector<std::vector<double>> corners;
        for (const Vec3d& p : t.corner) corners.push_back({p.x, p.y, p.z});
        std::ranges::rotate(corners, std::ranges::min_element(corners));
        triangles.emplace_back();
        for (const auto& corner : corners) {
            triangles.back().insert(triangles.back().end(), corner.begin(), corner.end());
        }
    }
    return triangles;
}

// Two copies of a model: once packed by meshopt, once as the fallback beside it.
TEST(GltfReader, MeshoptViewsHoldWhatTheirFallbackHolds) {
    PAGODA_REQUIRE_TEST_DATA();
    for (const std::string kind : {"ext", "khr"}) {
        const auto from = testData() / "zoo/gltf" / (kind + "-meshopt-fallback");
        TempFolder folder;
        for (const char* name : {"meshopt-fallback.bin", "meshopt-fallback.fallback.bin"}) {
            folder.write(name, contentsOf(from / name));
        }
        Json plain = Json::parse(contentsOf(from / "meshopt-fallback.gltf"));
        for (Json& view : plain["bufferViews"]) view.erase("extensions");
        const CollectingSink expected = readAll(folder.write("plain.gltf", plain.dump()));
        const CollectingSink packed = readAll(from / "meshopt-fallback.gltf");
        ASSERT_EQ(packed.triangles.size(), 60u);
        ASSERT_EQ(expected.triangles.size(), 60u);
        EXPECT_EQ(startingAtLeast(packed), startingAtLeast(expected));
    }
}

TEST(GltfReader, PackedAndPlainDucksHaveTheSameShapeAndColours) {
    PAGODA_REQUIRE_TEST_DATA();
    const auto from = testData() / "zoo/gltf/meshopt-duck";
    const CollectingSink plain = readAll(from / "Duck.glb");
    const CollectingSink packed = readAll(from / "Duck-vp-15-vt-15-vn-15.glb");
    ASSERT_EQ(plain.triangles.size(), packed.triangles.size());
    const double size = glm::distance(plain.box().min, plain.box().max);
    EXPECT_LT(glm::distance(plain.box().min, packed.box().min), 1e-3 * size);
    EXPECT_LT(glm::distance(plain.box().max, packed.box().max), 1e-3 * size);
    EXPECT_NEAR(packed.area() / plain.area(), 1, 1e-3);
    const auto meanGreen = [](const CollectingSink& sink) {
        double sum = 0;
        for (const CollectedTriangle& t : sink.triangles) sum += t.colour[0] >> 8 & 255;
        return sum / static_cast<double>(sink.triangles.size());
    };
    // Textured through KHR_texture_transform, which undoes the packing of the coordinates.
    EXPECT_NEAR(meanGreen(plain), meanGreen(packed), 2);
}

TEST(GltfReader, WebpAndPngOfOnePictureGiveNearlyTheSameColours) {
    PAGODA_REQUIRE_TEST_DATA();
    const auto from = testData() / "zoo/gltf/webp/CesiumBoxWebp-WithFallbackPNG.gltf";
    Json plain = Json::parse(contentsOf(from));
    for (Json& texture : plain["textures"]) texture.erase("extensions");
    TempFolder folder;
    const CollectingSink png = readAll(folder.write("png.gltf", plain.dump()));
    const CollectingSink webp = readAll(from);
    EXPECT_TRUE(webp.ignoredThings.empty());
    ASSERT_EQ(png.triangles.size(), webp.triangles.size());
    for (size_t i = 0; i < png.triangles.size(); ++i) {
        for (const int shift : {0, 8, 16}) {
            EXPECT_NEAR(png.triangles[i].colour[0] >> shift & 255,
                        webp.triangles[i].colour[0] >> shift & 255, 24);
        }
    }
}

TEST(GltfReader, WithoutScenesTheRootsAreDrawnAndADefaultSceneWins) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.root["nodes"] = Json::parse(
        R"([{"mesh": 0}, {"mesh": 0, "translation": [1, 0, 0]}, {"mesh": 0, "translation": [2, 0, 0]}])");
    file.root["scenes"] = Json::parse(R"([{"nodes": [0]}, {"nodes": [1, 2]}])");
    file.root["scene"] = 1;
    EXPECT_EQ(readAll(file.write(folder)).triangles.size(), 2u);
    file.root.erase("scene");
    EXPECT_EQ(readAll(file.write(folder)).triangles.size(), 1u);
    file.root.erase("scenes");
    EXPECT_EQ(readAll(file.write(folder)).triangles.size(), 3u);
}

TEST(GltfReader, TheCopyrightIsTheAttributionAndYIsUp) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.root["asset"]["copyright"] = "someone";
    const auto reader = openReader(file.write(folder), {});
    EXPECT_EQ(reader->attribution(), "someone");
    EXPECT_EQ(reader->upAxis(), UpAxis::Y);
}

}  // namespace
}  // namespace pagoda::ooc::test
