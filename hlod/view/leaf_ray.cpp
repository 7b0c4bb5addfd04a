#include "hlod/view/leaf_ray.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <utility>

namespace pagoda::hlod {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The ray in lattice steps; `along` is the same number in both spaces.
struct Ray {
    Vec3d origin, direction;
    double least, most;
    // Woop's shear and permutation, fixed for the ray.
    int kx, ky, kz;
    double sx, sy, sz;

    Ray(const LeafRay& ray, const ooc::Lattice& lattice)
        : origin((ray.originModel - lattice.origin) / lattice.step()),
          direction(ray.direction / lattice.step()),
          least(ray.leastAlong),
          most(kInfinity) {
        const Vec3d size = glm::abs(direction);
        kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
        kx = (kz + 1) % 3;
        ky = (kz + 2) % 3;
        if (direction[kz] < 0.0) std::swap(kx, ky);
        sx = direction[kx] / direction[kz];
        sy = direction[ky] / direction[kz];
        sz = 1.0 / direction[kz];
        if (ray.clip.section) cut(*ray.clip.section, ray);
    }

    // What lies above the plane is not there.
    void cut(const SectionPlane& plane, const LeafRay& ray) {
        const double above = plane.above(ray.originModel);
        const double slope = glm::dot(plane.normal, ray.direction);
        if (slope > 0.0) {
            most = std::min(most, -above / slope);
        } else if (slope < 0.0) {
            least = std::max(least, -above / slope);
        } else if (above > 0.0) {
            most = -kInfinity;
        }
    }

    // Where it enters the box, grown a little against rounding; nothing when it passes by.
    [[nodiscard]] std::optional<double> enters(const Box3i& box) const {
        double first = least, last = most;
        for (int axis = 0; axis < 3; ++axis) {
            const double grow = 1e-9 * (1.0 + std::abs(origin[axis]));
            const double low = box.min[axis] - grow - origin[axis];
            const double high = box.max[axis] + grow - origin[axis];
            if (direction[axis] == 0.0) {
                if (low > 0.0 || high < 0.0) return std::nullopt;
                continue;
            }
            const double a = low / direction[axis], b = high / direction[axis];
            first = std::max(first, std::min(a, b));
            last = std::min(last, std::max(a, b));
        }
        if (!(first <= last)) return std::nullopt;
        return first;
    }

    [[nodiscard]] std::optional<double> meets(const Vec3i& a, const Vec3i& b,
                                              const Vec3i& c) const {
        const Vec3d corners[3] = {Vec3d(a) - origin, Vec3d(b) - origin, Vec3d(c) - origin};
        double x[3], y[3];
        for (int i = 0; i < 3; ++i) {
            x[i] = corners[i][kx] - sx * corners[i][kz];
            y[i] = corners[i][ky] - sy * corners[i][kz];
        }
        const double u = x[2] * y[1] - y[2] * x[1];
        const double v = x[0] * y[2] - y[0] * x[2];
        const double w = x[1] * y[0] - y[1] * x[0];
        if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return std::nullopt;
        const double sum = u + v + w;
        if (sum == 0.0) return std::nullopt;  // seen edge on
        const double along =
            sz * (u * corners[0][kz] + v * corners[1][kz] + w * corners[2][kz]) / sum;
        if (!(along >= least && along <= most)) return std::nullopt;
        return along;
    }
};

// A node that the ray enters.
struct Step {
    double along;
    ooc::NodeRecord node;
    [[nodiscard]] bool operator<(const Step& other) const {  // the nearest on top of a heap
        return along != other.along ? along > other.along : node.id.value > other.node.id.value;
    }
};

class Caster {
public:
    Caster(const cache::PageSource& source, const ooc::Lattice& lattice, const LeafRay& ray)
        : source_(source), lattice_(lattice), asked_(ray), ray_(ray, lattice) {}

    LeafRayResult run(const std::function<bool()>& isCancelled) {
        if (const auto* block = this->block(0); block != nullptr && !block->nodes.empty()) {
            push(block->nodes[0]);
        }
        while (!steps_.empty()) {
            const Step step = steps_.top();
            steps_.pop();
            // As near as what was found: its triangles may tie.
            if (opaque_ && step.along > opaque_->along) break;
            if (isCancelled && isCancelled()) {
                result_.isCancelled = true;
                return std::move(result_);
            }
            if (step.node.isLeaf()) {
                testLeaf(step.node);
            } else {
                pushChildren(step.node);
            }
        }
        const auto& hit = opaque_ ? opaque_ : translucent_;
        result_.isHit = hit.has_value();
        if (hit) result_.hit = *hit;
        return std::move(result_);
    }

private:
    void push(const ooc::NodeRecord& node) {
        if (asked_.clip.removes(lattice_.toModel(node.box))) return;
        if (const auto along = ray_.enters(node.box)) steps_.push({*along, node});
    }

