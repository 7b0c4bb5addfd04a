// Seams close only if a lattice point that nodes share is drawn at the same bits by each of them:
// checked by transform feedback over random mixed cuts.
#include "tests/viewer/gl_fixture.h"
#include "tests/viewer/memory_scene.h"
#include "viewer/frame_target.h"
#include "viewer/mesh_store.h"
#include "viewer/node_drawer.h"

#include <epoxy/gl.h>

#include <array>
#include <cstring>
#include <random>
#include <unordered_map>

namespace pagoda::viewer {
namespace {

using test::MemoryScene;

class LatticeBitsTest : public GlTest {};

struct PointHash {
    size_t operator()(const Vec3i& p) const {
        const auto part = [](int32_t v) { return static_cast<uint64_t>(static_cast<uint32_t>(v)); };
        return static_cast<size_t>((part(p.x) * 0x9E3779B97F4A7C15ull) ^
                                   (part(p.y) * 0xC2B2AE3D27D4EB4Full) ^
                                   (part(p.z) * 0x165667B19E3779F9ull));
    }
};

struct Seen {
    std::array<uint32_t, 4> bits;
    int depth;
};

// A random cut: every node is refined with a chance of 2 in 3.
std::vector<const ooc::NodeRecord*> randomCut(const MemoryScene& scene, std::mt19937& random) {
    std::vector<const ooc::NodeRecord*> cut, pending{&scene.block.nodes.front()};
    while (!pending.empty()) {
        const ooc::NodeRecord* node = pending.back();
        pending.pop_back();
        if (node->isLeaf() || (node->id.depth() > 0 && random() % 3 == 0)) {
            cut.push_back(node);
            continue;
        }
        for (uint32_t i = 0; i < node->childCount(); ++i) {
            pending.push_back(&scene.block.nodes[node->childIndex + i]);
        }
    }
    return cut;
}

hlod::Camera randomCamera(std::mt19937& random, const Box3d& box) {
    std::uniform_real_distribution<double> share(-0.7, 1.7), unit(-1, 1);
    hlod::Camera camera;
    const Vec3d size = box.max - box.min;
    camera.eye = box.min + size * Vec3d(share(random), share(random), share(random));
    if (random() % 4 == 0) camera.eye += 40.0 * size * unit(random);  // beyond what 32 bits address
    camera.target = box.min + size * Vec3d(share(random), share(random), share(random));
    camera.up = {unit(random), unit(random), unit(random)};
    return camera;
}

TEST_F(LatticeBitsTest, SharedPointsHaveEqualBitsInAThousandMixedCuts) {
    ooc::Lattice lattice;
    lattice.origin = Vec3d(1e7, -3e6, 5e6);
    lattice.stepExponent = -23;
    lattice.extentBits = 30;
    MemoryScene scene = MemoryScene::make(lattice, test::bumpySphere(Vec3d(1 << 29), 4e8, 14), 40);
    MeshStore store(4 << 20);
    for (const ooc::NodeRecord& node : scene.block.nodes) {
        ASSERT_EQ(store.upload({0, node.id}, scene.pages.at(node.id)),
                  cache::GpuPages::Upload::Done);
    }
    const char* const captured[] = {"gl_Position"};
    NodeProgram program(captured);
    NodeDrawer drawer(store);
    constexpr size_t kMaxVertices = 20000;
    const GlBuffer feedback = makeBuffer();
    glNamedBufferStorage(feedback.id(), kMaxVertices * 16, nullptr, 0);
    FrameTarget target(8, 8);  // no draw without one, though nothing is rasterised
    target.begin({});
    glEnable(GL_RASTERIZER_DISCARD);

    std::mt19937 random(1);
    const Box3d box = lattice.toModel(scene.block.nodes.front().box);
    uint64_t shared = 0, sharedByLevels = 0, different = 0;
    for (int cutNumber = 0; cutNumber < 1000; ++cutNumber) {
        const auto cut = randomCut(scene, random);
        const hlod::View view(randomCamera(random, box), box);
        program.setView(makeLatticeView(view, lattice), {0, 0, 1});
        std::vector<DrawItem> items;
        std::vector<std::pair<Vec3i, int>> corners;  // and the depth of their node
        for (const ooc::NodeRecord* node : cut) {
            items.push_back({{0, node->id}, 1});
            const ooc::PageMesh& mesh = scene.pages.at(node->id).mesh;
            for (const uint32_t index : mesh.indices) {
                corners.emplace_back(mesh.positions[index], node->id.depth());
            }
        }
        ASSERT_LE(corners.size(), kMaxVertices);
        drawer.bind(program, makeLatticeView(view, lattice));
        glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, feedback.id());
        glBeginTransformFeedback(GL_TRIANGLES);
        drawer.drawOpaque(items);
        glEndTransformFeedback();
        std::vector<std::array<uint32_t, 4>> drawn(corners.size());
        glGetNamedBufferSubData(feedback.id(), 0, static_cast<GLsizeiptr>(drawn.size() * 16),
                                drawn.data());

        std::unordered_map<Vec3i, Seen, PointHash> points;
        for (size_t i = 0; i < corners.size(); ++i) {
            const auto [at, isNew] =
                points.emplace(corners[i].first, Seen{drawn[i], corners[i].second});
            if (isNew) continue;
            ++shared;
            if (at->second.depth != corners[i].second) ++sharedByLevels;
            if (at->second.bits != drawn[i]) ++different;
        }
    }
    glDisable(GL_RASTERIZER_DISCARD);
    throwOnGlError("transform feedback");
    EXPECT_EQ(different, 0u);
    EXPECT_GT(sharedByLevels, 100000u);
    RecordProperty("shared", std::to_string(shared));
    RecordProperty("sharedByLevels", std::to_string(sharedByLevels));
}

}  // namespace
}  // namespace pagoda::viewer
