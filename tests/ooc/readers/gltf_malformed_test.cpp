#include "ooc/base/error.h"
#include "ooc/readers/gltf_reader.h"
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/gltf_builder.h"

#include <sys/stat.h>

#include <functional>

namespace pagoda::ooc::test {
namespace {

// The error that opening and reading ends with; a test fails where there is none.
Error refusal(const std::filesystem::path& path, const ReaderOptions& options = {}) {
    try {
        const CollectingSink sink = readAll(path, options);
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << path << " was read";
    return {"", "", "", ""};
}

// The refusal of a triangle whose JSON was changed.
Error refusalAfter(const std::function<void(GltfBuilder&)>& change,
                   const ReaderOptions& options = {}) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    change(file);
    return refusal(file.write(folder), options);
}

TEST(GltfMalformed, EveryFileIsRefusedWithAPlaceOrReadWithWhatWasLost) {
    PAGODA_REQUIRE_TEST_DATA();
    size_t files = 0, refused = 0;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(testData() / "malformed/gltf")) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".gltf" && extension != ".glb") continue;
        SCOPED_TRACE(entry.path().string());
        ++files;
        try {
            const auto reader = openReader(entry.path(), {});
            CollectingSink sink;
            reader->read(sink);
            EXPECT_EQ(sink.triangleCount(), reader->announcedTriangles());
        } catch (const Error& error) {
            ++refused;
            EXPECT_EQ(error.path(), entry.path().string());
            EXPECT_NE(error.place(), "");
            EXPECT_NE(error.problem(), "");
            EXPECT_NE(error.remedy(), "");
        }
    }
    EXPECT_EQ(files, 196u);
    EXPECT_GT(refused, 60u);
}

TEST(GltfMalformed, BadTrianglesAreDroppedByReasonAndTheRestIsRead) {
    PAGODA_REQUIRE_TEST_DATA();
    struct Case {
        const char* name;
        DropReason reason;
        uint64_t dropped, read;
    };
    for (const Case& known :
         {Case{"assimp/IndexOutOfRange/AllIndicesOutOfRange.gltf", DropReason::IndexOutOfRange, 12,
               0},
          Case{"assimp/IndexOutOfRange/IndexOutOfRange.gltf", DropReason::IndexOutOfRange, 1, 11},
          Case{"assimp/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", DropReason::NonFinite,
               12, 0},
          Case{"cesium/cubeSomeBadIndices.glb", DropReason::IndexOutOfRange, 4, 8}}) {
        CollectingSink sink = readAll(testData() / "malformed/gltf" / known.name);
        EXPECT_EQ(sink.drops[known.reason], known.dropped) << known.name;
        EXPECT_EQ(sink.triangles.size(), known.read) << known.name;
    }
}

TEST(GltfMalformed, NodesThatAreNoTreeAreRefused) {
    const Error cycle = refusalAfter([](GltfBuilder& file) {
        file.root["nodes"] = Json::parse(R"([{"children": [1]}, {"mesh": 0, "children": [0]}])");
    });
    EXPECT_EQ(cycle.place(), "nodes[0]");
    // Two parents each, 40 deep: 2^40 triangles if it were unfolded.
    const Error doubling = refusalAfter([](GltfBuilder& file) {
        file.root["nodes"] = Json::array();
        for (int i = 0; i < 40; ++i) file.root["nodes"].push_back({{"children", {i + 1, i + 1}}});
        file.root["nodes"].push_back({{"mesh", 0}});
    });
    EXPECT_NE(doubling.problem().find("reached twice"), std::string::npos);
}

TEST(GltfMalformed, AChainOfAHundredThousandNodesIsWalked) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.root["nodes"] = Json::array();
    constexpr int kNodes = 100000;
    for (int i = 0; i < kNodes; ++i) file.root["nodes"].push_back({{"children", {i + 1}}});
    file.root["nodes"].push_back({{"mesh", 0}});
    CollectingSink sink;
    openReader(file.write(folder), {})->read(sink);
    EXPECT_EQ(sink.objects.size(), kNodes + 1u);
    EXPECT_EQ(sink.triangles.size(), 1u);
}

