#include "hlod/build/tree_builder.h"

#include "hlod/build/level_lattice.h"
#include "hlod/build/simplify.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pagoda::hlod {
namespace {

// Each level holds about a quarter of the triangles of the one below: an octree over a surface has
// four children a node, so nodes stay equally full.
constexpr uint32_t kReduction = 4;

// Only the coarsest cells cluster from proxies: there are few of them, and they are seen as a
// whole.
constexpr int kProxyDepth = 4;

// Interleaved bits of a lattice point, for sorting what a cell cannot tell apart.
uint64_t mortonKey(const Vec3i& point) {
    uint64_t key = 0;
    for (int bit = 20; bit >= 0; --bit) {
        for (int axis = 2; axis >= 0; --axis) {
            key = (key << 1) | ((static_cast<uint32_t>(point[axis]) >> bit) & 1u);
        }
    }
    return key;
}

double roundedUp(double value) {
    return std::nextafter(value, std::numeric_limits<double>::infinity());
}

}  // namespace

std::vector<SoupTriangle> TreeBuilder::unpack(std::span<const std::byte> soup) const {
    const size_t stride = settings_.layout.bytes();
    std::vector<SoupTriangle> triangles(soup.size() / stride);
    for (size_t i = 0; i < triangles.size(); ++i) {
        triangles[i] = settings_.layout.load(soup.data() + i * stride);
        if (!settings_.layout.hasColours) {
            triangles[i].colours.fill(settings_.materialColours[triangles[i].material]);
        }
    }
    return triangles;
}

CellFrame TreeBuilder::frameOf(ooc::NodeId cell) const {
    return cellFrame(cell, settings_.lattice.extentBits);
}

TreeBuilder::Subtree TreeBuilder::buildLeaf(ooc::NodeId id, std::span<const SoupTriangle> all,
                                            const Numbers& numbers) {
    Subtree leaf;
    leaf.triangles.reserve(numbers.size());
    for (const uint32_t number : numbers) leaf.triangles.push_back(all[number]);
    leaf.record.id = id;
    leaf.record.errorModelUnits = roundedUp(kSnapErrorSteps * settings_.lattice.step());
    leaf.record.subtreeTriangles = numbers.size();
    leaf.record = store_.add(
        leaf.record, assemblePage(leaf.triangles, frameOf(id.cell()), settings_.isTranslucent));
    return leaf;
}

// By (centroid's Morton number, input order), in as few leaves as the budget allows; all slots
// evenly when it does not (only for triangles that no cell can part).
std::vector<TreeBuilder::Subtree> TreeBuilder::cutExtraLeaves(ooc::NodeId cell,
                                                              std::span<const SoupTriangle> all,
                                                              const Numbers& numbers) {
    if (numbers.empty()) return {};
    const CellFrame frame = frameOf(cell);
    const int shift = std::max(0, frame.bits - 21);
    const auto key = [&](uint32_t number) {
        const Vec3i point = centroidPoint(all[number].corners, frame.extentBits) - frame.origin;
        return mortonKey({point.x >> shift, point.y >> shift, point.z >> shift});
    };
    std::vector<std::pair<uint64_t, uint32_t>> order;
    order.reserve(numbers.size());
    for (const uint32_t number : numbers) order.emplace_back(key(number), number);
    std::sort(order.begin(), order.end());

    const size_t wanted = (order.size() + settings_.nodeTriangles - 1) / settings_.nodeTriangles;
    const size_t leaves = std::min<size_t>(wanted, ooc::kMaxExtraLeaves);
    std::vector<Subtree> result;
    for (size_t leaf = 0; leaf < leaves; ++leaf) {
        const size_t begin = order.size() * leaf / leaves, end = order.size() * (leaf + 1) / leaves;
        Numbers part;
        for (size_t i = begin; i < end; ++i) part.push_back(order[i].second);
        result.push_back(buildLeaf(cell.extra(static_cast<uint32_t>(leaf + 1)), all, part));
    }
    return result;
}

TreeBuilder::Subtree TreeBuilder::buildCell(ooc::NodeId cell, std::span<const SoupTriangle> all,
                                            Numbers numbers) {
    if (numbers.size() <= settings_.nodeTriangles) return buildLeaf(cell, all, numbers);
    const int depth = cell.depth();
    const CellFrame frame = frameOf(cell);
    Numbers own;
    std::array<Numbers, 8> parts;
    for (const uint32_t number : numbers) {
        const std::array<Vec3i, 3>& corners = all[number].corners;
        if (depth >= settings_.maxDepth || homeDepth(corners, frame.extentBits) <= depth) {
            own.push_back(number);
        } else {
            parts[octantOf(centroidPoint(corners, frame.extentBits), frame.bits)].push_back(number);
        }
    }
    numbers = {};
    std::vector<Subtree> children;
    for (uint32_t octant = 0; octant < 8; ++octant) {
        if (parts[octant].empty()) continue;
        children.push_back(buildCell(cell.child(octant), all, std::move(parts[octant])));
    }
    std::vector<Subtree> extra = cutExtraLeaves(cell, all, own);
    std::move(extra.begin(), extra.end(), std::back_inserter(children));
    return buildInner(cell, std::move(children));
}

