#include "ooc/store/verify_page.h"

#include "ooc/store/triangle_sum.h"

#include <algorithm>

namespace pagoda::ooc {
namespace {

// Parts 0..7 are drawn as opaque and 8..15 blended: their materials must agree.
std::string checkTranslucency(const PageMesh& mesh, const std::vector<MaterialRecord>& materials) {
    uint32_t first = 0;
    for (const MeshRun& run : mesh.runs) {
        const bool isInTranslucentPart = first >= mesh.opaqueTriangleCount();
        if (materials[run.material].isTranslucent != isInTranslucentPart) {
            return "material " + std::to_string(run.material) + " in a part of the other opacity";
        }
        first += run.triangleCount;
    }
    return {};
}

std::string checkBox(const PageMesh& mesh, const NodeRecord& node, const Box3i& childrenBox) {
    if (!node.isLeaf() && childrenBox.isEmpty()) return {};
    Box3i box = mesh.box();
    if (!node.isLeaf()) box.extend(childrenBox);
    return box == node.box ? std::string{} : "box is not tight";
}

void tally(const PageMesh& mesh, PageFinding& finding) {
    const uint32_t* corner = mesh.indices.data();
    for (const MeshRun& run : mesh.runs) {
        ObjectTally& object = finding.objects.emplace_back(
            ObjectTally{.object = run.object, .triangleCount = run.triangleCount});
        for (uint32_t t = 0; t < run.triangleCount; ++t, corner += 3) {
            const Vec3i& a = mesh.positions[corner[0]];
            const Vec3i& b = mesh.positions[corner[1]];
            const Vec3i& c = mesh.positions[corner[2]];
            addTriangle(finding.triangleSum, a, b, c, run.object, run.material);
            for (const Vec3i& position : {a, b, c}) object.box.extend(position);
        }
    }
    std::sort(finding.objects.begin(), finding.objects.end(),
              [](const ObjectTally& a, const ObjectTally& b) { return a.object < b.object; });
}

}  // namespace

PageFinding verifyPage(const Database& database, const NodeRecord& node, const Box3i& childrenBox) {
    PageFinding finding;
    const Loaded<Page> page = database.readPage(node);
    if (!page.value) {
        finding.fault = page.fault;
        return finding;
    }
    const PageMesh& mesh = page.value->mesh;
    finding.fault = checkTranslucency(mesh, database.materials());
    if (finding.fault.empty()) finding.fault = checkBox(mesh, node, childrenBox);
    if (node.isLeaf()) tally(mesh, finding);
    return finding;
}

}  // namespace pagoda::ooc