TEST(GltfMalformed, TooManyTrianglesAreRefusedByTheirCount) {
    const Error error = refusalAfter([](GltfBuilder& file) {
        file.root["accessors"].push_back(
            {{"componentType", 5126}, {"type", "VEC3"}, {"count", 20000000000}});
        file.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = 1;
    });
    EXPECT_NE(error.problem().find("20000000000"), std::string::npos) << error.what();
    EXPECT_NE(error.problem().find("8589934592"), std::string::npos) << error.what();
}

TEST(GltfMalformed, AccessorsThatReachBeyondTheirViewAreRefused) {
    struct Case {
        const char* key;
        uint64_t value;
    };
    for (const Case& wrong : {Case{"count", 4}, Case{"byteOffset", 4},
                              Case{"byteOffset", 9007199254740992}, Case{"count", 300000000}}) {
        const Error error = refusalAfter(
            [&](GltfBuilder& file) { file.root["accessors"][0][wrong.key] = wrong.value; });
        EXPECT_EQ(error.place(),
                  wrong.value == 300000000 ? "meshes[0].primitives[0]" : "accessors[0]")
            << error.what();
    }
    const Error view = refusalAfter(
        [](GltfBuilder& file) { file.root["bufferViews"][0]["byteOffset"] = 9007199254740992; });
    EXPECT_EQ(view.place(), "bufferViews[0]");
}

TEST(GltfMalformed, MemoryIsRefusedBeforeItIsTaken) {
    // A vertex array without bytes behind it, of 12 GB.
    const Error error = refusalAfter([](GltfBuilder& file) {
        file.root["accessors"][0]["count"] = 1000000000;
        file.root["accessors"][0].erase("bufferView");
    });
    EXPECT_NE(error.problem().find("memory"), std::string::npos);
    // And of packed bytes that promise 4 GB.
    const Error packed = refusalAfter([](GltfBuilder& file) {
        file.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
            {"buffer", 0},
            {"byteLength", 36},
            {"byteStride", 12},
            {"count", 400000000},
            {"mode", "ATTRIBUTES"}};
    });
    EXPECT_NE(packed.problem().find("memory"), std::string::npos);
}

TEST(GltfMalformed, SparseIndicesMustRiseAndExist) {
    for (const std::vector<uint8_t>& indices : {std::vector<uint8_t>{2, 1}, {1, 1}, {1, 3}}) {
        const Error error = refusalAfter([&](GltfBuilder& file) {
            const size_t at = file.addView(indices);
            const size_t values = file.addView(std::vector<float>(6));
            file.root["accessors"][0]["sparse"] = {
                {"count", 2},
                {"indices", {{"bufferView", at}, {"componentType", 5121}}},
                {"values", {{"bufferView", values}}}};
        });
        EXPECT_EQ(error.place(), "accessors[0].sparse.indices");
    }
}

TEST(GltfMalformed, AShorterAttributeIsLeftOutAndCounted) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.primitive()["attributes"]["NORMAL"] = file.addFloats({0, 0, 1, 0, 0, 1}, 3);
    const CollectingSink sink = readAll(file.write(folder));
    EXPECT_EQ(sink.triangles.size(), 1u);
    EXPECT_EQ(sink.triangles[0].normal[0], Vec3f(0));
    EXPECT_EQ(sink.ignoredThings.at("vertex attribute shorter than the positions"), 1u);
}

TEST(GltfMalformed, UnknownRequiredExtensionsAreRefusedByName) {
    const Error error = refusalAfter([](GltfBuilder& file) {
        file.root["extensionsRequired"] = {"KHR_materials_unlit", "ACME_secret_mesh"};
    });
    EXPECT_NE(error.problem().find("ACME_secret_mesh"), std::string::npos);
}

TEST(GltfMalformed, NewerMeshoptStreamsAreNamedAsSuch) {
    const Error error = refusalAfter([](GltfBuilder& file) {
        const size_t view = file.addView(std::vector<uint8_t>(64, 0xA1));
        file.root["bufferViews"][0]["extensions"]["KHR_meshopt_compression"] = {
            {"buffer", 0},      {"byteOffset", file.root["bufferViews"][view]["byteOffset"]},
            {"count", 3},       {"byteLength", 64},
            {"byteStride", 12}, {"mode", "ATTRIBUTES"}};
    });
    EXPECT_NE(error.problem().find("version 1"), std::string::npos) << error.what();
}

