#include "hlod/build/build.h"

#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "tests/hlod/build/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace pagoda::hlod {
namespace {

using test::TemporaryFolder;

BuildOptions optionsFor(const std::filesystem::path& input, const std::filesystem::path& target) {
    BuildOptions options;
    options.inputs = expandInputs({input.string()});
    options.target = target;
    options.threads = 1;
    return options;
}

BuildReport build(const BuildOptions& options) {
    Progress progress;
    return buildDatabase(options, progress);
}

std::vector<std::byte> bytesOf(const std::filesystem::path& path) {
    return readWholeFile(path, 1u << 30);
}

struct Node {
    ooc::NodeRecord record;
    std::vector<size_t> children;
    ooc::PageMesh mesh;
};

// The whole tree in memory, children after parents.
std::vector<Node> loadTree(const ooc::Database& database) {
    std::vector<Node> nodes;
    std::map<uint64_t, size_t> places;
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& record, ooc::NodeRef) {
            auto page = database.readPage(record);
            EXPECT_TRUE(page.value) << page.fault;
            places[record.id.value] = nodes.size();
            nodes.push_back({record, {}, std::move(page.value->mesh)});
            if (record.id != ooc::NodeId::root()) {
                nodes[places.at(record.id.parent().value)].children.push_back(nodes.size() - 1);
            }
            return true;
        },
        [](uint32_t block, const std::string& fault) { ADD_FAILURE() << block << ": " << fault; });
    return nodes;
}

using Point = std::array<int32_t, 3>;

// Directed edges by lattice position: +1 one way, -1 the other. A closed, consistently wound
// surface sums to 0.
void addEdges(const ooc::PageMesh& mesh, std::map<std::pair<Point, Point>, int>& sums) {
    const auto point = [&](size_t corner) {
        const Vec3i& p = mesh.positions[mesh.indices[corner]];
        return Point{p.x, p.y, p.z};
    };
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        for (size_t k = 0; k < 3; ++k) {
            const Point a = point(i + k), b = point(i + (k + 1) % 3);
            if (a < b) ++sums[{a, b}];
            if (b < a) --sums[{b, a}];
        }
    }
}

size_t openEdges(const std::vector<Node>& nodes, const std::vector<size_t>& cut) {
    std::map<std::pair<Point, Point>, int> sums;
    for (const size_t node : cut) addEdges(nodes[node].mesh, sums);
    return static_cast<size_t>(
        std::count_if(sums.begin(), sums.end(), [](const auto& edge) { return edge.second != 0; }));
}

TEST(Build, aClosedSurfaceIsClosedAtEveryMixedCut) {
    const TemporaryFolder folder;
    writePly(test::roughTorus(300, 120), folder / "torus.ply");
    BuildOptions options = optionsFor(folder / "torus.ply", folder / "torus.pagoda");
    options.nodeTriangles = 1024;
    const BuildReport report = build(options);
    EXPECT_EQ(report.triangles, 72000u);
    EXPECT_GT(report.levels.size(), 3u);

    const ooc::Database database = ooc::Database::open(folder / "torus.pagoda");
    const std::vector<Node> nodes = loadTree(database);
    std::mt19937 random(5);
    std::vector<size_t> sizes;
    for (int round = 0; round < 60; ++round) {
        std::vector<size_t> cut, open = {0};
        bool anySloppy = false;
        while (!open.empty()) {
            const size_t node = open.back();
            open.pop_back();
            const bool refine = !nodes[node].children.empty() && random() % 5 != 0;
            if (refine) {
                open.insert(open.end(), nodes[node].children.begin(), nodes[node].children.end());
            } else {
                anySloppy |= (nodes[node].record.flags & ooc::kNodeSloppy) != 0;
                cut.push_back(node);
            }
        }
        sizes.push_back(cut.size());
        if (anySloppy) continue;
        ASSERT_EQ(openEdges(nodes, cut), 0u) << "cut of " << cut.size() << " nodes";
    }
    EXPECT_GT(*std::max_element(sizes.begin(), sizes.end()), 20u);
    EXPECT_EQ(report.sloppyNodes, 0u) << "a smooth torus needs no clustering";
}

TEST(Build, parentsContainChildrenAndErrorsGrowUpwards) {
    const TemporaryFolder folder;
    writePly(test::roughTorus(200, 100), folder / "torus.ply");
    (void)build(optionsFor(folder / "torus.ply", folder / "torus.pagoda"));
    const ooc::Database database = ooc::Database::open(folder / "torus.pagoda");
    const std::vector<Node> nodes = loadTree(database);
    uint64_t leafTriangles = 0;
    for (const Node& node : nodes) {
        EXPECT_LE(node.mesh.triangleCount(), 4096u);
        EXPECT_TRUE(node.record.box.contains(node.mesh.box()));
        for (const size_t child : node.children) {
            EXPECT_TRUE(node.record.box.contains(nodes[child].record.box));
            EXPECT_GE(node.record.errorModelUnits, nodes[child].record.errorModelUnits);
        }
        if (node.children.empty()) leafTriangles += node.mesh.triangleCount();
    }
    EXPECT_EQ(leafTriangles, 40000u);
}

