#include "ooc/store/verify.h"

#include "ooc/base/error.h"
#include "ooc/base/thread_pool.h"
#include "ooc/store/database.h"
#include "ooc/store/verify_page.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace pagoda::ooc {
namespace {

constexpr size_t kBatchPages = 1024;  // looked at together: bounds memory, hides stragglers
constexpr size_t kPagesPerTask = 8;

std::string versus(uint64_t announced, uint64_t found) {
    return std::to_string(announced) + " announced, " + std::to_string(found) + " found";
}

// What the walk and the pages add up to.
struct Totals {
    uint64_t nodes = 0, leaves = 0, leafTriangles = 0, pageBytes = 0;
    uint32_t levels = 0;
    OrderFreeSum triangleSum{};
    // Pages tile their part of the file exactly when every page begins where another ends: the
    // places where they begin, and the end of all, are the places where they end, and the begin of
    // all. Compared as order-free sums, so that nothing has to be sorted or kept.
    OrderFreeSum pageBegins{}, pageEnds{};
};

void addPlace(OrderFreeSum& sum, uint64_t place) {
    sum.add(std::as_bytes(std::span<const uint64_t>(&place, 1)));
}

class Verifier {
public:
    Verifier(const Database& database, size_t threadCount, Progress& progress, VerifyReport& report)
        : database_(database), pool_(threadCount), progress_(progress), report_(report) {}

    void run() {
        if (!database_.headerFault().empty()) report_.add("header", database_.headerFault());
        for (const auto* ranges :
             {&database_.otherRanges(), &database_.indexRanges(), &database_.objectRanges()}) {
            for (const Database::Range& range : *ranges) checkRange(range);
        }
        checkMetadata();

        objects_.resize(database_.header().objectCount);
        for (uint32_t i = 0; i < objects_.size(); ++i) objects_[i].object = i;
        progress_.beginStage("Verifying", database_.header().nodeCount, "nodes");
        walkIndex(database_, *this);
        for (const auto& [id, node] : waiting_) addJob(node, Box3i{});
        finishBatch();
        if (report_.isSound()) checkTotals();
        checkObjects();
    }

    // The three calls of walkIndex().
    bool enter(const NodeRecord& node, NodeRef) {
        const auto level = static_cast<uint32_t>(node.id.depth() + (node.id.slot() != 0 ? 2 : 1));
        ++totals_.nodes;
        totals_.leaves += node.isLeaf() ? 1u : 0u;
        totals_.leafTriangles += node.isLeaf() ? node.triangleCount : 0u;
        totals_.levels = std::max(totals_.levels, level);
        totals_.pageBytes += node.pageBytes;
        addPlace(totals_.pageBegins, node.pageOffset);
        addPlace(totals_.pageEnds, node.pageOffset + node.pageBytes);
        if (node.id.depth() > database_.header().lattice.extentBits) {
            report_.add(nodeName(node.id), "cell smaller than a lattice step");
        }
        if (node.isLeaf()) {
            addJob(node, Box3i{});
        } else {
            waiting_.emplace(node.id, node);  // until its children are known
        }
        return true;
    }

    void children(const NodeRecord& parent, std::span<const NodeRecord> children) {
        uint64_t triangles = 0;
        Box3i box;
        for (const NodeRecord& child : children) {
            triangles += child.subtreeTriangles;
            box.extend(child.box);
            if (child.errorModelUnits > parent.errorModelUnits) {
                report_.add(nodeName(child.id), "its error is greater than its parent's");
            }
            if (!parent.box.contains(child.box)) {
                report_.add(nodeName(child.id), "its box leaves its parent's");
            }
        }
        if (triangles != parent.subtreeTriangles) {
            report_.add(nodeName(parent.id),
                        "triangles below: " + versus(parent.subtreeTriangles, triangles));
        }
        waiting_.erase(parent.id);
        addJob(parent, box);
    }

    void fault(uint32_t block, const std::string& why) {
        const std::string place = database_.indexRanges()[block].name;
        if (!brokenRanges_.contains(place)) report_.add(place, why);
    }

private:
    struct Job {
        NodeRecord node;
        Box3i childrenBox{};
        PageFinding finding{};
    };

    void checkRange(const Database::Range& range) {
        progress_.check();
        std::vector<std::byte> bytes(range.bytes);
        size_t got = 0;
        try {
            got = database_.file().readSomeAt(range.offset, bytes);
        } catch (const Error& error) {
            report_.add(range.name, error.problem());
            brokenRanges_.insert(range.name);
            return;
        }
        report_.bytesChecked += got;
        if (got == bytes.size() && hash64(bytes) == range.checksum) return;
        brokenRanges_.insert(range.name);
        const bool isSaid = range.name == "header" && !database_.headerFault().empty();
        if (!isSaid) report_.add(range.name, "checksum differs");
    }

    void checkMetadata() {
        if (!database_.metadataFault().empty()) return;  // checkRange() has said so
        const auto json = nlohmann::json::parse(database_.metadataJson(), nullptr, false);
        if (!json.is_object()) {
            report_.add("metadata", "not a JSON object");
        } else if (json.contains("sources") && json["sources"].is_array()) {
            sourceCount_ = json["sources"].size();
        }
    }