TreeBuilder::Subtree TreeBuilder::buildInner(ooc::NodeId cell, std::vector<Subtree> children) {
    const CellFrame frame = frameOf(cell);
    Subtree node;
    node.record.id = cell;
    std::vector<SoupTriangle> merged, finer;
    const bool anyProxy = cell.depth() <= kProxyDepth &&
                          std::any_of(children.begin(), children.end(),
                                      [](const Subtree& child) { return !child.proxy.empty(); });
    double childError = 0;
    uint32_t extraLeaves = 0, mask = 0;
    for (Subtree& child : children) {
        if (child.record.id.slot() != 0) {
            ++extraLeaves;
        } else {
            mask |= 1u << child.record.id.octant();
        }
        node.record.box.extend(child.record.box);
        node.record.subtreeTriangles += child.record.subtreeTriangles;
        childError = std::max(childError, child.record.errorModelUnits);
        merged.insert(merged.end(), child.triangles.begin(), child.triangles.end());
        if (anyProxy) {
            const std::vector<SoupTriangle>& finest =
                child.proxy.empty() ? child.triangles : child.proxy;
            finer.insert(finer.end(), finest.begin(), finest.end());
        }
        child.triangles = {};
        child.proxy = {};
    }
    node.record.childMask = static_cast<uint16_t>(mask | (extraLeaves << 8));

    const auto count = static_cast<uint32_t>(merged.size());
    const uint32_t least = settings_.nodeTriangles / kReduction;
    SimplifyResult simple = simplifyNode(
        {.triangles = merged,
         .finer = finer,
         .cell = frame,
         .targetTriangles = std::clamp(count / kReduction, least, settings_.nodeTriangles),
         .budgetTriangles = settings_.nodeTriangles,
         .isTranslucent = &settings_.isTranslucent});
    bentWedges_ += simple.bentWedges;
    if (simple.isSloppy) node.record.flags |= ooc::kNodeSloppy;
    if (simple.isStuck) node.record.flags |= ooc::kNodeStuck;
    const LevelSnap snap = snapToLevel(simple.triangles, frame, node.record.box, !simple.isSloppy);
    keptVertices_ += snap.kept;
    const double distance = sampledDistance(merged, simple.triangles, frame.origin);
    node.record.errorModelUnits = roundedUp(childError + distance * settings_.lattice.step());
    node.triangles = std::move(simple.triangles);
    node.proxy = std::move(simple.proxy);
    node.record =
        store_.add(node.record, assemblePage(node.triangles, frame, settings_.isTranslucent));
    return node;
}

void TreeBuilder::buildSubtree(ooc::NodeId cell, std::span<const std::byte> soup) {
    const std::vector<SoupTriangle> all = unpack(soup);
    Numbers numbers(all.size());
    for (uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
    const Subtree root = buildCell(cell, all, std::move(numbers));
    if (!root.proxy.empty()) store_.addProxy(cell, root.proxy);
}

void TreeBuilder::buildExtraLeaves(ooc::NodeId cell, std::span<const std::byte> soup) {
    const std::vector<SoupTriangle> all = unpack(soup);
    Numbers numbers(all.size());
    for (uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
    (void)cutExtraLeaves(cell, all, numbers);
}

void TreeBuilder::buildTopNode(ooc::NodeId cell) {
    std::vector<Subtree> children;
    const auto take = [&](ooc::NodeId id) {
        if (!store_.contains(id)) return;
        const ooc::NodeRecord record = store_.find(id);
        children.push_back({.record = record,
                            .triangles = unpackPage(store_.readMesh(record)),
                            .proxy = store_.readProxy(id)});
    };
    for (uint32_t octant = 0; octant < 8; ++octant) take(cell.child(octant));
    for (uint32_t slot = 1; slot <= ooc::kMaxExtraLeaves; ++slot) take(cell.extra(slot));
    const Subtree node = buildInner(cell, std::move(children));
    if (!node.proxy.empty()) store_.addProxy(cell, node.proxy);
}

}  // namespace pagoda::hlod
