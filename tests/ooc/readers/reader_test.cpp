// What holds for every reader here: counts as stats.json has them, the same calls twice, malformed
// and cut files, files that change.
#include "ooc/readers/reader.h"

#include "ooc/base/error.h"
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/test_files.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <set>

namespace pagoda::ooc::test {
namespace {

bool isOurs(const std::string& name) {
    for (const char* extension : {".ply", ".obj", ".stl", ".STL", ".off"}) {
        if (name.ends_with(extension)) return true;
    }
    return false;
}

nlohmann::json statsOfModels() {
    return nlohmann::json::parse(contentsOf(testData() / "stats.json"));
}

TEST(Readers, DeliverAndDropAsManyTrianglesAsTheModelsHave) {
    PAGODA_REQUIRE_TEST_DATA();
    // Counted there as one stream of words; its lines hold more values than its header announces,
    // and read as lines, which PLY is made of, it holds the 1000 triangles of
    // zoo/obj/trimesh/fuze.obj.
    const std::string miscounted = "zoo/ply/fuze_ascii.ply";
    size_t count = 0;
    const nlohmann::json models = statsOfModels();
    for (const auto& [name, stats] : models.items()) {
        if (!isOurs(name) || name.starts_with("malformed/")) continue;
        const CollectingSink sink = readAll(testData() / name);
        EXPECT_EQ(sink.triangleCount(), name == miscounted ? 1000u : stats["tris"].get<uint64_t>())
            << name;
        EXPECT_LE(sink.advancedBytes, std::filesystem::file_size(testData() / name)) << name;
        ++count;
    }
    EXPECT_GT(count, 100u);
}

TEST(Readers, FindThePartsThatTheModelsHave) {
    PAGODA_REQUIRE_TEST_DATA();
    const nlohmann::json models = statsOfModels();
    for (const auto& [name, stats] : models.items()) {
        if (!isOurs(name) || name.starts_with("malformed/") || stats["tris"] == 0) continue;
        const CollectingSink sink = readAll(testData() / name);
        std::set<std::pair<uint32_t, uint32_t>> parts;
        for (const CollectedTriangle& t : sink.triangles) parts.insert({t.object, t.material});
        // Materials make parts in OBJ alone; a solid without a facet is one as well.
        const size_t found = name.ends_with(".obj") ? parts.size() : sink.objects.size();
        EXPECT_EQ(found, stats["parts"].get<size_t>()) << name;
    }
}

TEST(Readers, ReadTwoFormatsOfOneModelAlike) {
    PAGODA_REQUIRE_TEST_DATA();
    for (const auto& [first, second, tolerance] :
         {std::tuple{"geo/zurich-lod2.obj", "geo/zurich-lod2-double.ply", 1e-3},
          std::tuple{"zoo/stl/Spider_ascii.stl", "zoo/stl/Spider_binary.stl", 1e-4},
          std::tuple{"zoo/stl/test_sphere.stl", "zoo/stl/test_sphere_ascii.stl", 1e-4},
          std::tuple{"zoo/ply/fuze_ascii.ply", "zoo/obj/trimesh/fuze.obj", 1e-4},
          std::tuple{"zoo/obj/box.obj", "zoo/obj/box_UTF16BE.obj", 0.0}}) {
        const CollectingSink a = readAll(testData() / first), b = readAll(testData() / second);
        EXPECT_EQ(a.triangles.size(), b.triangles.size()) << first;
        EXPECT_NEAR(a.area(), b.area(), tolerance * a.area() + 1e-12) << first;
        EXPECT_LE(glm::length(a.box().min - b.box().min), tolerance * 10) << first;
        EXPECT_LE(glm::length(a.box().max - b.box().max), tolerance * 10) << first;
    }
}

TEST(Readers, SayTheSameASecondTime) {
    PAGODA_REQUIRE_TEST_DATA();
    for (const char* name :
         {"scan/igea-tristrips.ply", "scan/laurana-colour.ply", "zoo/ply/cube.ply",
          "zoo/obj/spider.obj", "zoo/obj/cube_with_vertexcolors.obj", "zoo/obj/box_UTF16BE.obj",
          "zoo/stl/Spider_ascii.stl", "zoo/stl/Wuson.stl", "zoo/off/comments.off",
          "malformed/obj/assimp-malformed.obj"}) {
        const auto reader = openReader(testData() / name, {});
        CollectingSink first, second;
        reader->read(first);
        reader->read(second);
        EXPECT_EQ(first.triangles, second.triangles) << name;
        EXPECT_EQ(first.batches, second.batches) << name;
        EXPECT_EQ(first.drops, second.drops) << name;
        EXPECT_EQ(first.ignoredThings, second.ignoredThings) << name;
        EXPECT_EQ(first.objects.size(), second.objects.size()) << name;
        EXPECT_EQ(first.materials.size(), second.materials.size()) << name;
    }
}

// Runs a read that may end in an Error, which must then name the file and a place in it.
void readOrRefuse(const std::filesystem::path& path) {
    try {
        (void)readAll(path);
    } catch (const Error& error) {
        EXPECT_EQ(error.path(), path.string());
        EXPECT_TRUE(error.place().starts_with("line ") || error.place().starts_with("byte "))
            << error.what();
        EXPECT_FALSE(error.problem().empty());
    }
}

TEST(Readers, RefuseOrMendMalformedModels) {
    PAGODA_REQUIRE_TEST_DATA();
    size_t models = 0;
    for (const char* folder : {"ply", "obj", "stl", "off"}) {
        for (const auto& entry :
             std::filesystem::directory_iterator(testData() / "malformed" / folder)) {
            SCOPED_TRACE(entry.path().string());
            readOrRefuse(entry.path());
            ++models;
        }
    }
    EXPECT_GT(models, 50u);
}

// Each kind once, small.
const std::vector<std::string>& smallModels() {
    static const std::vector<std::string> models = {
        "zoo/ply/cube.ply",
        "zoo/ply/cube_binary.ply",
        "zoo/ply/magnum-positions-colors4-normals-texcoords-float-indices-int-be-unaligned.ply",
        "zoo/ply/draco-delim_test.ply",
        "zoo/obj/cube_usemtl.obj",
        "zoo/obj/box_UTF16BE.obj",
        "zoo/stl/7_8ths_cube.stl",
        "zoo/stl/two_objects_mixed_case_names.stl",
        "zoo/off/chamfer-cube.off",
        "zoo/off/comments.off"};
    return models;
}

TEST(Readers, NeverCrashOnFilesCutShort) {
    PAGODA_REQUIRE_TEST_DATA();
    const TempFolder folder;
    for (const std::string& name : smallModels()) {
        const std::string whole = contentsOf(testData() / name);
        const uint64_t triangles = readAll(testData() / name).triangleCount();
        for (size_t size = 0; size < whole.size(); size += 97) {
            const auto path = folder.write("cut" + std::filesystem::path(name).extension().string(),
                                           std::string_view(whole).substr(0, size));
            SCOPED_TRACE(name + " cut to " + std::to_string(size));
            readOrRefuse(path);
            try {
                EXPECT_LE(readAll(path).triangleCount(), triangles);
            } catch (const Error&) {  // as it should
            }
        }
    }
}

TEST(Readers, NeverCrashOnFilesWithWrongBytes) {
    PAGODA_REQUIRE_TEST_DATA();
    const TempFolder folder;
    uint64_t seed = 3;
    for (const std::string& name : smallModels()) {
        const std::string whole = contentsOf(testData() / name);
        for (int round = 0; round < 100; ++round) {
            std::string bad = whole;
            for (int k = 0; k <= round % 4; ++k) {
                seed = seed * 6364136223846793005ull + 1442695040888963407ull;
                bad[(seed >> 16) % bad.size()] = static_cast<char>(seed >> 56);
            }
            SCOPED_TRACE(name + " round " + std::to_string(round));
            readOrRefuse(
                folder.write("bad" + std::filesystem::path(name).extension().string(), bad));
        }
    }
}

// Calls back with the first batch.
struct MeddlingSink : CollectingSink {
    std::function<void()> meddle;
    void addTriangles(const TriangleBatch& batch) override {
        if (meddle) meddle();
        meddle = nullptr;
        CollectingSink::addTriangles(batch);
    }
};

TEST(Readers, NoticeThatAFileIsWrittenWhileTheyRead) {
    PAGODA_REQUIRE_TEST_DATA();
    const TempFolder folder;
    for (const std::string& name : smallModels()) {
        const std::string whole = contentsOf(testData() / name);
        const std::string copyName = "copy" + std::filesystem::path(name).extension().string();
        const auto path = folder.write(copyName, whole);
        const auto reader = openReader(path, {});
        CollectingSink quiet;
        reader->read(quiet);
        folder.write(copyName, whole + "\n");
        CollectingSink late;
        EXPECT_THROW(reader->read(late), Error) << name;
    }
    for (const char* name : {"scan/nefertiti.obj", "scan/bunny-zipper-ascii.ply",
                             "scan/laurana-colour.ply", "zoo/stl/Wuson.stl", "zoo/off/ballA.off"}) {
        const std::string whole = contentsOf(testData() / name);
        const std::string copyName = "copy" + std::filesystem::path(name).extension().string();
        const auto path = folder.write(copyName, whole);
        MeddlingSink sink;
        sink.meddle = [&] { folder.write(copyName, whole.substr(0, whole.size() / 3)); };
        EXPECT_THROW(openReader(path, {})->read(sink), Error) << name;
    }
}

TEST(Readers, PickTheFormatByExtensionInAnyCase) {
    const TempFolder folder;
    const auto path = folder.write("A.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(readAll(path).triangles.size(), 1u);
}

TEST(Readers, NameAConverterForKindsTheyDoNotRead) {
    const TempFolder folder;
    for (const auto& [name, word] :
         {std::pair{"a.ifc", "IfcConvert"}, std::pair{"a.STEP", "FreeCAD"},
          std::pair{"a.laz", "mesh"}, std::pair{"a.fbx", ".glb"}, std::pair{"a.city.json", "cjio"},
          std::pair{"a.xkt", "IfcConvert"}, std::pair{"a.unheard", ".ply"},
          std::pair{"a", ".ply"}}) {
        try {
            (void)openReader(folder.write(name, "data"), {});
            FAIL() << name;
        } catch (const Error& error) {
            EXPECT_NE(error.remedy().find(word), std::string::npos) << error.what();
        }
    }
}

TEST(Readers, SayWhatIsWrongWithAPathThatIsNoFile) {
    const TempFolder folder;
    for (const char* extension : {".ply", ".obj", ".stl", ".off"}) {
        EXPECT_THROW((void)openReader(folder.path() / ("none" + std::string(extension)), {}),
                     Error);
        const auto directory = folder.path() / ("folder" + std::string(extension));
        std::filesystem::create_directory(directory);
        EXPECT_THROW((void)openReader(directory, {}), Error);
    }
}

TEST(Readers, EveryDropReasonHasAName) {
    std::set<std::string_view> names;
    for (size_t k = 0; k < static_cast<size_t>(DropReason::Count); ++k) {
        names.insert(dropReasonName(static_cast<DropReason>(k)));
    }
    EXPECT_EQ(names.size(), static_cast<size_t>(DropReason::Count));
}

}  // namespace
}  // namespace pagoda::ooc::test