TEST(Build, theBytesDoNotDependOnThreadsMemoryOrRepetition) {
    const TemporaryFolder folder;
    writePly(test::roughTorus(400, 200), folder / "torus.ply");
    BuildOptions options = optionsFor(folder / "torus.ply", folder / "a.pagoda");
    (void)build(options);
    const std::vector<std::byte> first = bytesOf(folder / "a.pagoda");
    options.threads = 2;
    options.memoryBytes = uint64_t{4} << 30;
    options.target = folder / "b.pagoda";
    (void)build(options);
    EXPECT_TRUE(first == bytesOf(folder / "b.pagoda"));
    options.memoryBytes = kMinMemoryBytes;
    options.target = folder / "c.pagoda";
    (void)build(options);
    EXPECT_TRUE(first == bytesOf(folder / "c.pagoda"));
}

TEST(Build, badTrianglesAreDroppedByReasonAndTheRestIsKept) {
    const TemporaryFolder folder;
    test::Mesh mesh = test::roughTorus(20, 20);
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    mesh.positions.emplace_back(NAN, 0, 0);
    mesh.triangles.push_back({0, 1, first});       // not finite
    mesh.triangles.push_back({0, 1, 1});           // no area
    mesh.triangles.push_back({0, 1, first + 99});  // no such vertex
    writePly(mesh, folder / "bad.ply");
    const BuildReport report = build(optionsFor(folder / "bad.ply", folder / "bad.pagoda"));
    EXPECT_EQ(report.triangles, 800u);
    EXPECT_EQ(report.trianglesIn, 803u);
    uint64_t dropped = 0;
    for (const auto& [reason, count] : report.dropped) dropped += count;
    EXPECT_EQ(dropped, 3u);
    EXPECT_EQ(report.dropped.size(), 3u);
}

TEST(Build, oneStrayVertexFarAwayDoesNotFlattenTheModel) {
    const TemporaryFolder folder;
    test::Mesh mesh = test::roughTorus(200, 100);
    mesh.positions.emplace_back(30000, 0, 0);
    mesh.triangles.push_back({0, 1, static_cast<uint32_t>(mesh.positions.size() - 1)});
    writePly(mesh, folder / "stray.ply");
    const BuildReport report = build(optionsFor(folder / "stray.ply", folder / "stray.pagoda"));
    EXPECT_GE(report.triangles, 40001u * 999 / 1000);
}

TEST(Build, outliersThatNoLatticeCanSpanAreRefusedAndNothingIsLeft) {
    const TemporaryFolder folder;
    test::Mesh mesh = test::roughTorus(200, 100);
    mesh.positions.emplace_back(1e12, 0, 0);
    mesh.triangles.push_back({0, 1, static_cast<uint32_t>(mesh.positions.size() - 1)});
    writePly(mesh, folder / "stray.ply");
    EXPECT_THROW((void)build(optionsFor(folder / "stray.ply", folder / "stray.pagoda")), Error);
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / ".")) {
        (void)entry;
        ++files;
    }
    EXPECT_EQ(files, 1u) << "only the input";
}

TEST(Build, coincidentTrianglesBeyondANodesBudgetAreCutIntoExtraLeaves) {
    const TemporaryFolder folder;
    test::Mesh mesh = test::roughTorus(10, 10);
    for (int i = 0; i < 3000; ++i) mesh.triangles.push_back({0, 1, 12});
    writePly(mesh, folder / "same.ply");
    BuildOptions options = optionsFor(folder / "same.ply", folder / "same.pagoda");
    options.nodeTriangles = 500;
    const BuildReport report = build(options);
    EXPECT_EQ(report.triangles, 3200u);
    const ooc::Database database = ooc::Database::open(folder / "same.pagoda");
    for (const Node& node : loadTree(database)) {
        if (!node.children.empty()) continue;
        EXPECT_LE(node.mesh.triangleCount(), 500u);
    }
}

TEST(Build, anExistingTargetNeedsForce) {
    const TemporaryFolder folder;
    writePly(test::roughTorus(10, 10), folder / "torus.ply");
    BuildOptions options = optionsFor(folder / "torus.ply", folder / "torus.pagoda");
    (void)build(options);
    const std::vector<std::byte> before = bytesOf(folder / "torus.pagoda");
    EXPECT_THROW((void)build(options), Error);
    EXPECT_TRUE(before == bytesOf(folder / "torus.pagoda"));
    options.force = true;
    EXPECT_NO_THROW((void)build(options));
}

}  // namespace
}  // namespace pagoda::hlod