    void addJob(const NodeRecord& node, const Box3i& childrenBox) {
        batch_.push_back({.node = node, .childrenBox = childrenBox});
        if (batch_.size() == kBatchPages) finishBatch();
    }

    void finishBatch() {
        progress_.check();
        for (size_t first = 0; first < batch_.size(); first += kPagesPerTask) {
            const auto jobs =
                std::span(batch_).subspan(first, std::min(kPagesPerTask, batch_.size() - first));
            pool_.add([this, jobs] {
                for (Job& job : jobs) {
                    job.finding = verifyPage(database_, job.node, job.childrenBox);
                }
                progress_.advance(jobs.size());
            });
        }
        pool_.wait();
        for (const Job& job : batch_) add(job);
        batch_.clear();
    }

    void add(const Job& job) {
        report_.bytesChecked += job.node.pageBytes;
        ++report_.nodesChecked;
        if (!job.finding.fault.empty()) {
            report_.add(nodeName(job.node.id) + " (page at byte " +
                            std::to_string(job.node.pageOffset) + ")",
                        job.finding.fault);
        }
        totals_.triangleSum.add(job.finding.triangleSum);
        for (const ObjectTally& part : job.finding.objects) {
            ObjectTally& whole = objects_[part.object];
            whole.triangleCount += part.triangleCount;
            whole.box.extend(part.box);
            report_.trianglesChecked += part.triangleCount;
        }
    }

    void compare(const char* what, uint64_t announced, uint64_t found) {
        if (announced != found) report_.add("header", what + (": " + versus(announced, found)));
    }

    void checkTotals() {
        const Header& header = database_.header();
        compare("nodes", header.nodeCount, totals_.nodes);
        compare("leaves", header.leafCount, totals_.leaves);
        compare("levels", header.levelCount, totals_.levels);
        compare("triangles", header.triangleCount, totals_.leafTriangles);
        if (header.triangleSum != totals_.triangleSum) {
            report_.add("header", "the leaves hold other triangles than were accepted");
        }
        addPlace(totals_.pageBegins, database_.indexRanges().front().offset);
        addPlace(totals_.pageEnds, database_.otherRanges().front().bytes);  // behind the header
        if (totals_.pageBegins != totals_.pageEnds) {
            report_.add("pages", "bytes between pages, or pages that overlap");
        }
    }

    void checkObjects() {
        const bool isComplete = report_.isSound();  // else the tallies lack what is broken
        for (uint32_t block = 0; block < database_.objectBlockCount(); ++block) {
            progress_.check();
            const auto loaded = database_.readObjectBlock(block);
            const std::string place = database_.objectRanges()[block].name;
            if (!loaded.value) {
                if (!brokenRanges_.contains(place)) report_.add(place, loaded.fault);
                continue;
            }
            const size_t first = next_;
            next_ += loaded.value->size();
            for (size_t i = first; isComplete && i < next_; ++i) {
                checkObject((*loaded.value)[i - first], objects_[i]);
            }
        }
    }

    void checkObject(const ObjectRecord& record, const ObjectTally& found) {
        const std::string place = "object " + std::to_string(found.object);
        if (record.triangleCount != found.triangleCount) {
            report_.add(place, "triangles: " + versus(record.triangleCount, found.triangleCount));
        } else if (record.triangleCount != 0 && record.box != found.box) {
            report_.add(place, "box is not tight");
        }
        if (sourceCount_ && record.source >= *sourceCount_) {
            report_.add(place, "no such source: " + std::to_string(record.source));
        }
    }

    const Database& database_;
    ThreadPool pool_;
    Progress& progress_;
    VerifyReport& report_;
    Totals totals_;
    std::vector<Job> batch_;
    std::map<NodeId, NodeRecord> waiting_;
    std::vector<ObjectTally> objects_;
    std::set<std::string> brokenRanges_;
    std::optional<size_t> sourceCount_;
    size_t next_ = 0;  // object of the block that checkObjects() is at
};

}  // namespace

std::string nodeName(NodeId id) {
    std::string name = "node /";
    for (int level = id.depth(); level-- > 0;) {
        name += std::to_string((id.path() >> (3 * level)) & 7u);
        if (level > 0) name += '/';
    }
    if (id.slot() != 0) name += " extra " + std::to_string(id.slot());
    return name;
}

void VerifyReport::add(std::string place, std::string what) {
    ++faultCount;
    if (faults.size() < kMaxListed) faults.push_back({std::move(place), std::move(what)});
}

VerifyReport verifyDatabase(const std::filesystem::path& path, size_t threadCount,
                            Progress& progress) {
    VerifyReport report;
    (void)File::openForReading(path);  // a missing file is an error, not a fault of a database
    try {
        const Database database = Database::open(path);
        Verifier(database, threadCount, progress, report).run();
    } catch (const Error& error) {
        report.add(error.place(), error.problem());
    }
    return report;
}

}  // namespace pagoda::ooc
