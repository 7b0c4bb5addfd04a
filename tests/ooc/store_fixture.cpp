#include "tests/ooc/store_fixture.h"

#include "ooc/store/triangle_sum.h"

#include <unistd.h>

#include <algorithm>
#include <string>

namespace pagoda::ooc::test {
namespace {

int32_t below(std::mt19937& random, int64_t limit) {
    return static_cast<int32_t>(random() % static_cast<uint64_t>(limit));
}

void addVertex(std::mt19937& random, const MeshOptions& options, PageMesh& mesh) {
    const auto point = [&](int axis) {
        return options.origin[axis] + below(random, int64_t{options.extent} + 1);
    };
    mesh.positions.emplace_back(point(0), point(1), point(2));
    if (options.hasColours) mesh.colours.push_back(static_cast<uint32_t>(random()));
    if (options.hasNormals) {
        mesh.normals.push_back({static_cast<int8_t>(below(random, 255) - 127),
                                static_cast<int8_t>(below(random, 256) - 128)});
    }
}

// Three different vertices, most of them used before.
void addTriangle(std::mt19937& random, const MeshOptions& options, PageMesh& mesh) {
    uint32_t corners[3];
    for (int i = 0; i < 3; ++i) {
        const bool isNew = mesh.vertexCount() < 3 || random() % 5 < 2;
        if (isNew) addVertex(random, options, mesh);
        do {
            corners[i] = isNew ? mesh.vertexCount() - 1
                               : static_cast<uint32_t>(below(random, mesh.vertexCount()));
        } while (!isNew && std::find(corners, corners + i, corners[i]) != corners + i);
    }
    mesh.indices.insert(mesh.indices.end(), corners, corners + 3);
}

struct Builder {
    std::mt19937 random;
    DatabaseOptions options;
    DatabaseWriter& writer;
    DatabaseWriter::Content content;

    NodeRecord finish(NodeRecord node, const PageMesh& mesh) {
        const std::vector<std::byte> bytes = encodePage({mesh, {}}, options.codec);
        node.pageOffset = writer.addPage(bytes);
        node.pageBytes = static_cast<uint32_t>(bytes.size());
        node.pageChecksum = hash64(bytes);
        node.triangleCount = mesh.triangleCount();
        node.opaqueTriangleCount = mesh.opaqueTriangleCount();
        node.vertexCount = mesh.vertexCount();
        node.flags = static_cast<uint16_t>(
            (mesh.colours.empty() ? 0 : kNodeHasColours) |
            (mesh.normals.empty() ? 0 : kNodeHasNormals) |
            (mesh.opaqueTriangleCount() < mesh.triangleCount() ? kNodeHasTranslucent : 0));
        node.box.extend(mesh.box());
        return node;
    }

    NodeRecord leaf(NodeId id) {
        const PageMesh mesh = randomMesh(
            random, {.triangleCount = options.leafTriangles, .objectCount = 3, .materialCount = 1});
        NodeRecord node = finish({.id = id}, mesh);
        node.subtreeTriangles = mesh.triangleCount();
        size_t triangle = 0;
        for (const MeshRun& run : mesh.runs) {
            for (uint32_t t = 0; t < run.triangleCount; ++t, ++triangle) {
                const uint32_t* corner = mesh.indices.data() + 3 * triangle;
                ooc::addTriangle(content.header.triangleSum, mesh.positions[corner[0]],
                                 mesh.positions[corner[1]], mesh.positions[corner[2]], run.object,
                                 run.material);
                ObjectRecord& object = content.objects[run.object];
                ++object.triangleCount;
                for (int i = 0; i < 3; ++i) object.box.extend(mesh.positions[corner[i]]);
            }
        }
        return node;
    }

