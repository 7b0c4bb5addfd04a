#include "ooc/readers/reader_extras.h"
#include "ooc/readers/scattered_order.h"
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/test_files.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace pagoda::ooc::test {
namespace {

const auto kNever = [] { return false; };

// A strip of `faces` cells of `corners` corners along x, one vertex column after the other.
struct Strip {
    uint64_t faces = 5000;
    int corners = 3;
    bool isBig = false, areFacesFirst = false;
    bool hasVertexColours = false, hasFaceColours = false;
    int oddFace = -1;  // gets another number of corners

    [[nodiscard]] std::string ply() const {
        const uint64_t columns = faces / (corners == 3 ? 2 : 1) + 2;
        const std::string vertexHeader =
            "element vertex " + std::to_string(2 * columns) +
            "\nproperty uchar flag\nproperty float x\nproperty double y\nproperty short z\n" +
            (hasVertexColours ? "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                              : "");
        const std::string faceHeader =
            "element face " + std::to_string(faces) +
            "\nproperty short group\nproperty list uchar uint vertex_indices\n" +
            (hasFaceColours ? "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                            : "");
        std::string vertexBytes, faceBytes;
        for (uint64_t i = 0; i < 2 * columns; ++i) {
            vertexBytes += '\7' + bytesOf(static_cast<float>(i / 2), isBig) +
                           bytesOf(static_cast<double>(i % 2), isBig) +
                           bytesOf(static_cast<int16_t>(i / 64), isBig);
            if (hasVertexColours) vertexBytes += {char(i), char(i >> 8), '\x21'};
        }
        for (uint64_t i = 0; i < faces; ++i) {
            const auto a = static_cast<uint32_t>(corners == 3 ? i : 2 * i);
            faceBytes += bytesOf(static_cast<int16_t>(5), isBig);
            const int own = static_cast<int>(i) == oddFace ? corners + 1 : corners;
            faceBytes += static_cast<char>(own);
            for (int k = 0; k < own; ++k) {
                constexpr std::array<uint32_t, 3> kTriangle = {0, 1, 2};
                constexpr std::array<uint32_t, 5> kAround = {0, 1, 3, 2, 0};
                const auto corner = static_cast<size_t>(k);
                faceBytes += bytesOf(a + (own == 3 ? kTriangle[corner] : kAround[corner]), isBig);
            }
            if (hasFaceColours) faceBytes += {char(i), char(i >> 8), '\x42'};
        }
        std::string file = std::string("ply\nformat binary_") + (isBig ? "big" : "little") +
                           "_endian 1.0\nelement other 3\nproperty int a\n";
        file += areFacesFirst ? faceHeader + vertexHeader : vertexHeader + faceHeader;
        file += "end_header\n" + std::string(12, 'x');
        return file + (areFacesFirst ? faceBytes + vertexBytes : vertexBytes + faceBytes);
    }
};

bool sampleInto(CollectingSink& sink, const std::filesystem::path& path, uint64_t triangles,
                const std::function<bool()>& isEnough = kNever) {
    const auto reader = openReader(path, {});
    auto* const sampled = dynamic_cast<SampledReader*>(reader.get());
    return sampled != nullptr && sampled->sample(sink, triangles, isEnough);
}

// Order and normals aside: what a sample says of a triangle.
auto keyOf(const CollectedTriangle& t) {
    const auto corner = [&](size_t k) {
        return std::tuple(t.corner[k].x, t.corner[k].y, t.corner[k].z, t.colour[k]);
    };
    return std::tuple(corner(0), corner(1), corner(2));
}
auto sortedKeys(const CollectingSink& sink) {
    std::vector<decltype(keyOf(sink.triangles[0]))> keys;
    for (const CollectedTriangle& triangle : sink.triangles) keys.push_back(keyOf(triangle));
    std::sort(keys.begin(), keys.end());
    return keys;
}

TEST(ScatteredOrder, VisitsEachNumberOnceAndEarlyOnesLieAllOver) {
    for (const uint64_t count : {uint64_t{0}, uint64_t{1}, uint64_t{2}, uint64_t{1000},
                                 uint64_t{4096}, uint64_t{100'003}}) {
        std::vector<int> visits(count);
        std::array<int, 10> tenths{};
        ScatteredOrder order(count);
        uint64_t index = 0, step = 0;
        for (; order.next(index); ++step) {
            ASSERT_LT(index, count);
            ++visits[index];
            if (step < count / 10) ++tenths[index * 10 / count];
        }
        EXPECT_EQ(step, count);
        EXPECT_TRUE(std::ranges::all_of(visits, [](int n) { return n == 1; })) << count;
        if (count < 1000) continue;
        for (const int hits : tenths) EXPECT_GT(hits, static_cast<int>(count / 200)) << count;
    }
}

TEST(PlySampler, ASampleOfEverythingIsWhatAReadingDelivers) {
    const TempFolder folder;
    for (const int corners : {3, 4}) {
        for (int variant = 0; variant < 16; ++variant) {
            const Strip strip{.corners = corners,
                              .isBig = (variant & 1) != 0,
                              .areFacesFirst = (variant & 2) != 0,
                              .hasVertexColours = (variant & 4) != 0,
                              .hasFaceColours = (variant & 8) != 0};
            const auto path = folder.write("a.ply", strip.ply());
            CollectingSink sample;
            ASSERT_TRUE(sampleInto(sample, path, 1'000'000)) << variant;
            const CollectingSink whole = readAll(path);
            ASSERT_EQ(whole.triangles.size(), strip.faces * static_cast<uint64_t>(corners - 2));
            EXPECT_EQ(sortedKeys(sample), sortedKeys(whole)) << variant;
        }
    }
}

TEST(PlySampler, ASmallSampleIsAPartThatLiesAllOverTheFile) {
    const TempFolder folder;
    const Strip strip{.faces = 2'000'000};  // below 250,000 whole blocks are taken
    const auto path = folder.write("a.ply", strip.ply());
    CollectingSink sample;
    ASSERT_TRUE(sampleInto(sample, path, 10'000));
    EXPECT_NEAR(static_cast<double>(sample.triangles.size()), 10'000, 1000);
    const auto some = sortedKeys(sample), all = sortedKeys(readAll(path));
    EXPECT_TRUE(std::ranges::includes(all, some));
    std::array<int, 10> tenths{};
    for (const CollectedTriangle& t : sample.triangles) {
        ++tenths[static_cast<size_t>(std::min(9.0, t.corner[0].x / 100'000.0))];
    }
    for (const int hits : tenths) EXPECT_GT(hits, 500);
}

TEST(PlySampler, EndsWhenItIsEnough) {
    const TempFolder folder;
    const auto path = folder.write("a.ply", Strip{.faces = 200'000}.ply());
    CollectingSink sample;
    int asked = 0;
    ASSERT_TRUE(sampleInto(sample, path, 1'000'000, [&] { return ++asked > 3; }));
    EXPECT_GT(sample.triangles.size(), 0u);
    EXPECT_LT(sample.triangles.size(), 2000u);
}

TEST(PlySampler, FacesOfDifferentSizesAndTextAreNotSampled) {
    const TempFolder folder;
    CollectingSink sink;
    EXPECT_FALSE(sampleInto(sink, folder.write("a.ply", Strip{.oddFace = 77}.ply()), 1000));
    EXPECT_FALSE(sampleInto(
        sink,
        folder.write("b.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                     "y\nproperty float z\nelement face 1\nproperty list uchar int vertex_index\n"
                     "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        1000));
    EXPECT_TRUE(sink.triangles.empty());
}

TEST(PlySampler, BadIndicesAreLeftOut) {
    const TempFolder folder;
    std::string file = Strip{.faces = 100}.ply();
    const uint32_t wild = 0xFFFFFFF0u;
    std::memcpy(file.data() + file.size() - sizeof wild, &wild, sizeof wild);
    CollectingSink sample;
    ASSERT_TRUE(sampleInto(sample, folder.write("a.ply", file), 1000));
    EXPECT_EQ(sample.triangles.size(), 99u);
}

TEST(StlSampler, ASampleOfEverythingIsWhatAReadingDelivers) {
    const TempFolder folder;
    constexpr uint32_t kFacets = 1000;
    std::string file(80, ' ');
    file += bytesOf(kFacets);
    for (uint32_t i = 0; i < kFacets; ++i) {
        for (int k = 0; k < 12; ++k) file += bytesOf(static_cast<float>(i * 12) + float(k * k));
        file += std::string(2, '\0');
    }
    const auto path = folder.write("a.stl", file);
    CollectingSink sample, part;
    ASSERT_TRUE(sampleInto(sample, path, 1'000'000));
    const auto all = sortedKeys(readAll(path));
    EXPECT_EQ(sortedKeys(sample), all);
    ASSERT_TRUE(sampleInto(part, path, 100));
    EXPECT_NEAR(static_cast<double>(part.triangles.size()), 100, 81);
    EXPECT_TRUE(std::ranges::includes(all, sortedKeys(part)));
}

TEST(Companions, AreTheFilesThatAModelNamesThereOrNot) {
    const TempFolder folder;
    folder.write("there.mtl", "newmtl a\nKd 1 0 0\n");
    const auto obj = folder.write("a.obj",
                                  "mtllib there.mtl\nmtllib not_there.mtl\nv 0 0 0\nv 1 0 0\n"
                                  "v 0 1 0\nf 1 2 3\n");
    const auto reader = openReader(obj, {});
    CollectingSink sink;
    reader->read(sink);
    const auto* const companions = dynamic_cast<const CompanionReader*>(reader.get());
    ASSERT_NE(companions, nullptr);
    const std::vector<std::filesystem::path> expected = {folder.path() / "not_there.mtl",
                                                         folder.path() / "there.mtl"};
    EXPECT_EQ(companions->companions(), expected);

    const auto gltf = folder.write(
        "a.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"uri":"a%20b.bin","byteLength":4},)"
                  R"({"uri":"data:application/octet-stream;base64,AAAA","byteLength":3}],)"
                  R"("images":[{"uri":"t/x.png"},{"uri":"http://example.org/y.png"}]})");
    const auto second = openReader(gltf, {});
    const auto* const beside = dynamic_cast<const CompanionReader*>(second.get());
    ASSERT_NE(beside, nullptr);
    const std::vector<std::filesystem::path> named = {folder.path() / "a b.bin",
                                                      folder.path() / "t/x.png"};
    EXPECT_EQ(beside->companions(), named);
}

}  // namespace
}  // namespace pagoda::ooc::test