    const ooc::IndexBlock* block(uint32_t number) {
        if (const auto found = blocks_.find(number); found != blocks_.end()) {
            return found->second.get();
        }
        auto& kept = blocks_[number];
        if (number >= source_.blockCount()) {
            result_.faults.push_back(fmt::format("index block {}: there is no such block", number));
            return nullptr;
        }
        const cache::ByteRange range = source_.blockRange(number);
        std::vector<std::byte> bytes(range.bytes);
        std::string fault = source_.read(range.offset, bytes);
        if (fault.empty()) {
            auto loaded = source_.decodeBlock(number, bytes);
            fault = loaded.fault;
            if (loaded.value) {
                kept = std::make_unique<ooc::IndexBlock>(std::move(*loaded.value));
            }
        }
        if (!kept) result_.faults.push_back(fmt::format("index block {}: {}", number, fault));
        return kept.get();
    }

    // Ids grow downwards, so that no file can lead in circles.
    void pushChildren(const ooc::NodeRecord& node) {
        const ooc::IndexBlock* const children = block(node.childBlock);
        if (children == nullptr) return;
        const uint64_t end = uint64_t{node.childIndex} + node.childCount();
        for (uint32_t k = 0; k < node.childCount(); ++k) {
            if (end > children->nodes.size() ||
                children->nodes[node.childIndex + k].id != node.childId(k)) {
                result_.faults.push_back(fmt::format(
                    "index block {}: children do not belong to their parent", node.childBlock));
                return;
            }
            push(children->nodes[node.childIndex + k]);
        }
    }

    void testLeaf(const ooc::NodeRecord& node) {
        std::vector<std::byte> bytes(node.pageBytes);
        std::string fault = source_.read(node.pageOffset, bytes);
        std::optional<ooc::Page> page;
        if (fault.empty()) {
            auto loaded = source_.decodePage(node, bytes);
            page = std::move(loaded.value);
            fault = std::move(loaded.fault);
        }
        if (!page) {
            result_.faults.push_back(fmt::format("page of node {:#x}: {}", node.id.value, fault));
            return;
        }
        ++result_.readPages;
        result_.readBytes += node.pageBytes;
        testMesh(node.id, page->mesh);
    }

    void testMesh(ooc::NodeId leaf, const ooc::PageMesh& mesh) {
        const ooc::ObjectSet* const hidden = asked_.clip.hidden.get();
        uint32_t triangle = 0;
        for (const ooc::MeshRun& run : mesh.runs) {
            const uint32_t end = triangle + run.triangleCount;
            const bool isHidden = hidden != nullptr && hidden->contains(run.object);
            for (; triangle < end; ++triangle) {
                if (!isHidden) testTriangle(leaf, mesh, triangle, run);
            }
        }
    }

    void testTriangle(ooc::NodeId leaf, const ooc::PageMesh& mesh, uint32_t triangle,
                      const ooc::MeshRun& run) {
        const uint32_t* const corner = mesh.indices.data() + size_t{3} * triangle;
        const std::array<Vec3i, 3> points = {mesh.positions[corner[0]], mesh.positions[corner[1]],
                                             mesh.positions[corner[2]]};
        const auto along = ray_.meets(points[0], points[1], points[2]);
        if (!along) return;
        const bool isTranslucent = triangle >= mesh.opaqueTriangleCount();
        auto& best = isTranslucent ? translucent_ : opaque_;
        if (best && !isBefore(*along, leaf, triangle, *best)) return;
        best = LeafHit{.pointModel = asked_.originModel + *along * asked_.direction,
                       .along = *along,
                       .leaf = leaf,
                       .triangle = triangle,
                       .object = run.object,
                       .material = run.material,
                       .isTranslucent = isTranslucent,
                       .cornersModel = {lattice_.toModel(points[0]), lattice_.toModel(points[1]),
                                        lattice_.toModel(points[2])}};
    }

    static bool isBefore(double along, ooc::NodeId leaf, uint32_t triangle, const LeafHit& best) {
        if (along != best.along) return along < best.along;
        return std::pair(leaf.value, triangle) < std::pair(best.leaf.value, best.triangle);
    }

    const cache::PageSource& source_;
    const ooc::Lattice& lattice_;
    const LeafRay& asked_;
    Ray ray_;
    std::priority_queue<Step> steps_;
    std::map<uint32_t, std::unique_ptr<ooc::IndexBlock>> blocks_;
    std::optional<LeafHit> opaque_, translucent_;
    LeafRayResult result_;
};

}  // namespace

LeafRayResult castLeafRay(const cache::PageSource& source, const ooc::Lattice& lattice,
                          const LeafRay& ray, const std::function<bool()>& isCancelled) {
    return Caster(source, lattice, ray).run(isCancelled);
}

}  // namespace pagoda::hlod