TEST(GltfMalformed, OnlyRegularFilesBesideTheModelAreOpened) {
    TempFolder folder;
    ASSERT_EQ(mkfifo((folder.path() / "pipe.bin").c_str(), 0600), 0);
    for (const char* uri : {"pipe.bin", "/dev/zero", "../../../../../../../../dev/zero",
                            "file:///dev/zero", "https://example.org/a.bin", ".", "a%00b"}) {
        GltfBuilder file;
        file.setTriangle();
        (void)file.text();
        file.buffer.clear();  // keep the buffer below
        file.root["buffers"][0]["uri"] = uri;
        EXPECT_EQ(refusal(file.write(folder)).place().substr(0, 10), "buffers[0]") << uri;
    }
}

TEST(GltfMalformed, DeepNestingCostsNoStack) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    std::string text = file.text();
    const std::string deep = std::string(200000, '[') + std::string(200000, ']');
    text.insert(1, "\"extras\":" + deep + ",");
    EXPECT_EQ(readAll(folder.write("deep.gltf", text)).triangles.size(), 1u);
}

TEST(GltfMalformed, ANumberBeyondTheRangeOfADoubleIsNamedWithItsPlace) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    std::string text = file.text();
    text.insert(1, "\"extras\":-1e309,");
    const Error error = refusal(folder.write("number.gltf", text));
    EXPECT_EQ(error.place(), "byte 11 of the JSON");
    EXPECT_EQ(error.problem(), "-1e309 is beyond the range of a double");
}

TEST(GltfMalformed, MeshesThatTheSceneDoesNotShowAreCounted) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    file.root["meshes"].push_back(file.root["meshes"][0]);
    file.root["nodes"].push_back({{"mesh", 0}});  // drawn twice, counted once
    file.root["scenes"][0]["nodes"].push_back(1);
    const CollectingSink sink = readAll(file.write(folder));
    EXPECT_EQ(sink.triangles.size(), 2u);
    EXPECT_EQ(sink.ignoredThings.at("mesh that the scene does not show"), 1u);
}

TEST(GltfMalformed, AMissingOrBrokenTextureCostsTheTextureOnly) {
    TempFolder folder;
    // A PNG header of 30000 x 30000 pixels, a file that is not there, and no picture at all.
    constexpr const char* kHuge =
        "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAdTAAAHUwCAYAAABmJ/i6AAAACklEQVR42mNgAAAAAgAB"
        "5Sfe/AAAAABJRU5ErkJggg==";
    for (const char* uri : {kHuge, "missing.png", "data:image/png;base64,AAAA"}) {
        GltfBuilder file;
        file.setTriangle();
        file.primitive()["attributes"]["TEXCOORD_0"] = file.addFloats({0, 0, 0, 0, 0, 0}, 2);
        file.primitive()["material"] = 0;
        file.root["images"] = {{{"uri", uri}}};
        file.root["textures"] = {{{"source", 0}}};
        file.root["materials"] = {
            {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        const CollectingSink sink = readAll(file.write(folder));
        EXPECT_EQ(sink.triangles.size(), 1u);
        EXPECT_EQ(sink.ignoredThings.size(), 1u) << uri;
    }
}

TEST(GltfMalformed, AFileThatChangesBetweenTwoReadsIsRefused) {
    TempFolder folder;
    GltfBuilder file;
    file.setTriangle();
    folder.write("a.bin", file.buffer);
    file.root["buffers"] = {{{"uri", "a.bin"}, {"byteLength", file.buffer.size()}}};
    const std::string text = file.root.dump();
    const auto reader = openReader(folder.write("a.gltf", text), {});
    CollectingSink sink;
    reader->read(sink);
    folder.write("a.bin", file.buffer + "more");
    EXPECT_THROW(reader->read(sink), Error);
}

TEST(GltfMalformed, TransformsThatLeaveTheRangeOfNumbersDropTheirTriangles) {
    TempFolder folder;
    GltfBuilder file;
    file.setPositions({1, 0, 0, 2, 0, 0, 0, 1, 0});
    file.root["nodes"] = Json::parse(
        R"([{"scale": [1e300, 1, 1], "children": [1]}, {"scale": [1e10, 1, 1], "mesh": 0}])");
    const CollectingSink sink = readAll(file.write(folder));
    EXPECT_EQ(sink.triangles.size(), 0u);
    EXPECT_EQ(sink.drops.at(DropReason::NonFinite), 1u);
}

}  // namespace
}  // namespace pagoda::ooc::test