    // Depth first: the children, then the node itself, whose record goes before theirs.
    NodeRecord subtree(NodeId id, uint32_t levels, std::vector<std::vector<NodeRecord>>& families) {
        if (levels == 0) return leaf(id);
        std::vector<NodeRecord> children;
        NodeRecord node{.id = id};
        for (uint32_t k = 0; k < options.childrenPerNode; ++k) {
            node.childMask = static_cast<uint16_t>(node.childMask | (1u << k));
            children.push_back(subtree(id.child(k), levels - 1, families));
        }
        if (options.hasExtraLeaf && id == NodeId::root()) {
            node.childMask = static_cast<uint16_t>(node.childMask | (1u << 8));
            children.push_back(leaf(id.extra(1)));
        }
        for (const NodeRecord& child : children) {
            node.box.extend(child.box);
            node.subtreeTriangles += child.subtreeTriangles;
            node.errorModelUnits = std::max(node.errorModelUnits, 2 * child.errorModelUnits + 0.25);
        }
        MeshOptions coarse{.triangleCount = 4, .objectCount = 3, .materialCount = 1};
        node = finish(node, randomMesh(random, coarse));
        families.push_back(std::move(children));
        return node;
    }
};

}  // namespace

PageMesh randomMesh(std::mt19937& random, const MeshOptions& options) {
    PageMesh mesh;
    mesh.constantColour = options.hasColours ? 0xFFFFFFFFu : static_cast<uint32_t>(random());
    std::array<uint32_t, kPageParts> inPart{};
    for (uint32_t t = 0; t < options.triangleCount; ++t) {
        ++inPart[random() % (options.hasTranslucent ? 16 : 8)];
    }
    for (size_t part = 0; part < kPageParts; ++part) {
        for (uint32_t rest = inPart[part]; rest > 0;) {
            const uint32_t count = 1 + static_cast<uint32_t>(random()) % rest;
            MeshRun run{count, static_cast<uint32_t>(below(random, options.objectCount)),
                        static_cast<uint32_t>(below(random, options.materialCount))};
            if (options.materialCount == 1) run.material = part < 8 ? 0 : 1;
            mesh.runs.push_back(run);
            for (uint32_t t = 0; t < count; ++t) addTriangle(random, options, mesh);
            rest -= count;
        }
        mesh.partStart[part + 1] = mesh.partStart[part] + inPart[part];
    }
    return mesh;
}

std::vector<TriangleKey> sortedTriangles(const PageMesh& mesh) {
    std::vector<TriangleKey> keys;
    uint32_t run = 0, inRun = 0, part = 0;
    for (uint32_t t = 0; t < mesh.triangleCount(); ++t, ++inRun) {
        for (; inRun == mesh.runs[run].triangleCount; inRun = 0) ++run;
        while (t >= mesh.partStart[part + 1]) ++part;
        std::array<Corner, 3> corners;
        for (uint32_t i = 0; i < 3; ++i) {
            const uint32_t v = mesh.indices[3 * t + i];
            const Vec3i& p = mesh.positions[v];
            const OctNormal n = mesh.normals.empty() ? OctNormal{} : mesh.normals[v];
            corners[i] = {p.x, p.y, p.z, mesh.colours.empty() ? 0 : mesh.colours[v], n.u, n.v};
        }
        std::array<Corner, 3> least = corners;
        for (int turn = 0; turn < 2; ++turn) {
            std::rotate(corners.begin(), corners.begin() + 1, corners.end());
            least = std::min(least, corners);
        }
        keys.emplace_back(part, run, least);
    }
    std::sort(keys.begin(), keys.end());
    return keys;
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "pagoda-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
}

DatabaseWriter::Content writeDatabase(const std::filesystem::path& path,
                                      const DatabaseOptions& options) {
    DatabaseWriter writer(path, false, 0);
    Builder builder{std::mt19937(options.seed), options, writer, {}};
    DatabaseWriter::Content& content = builder.content;
    content.objects = {
        {.name = "house"}, {.name = "wall", .parent = 0}, {.name = "window", .parent = 0}};
    content.materials = {{.name = "brick", .colour = 0xFF2030A0u},
                         {.name = "glass", .colour = 0x80FFFFFFu, .isTranslucent = true}};
    content.metadataJson = R"({"sources":[{"path":"house.obj","format":"OBJ"}],"up":"z"})";
    content.header.lattice = {.origin = {-1.0, 2.0, 0.5}, .stepExponent = -3, .extentBits = 10};
    content.header.codec = options.codec;
    content.header.levelCount = options.depth + 1;
    content.header.nodeTriangles = 100;

    std::vector<std::vector<NodeRecord>> families;
    content.nodes = {builder.subtree(NodeId::root(), options.depth, families)};
    content.header.triangleCount = content.nodes[0].subtreeTriangles;
    for (auto family = families.rbegin(); family != families.rend(); ++family) {
        content.nodes.insert(content.nodes.end(), family->begin(), family->end());
    }
    if (options.spoil) options.spoil(content);
    writer.publish(content);
    return content;
}

}  // namespace pagoda::ooc::test
