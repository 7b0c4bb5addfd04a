#include "tools/paths/triangle_stream.h"

#include "ooc/base/error.h"

#include <fmt/format.h>

namespace pagoda::tools {
namespace {

bool meets(const Box3d& a, const Box3d& b) {
    return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

[[noreturn]] void refuse(const ooc::Database& database, const std::string& place,
                         const std::string& fault) {
    throw Error(database.path(), place, fault, "see `pagoda verify`, and build it again");
}

}  // namespace

void forEachTriangle(const ooc::Database& database, const Upright& upright, double errorModelUnits,
                     const std::optional<Box3d>& box, Progress& progress,
                     const std::function<void(const Triangle&)>& visit) {
    const ooc::Lattice& lattice = database.header().lattice;
    const auto visitPage = [&](const ooc::NodeRecord& node) {
        const ooc::Loaded<ooc::Page> page = database.readPage(node);
        if (!page.value) refuse(database, fmt::format("page {:x}", node.id.value), page.fault);
        const ooc::PageMesh& mesh = page.value->mesh;
        for (size_t t = 0; t < mesh.triangleCount(); ++t) {
            Triangle triangle;
            for (size_t i = 0; i < 3; ++i) {
                const Vec3i& corner = mesh.positions[mesh.indices[3 * t + i]];
                triangle[i] = upright.fromModel(lattice.toModel(corner));
            }
            visit(triangle);
        }
    };
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            progress.check();
            const bool isWanted = !box || meets(*box, upright.fromModel(lattice.toModel(node.box)));
            if (isWanted && !node.isLeaf() && node.errorModelUnits > errorModelUnits) return true;
            if (isWanted) visitPage(node);
            progress.advance(node.subtreeTriangles);
            return false;
        },
        [&](uint32_t block, const std::string& why) {
            refuse(database, fmt::format("index block {}", block), why);
        });
}

Box3d modelBox(const ooc::Database& database, const Upright& upright) {
    const ooc::Loaded<ooc::IndexBlock> block = database.readBlock(0);
    if (!block.value) refuse(database, "index block 0", block.fault);
    return upright.fromModel(database.header().lattice.toModel(block.value->nodes.front().box));
}

}  // namespace pagoda::tools
