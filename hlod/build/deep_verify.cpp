#include "hlod/build/deep_verify.h"

#include "hlod/build/simplify.h"
#include "ooc/base/thread_pool.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace pagoda::hlod {
namespace {

constexpr size_t kBatchFamilies = 128;  // looked at together: bounds memory, hides stragglers

// sampledDistance() takes the same samples whatever the order; but its tree of boxes is another,
// and of two faces that meet where a sample is nearest, the other may be asked: float rounding.
constexpr double kTolerance = 1e-6;

struct Family {
    ooc::NodeRecord node;
    std::vector<ooc::NodeRecord> children;
    double measured = 0;  // model units
    std::string fault;
};

void measure(const ooc::Database& database, Family& family) {
    const auto append = [&](const ooc::NodeRecord& node, std::vector<SoupTriangle>& triangles) {
        const ooc::Loaded<ooc::Page> page = database.readPage(node);
        if (!page.value) {
            family.fault = ooc::nodeName(node.id) + ": " + page.fault;
            return;
        }
        const std::vector<SoupTriangle> own = unpackPage(page.value->mesh);
        triangles.insert(triangles.end(), own.begin(), own.end());
    };
    std::vector<SoupTriangle> coarse, fine;
    append(family.node, coarse);
    double childError = 0;
    for (const ooc::NodeRecord& child : family.children) {
        append(child, fine);
        childError = std::max(childError, child.errorModelUnits);
    }
    if (!family.fault.empty()) return;
    if (coarse.empty() || fine.empty()) {
        family.fault = "no triangles to measure";
        return;
    }
    const ooc::Lattice& lattice = database.header().lattice;
    const Vec3i origin = cellFrame(family.node.id, lattice.extentBits).origin;
    family.measured = childError + sampledDistance(fine, coarse, origin) * lattice.step();
}

class DeepVerifier {
public:
    DeepVerifier(const ooc::Database& database, size_t threadCount, Progress& progress,
                 ooc::VerifyReport& faults)
        : database_(database), pool_(threadCount), progress_(progress), faults_(faults) {}

    DeepReport run() {
        const ooc::Header& header = database_.header();
        progress_.beginStage("Measuring errors", header.nodeCount - header.leafCount, "nodes");
        ooc::walkIndex(database_, *this);
        finishBatch();
        return report_;
    }

    // The three calls of walkIndex().
    bool enter(const ooc::NodeRecord& node, ooc::NodeRef) {
        if (!node.isLeaf()) return true;
        ++report_.leaves;
        const double least = kSnapErrorSteps * database_.header().lattice.step();
        if (!(node.errorModelUnits >= least)) addTooSmall(node, least);
        return true;
    }
    void children(const ooc::NodeRecord& parent, std::span<const ooc::NodeRecord> children) {
        families_.push_back({.node = parent,
                             .children = {children.begin(), children.end()},
                             .measured = 0,
                             .fault = {}});
        if (families_.size() == kBatchFamilies) finishBatch();
    }
    void fault(uint32_t block, const std::string& why) {
        faults_.add(database_.indexRanges()[block].name, why);
    }

private:
    void finishBatch() {
        progress_.check();
        for (Family& family : families_) {
            pool_.add([this, &family] {
                progress_.check();
                measure(database_, family);
                progress_.advance(1);
            });
        }
        pool_.wait();
        for (const Family& family : families_) add(family);
        families_.clear();
    }

    void add(const Family& family) {
        ++report_.innerNodes;
        if (!family.fault.empty()) {
            faults_.add(ooc::nodeName(family.node.id), family.fault);
            return;
        }
        const double stated = family.node.errorModelUnits;
        report_.largestRatio = std::max(report_.largestRatio, family.measured / stated);
        if (!(family.measured <= stated * (1 + kTolerance))) {
            addTooSmall(family.node, family.measured);
        }
    }

    void addTooSmall(const ooc::NodeRecord& node, double least) {
        ++report_.tooSmall;
        faults_.add(ooc::nodeName(node.id),
                    fmt::format("error {} stated, {} measured", node.errorModelUnits, least));
    }

    const ooc::Database& database_;
    ThreadPool pool_;
    Progress& progress_;
    ooc::VerifyReport& faults_;
    DeepReport report_;
    std::vector<Family> families_;
};

}  // namespace

DeepReport verifyErrors(const ooc::Database& database, size_t threadCount, Progress& progress,
                        ooc::VerifyReport& faults) {
    return DeepVerifier(database, threadCount, progress, faults).run();
}

}  // namespace pagoda::hlod
