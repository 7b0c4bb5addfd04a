// Front to back in slabs (paper 003): the scene's box is cut into a grid of cubes; those in the
// frustum are visited slab by slab, a query asks of each whether it is seen, and what lies in a
// cell that is seen is drawn, once a frame. Queries go out in batches, so that one wait serves
// many. Nothing is remembered of what was seen but what stands in for absent pages.
//
// Over a paged octree: the cells list the nodes of this frame's cut (by SSE, or the leaves), found
// by boxes alone. A node is drawn when one of its cells is seen; a page is asked for then and not
// before, so what lies in hidden cells only is never read. Where a cell is larger than what is in
// it and not yet drawn, that is asked about; a cell of which all is drawn is left out, and one that
// would draw less than the query threshold is drawn unasked. `uniform` is one grid; `nested` cuts
// into a visible cell anew while it lists two nodes or more and is taken to hold more than the
// split threshold: a node's triangles are taken to be spread evenly over its box.
//
// Slabs are about efficiency only: whatever the order, hidden is what lies behind things drawn.
#include "hlod/strategies/node_memory.h"
#include "hlod/strategies/slab_grid.h"
#include "hlod/strategies/strategies.h"
#include "hlod/view/screen_box.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <vector>

namespace pagoda::hlod {
namespace {

constexpr uint32_t kNoParent = UINT32_MAX;
// Sub-grids end where so many cells would lie along the longest side (the paper gives no limit).
constexpr double kMostCellsAcross = 4096;

class SlabsStrategy final : public Strategy {
public:
    explicit SlabsStrategy(const SlabsOptions& options) : options_(options) {}

    void traverse(FrameContext& frame) override {
        frame_ = &frame;
        counting_ = frame.sink.counting();
        ++frameNumber_;
        entries_.clear();
        listed_.clear();
        const auto root = frame.tree.root();
        if (!root) return;
        memory_.fit(frame.tree);
        walk(*root, kNoParent, 0);
        const int across = options_.isNested ? options_.branching : options_.resolution;
        if (!listed_.empty()) visitGrid(gridOver(*root->boxModel, across), listed_, 0, across);
        remember();
    }
    void forget() override { memory_.clear(); }
    [[nodiscard]] bool learnsWhatIsHidden() const override { return true; }

private:
    enum class Role : uint8_t {
        Refined,  // its children stand for it
        Cut,      // to be drawn for itself
        StandIn,  // its children are not all there
    };
    struct Memory {
        uint64_t visitedFrame = 0;  // of this strategy
        bool isVisible = false, isRefined = false;
    };
    // A node of this frame in the frustum.
    struct Entry {
        Node node;
        Memory* memory = nullptr;
        double ssePx = 0;
        uint32_t parent = kNoParent;
        uint32_t probeLevel =
            0;  // below a stand-in: asked for, never drawn. 0: there is none above
        Role role = Role::Cut;
        bool isListed = false;
        bool isSeen = false;  // the stamp: told, and drawn if it can be
        bool isDrawn = false;
    };
    struct Open {
        const GridCell* cell = nullptr;
        std::optional<QueryTicket> ticket;  // none: visible, unasked
    };
    struct Level {
        GridCells cells;
        std::vector<Open> batch;
        std::vector<GridPart> unseen;
    };

    void walk(const Node& node, uint32_t parent, uint32_t probeLevel);
    void list(uint32_t index);
    [[nodiscard]] bool canRefine(const Memory& memory, const NodeRange& children);
    [[nodiscard]] Level& level(size_t depth);
    void visitGrid(const Grid& grid, std::span<const GridPart> parts, size_t depth, double across);
    void ask(Level& level, const GridCell& cell);
    void open(const Grid& grid, Level& level, const GridCell& cell, size_t depth, double across);
    void takeUnseen(Level& level, const GridCell& cell);
    [[nodiscard]] double spreadTriangles(std::span<const GridPart> parts) const;
    void see(uint32_t index);
    void tell(uint32_t index);
    void draw(uint32_t index);
    [[nodiscard]] bool drawStandIn(uint32_t index);
    void standInFor(uint32_t index);
    void remember();
    [[nodiscard]] double excessOf(uint32_t index) const;
    [[nodiscard]] double priorityOf(uint32_t index) const;
    [[nodiscard]] bool wasVisitedBefore(const Memory& memory) const {
        return memory.visitedFrame + 1 == frameNumber_;
    }

    SlabsOptions options_;
    NodeMemory<Memory> memory_;
    uint64_t frameNumber_ = 1;  // memories of frame 0 are of no frame
    FrameContext* frame_ = nullptr;
    CountingVisibility* counting_ = nullptr;
    std::vector<Entry> entries_;    // parents before children
    std::vector<GridPart> listed_;  // by entry
    std::deque<Level> levels_;      // of grids within grids; references stay
    std::vector<uint32_t> chain_;
};

// The cut, from what is known of the index. Nothing is asked for: what is hidden needs nothing.
void SlabsStrategy::walk(const Node& node, uint32_t parent, uint32_t probeLevel) {
    ++frame_->record.visitedNodes;
    if (!frame_->view.intersectsFrustum(*node.boxModel)) {
        ++frame_->record.culledNodes;
        return;
    }
    const auto index = static_cast<uint32_t>(entries_.size());
    Memory& memory = memory_[node];
    const double ssePx = frame_->view.ssePx(node.record->errorModelUnits, *node.boxModel);
    entries_.push_back({node, &memory, ssePx, parent, probeLevel});
    if (node.isLeaf() || (frame_->tauPx > 0.0 && ssePx <= frame_->tauPx)) return list(index);
    const NodeRange family = frame_->tree.residentChildren(node);
    const bool canBe = probeLevel == 0 && canRefine(memory, family);
    entries_[index].role = canBe ? Role::Refined : Role::StandIn;
    const bool isEnd = family.empty() || probeLevel >= frame_->probeLevels;
    // A stand-in may be seen where nothing below it is: its own mesh is coarser.
    if (isEnd || (!canBe && probeLevel == 0)) list(index);
    if (isEnd) return;
    const uint32_t below = canBe ? 0 : probeLevel + 1;
    for (uint32_t i = 0; i < family.size(); ++i) walk(family[i], index, below);
}

void SlabsStrategy::list(uint32_t index) {
    entries_[index].isListed = true;
    listed_.push_back({index, *entries_[index].node.boxModel});
}

// A node may be left for its children when all that are not known to be hidden are there, or when
// it was left for them in the last frame: then nothing gets coarser, and a missing one has a
// stand-in beside the others.
bool SlabsStrategy::canRefine(const Memory& memory, const NodeRange& children) {
    if (children.empty()) return false;
    bool isWhole = true;
    for (uint32_t i = 0; i < children.size(); ++i) {
        const Node child = children[i];
        const cache::PageState state = frame_->sink.state(child);
        if (state == cache::PageState::Resident) continue;
        const Memory& known = memory_[child];
        const bool isHidden = wasVisitedBefore(known) && !known.isVisible;
        if (isHidden || !frame_->view.intersectsFrustum(*child.boxModel)) continue;
        if (state == cache::PageState::Failed) return false;
        isWhole = false;
    }
    return isWhole || (wasVisitedBefore(memory) && memory.isRefined);
}

SlabsStrategy::Level& SlabsStrategy::level(size_t depth) {
    while (levels_.size() <= depth) levels_.emplace_back();
    return levels_[depth];
}

// All of a slab is drawn before the next one is asked about. `across`: cells of this size along the
// scene's longest side.
void SlabsStrategy::visitGrid(const Grid& grid, std::span<const GridPart> parts, size_t depth,
                              double across) {
    Level& here = level(depth);
    const View& view = frame_->view;
    here.cells.fill(grid, SlabOrder(view.forward(), view.eye(), grid), parts);
    const std::vector<GridCell>& cells = here.cells.cells;
    for (size_t next = 0; next < cells.size();) {
        const double slab = cells[next].slab;
        here.batch.clear();
        size_t askedCells = 0;
        for (; next < cells.size() && cells[next].slab == slab && askedCells < options_.batch;
             ++next) {
            const size_t before = here.batch.size();
            ask(here, cells[next]);
            askedCells += here.batch.size() > before && here.batch.back().ticket.has_value();
        }
        bool hasWaited = false;
        for (Open& each : here.batch) {
            if (!each.ticket) continue;
            hasWaited = true;
            if (counting_->wait(*each.ticket) == 0) each.cell = nullptr;
        }
        frame_->record.waits += hasWaited;
        for (const Open& each : here.batch) {
            if (each.cell != nullptr) open(grid, here, *each.cell, depth, across);
        }
    }
}

// What is left to draw in the cell.
void SlabsStrategy::takeUnseen(Level& level, const GridCell& cell) {
    level.unseen.clear();
    for (const GridPart& part : level.cells.partsOf(cell)) {
        if (!entries_[part.box].isSeen) level.unseen.push_back(part);
    }
}

void SlabsStrategy::ask(Level& level, const GridCell& cell) {
    takeUnseen(level, cell);
    if (level.unseen.empty()) return;
    Box3d boxModel;
    uint64_t triangles = 0;
    for (const GridPart& part : level.unseen) {
        boxModel.extend(part.boxModel);
        triangles += entries_[part.box].node.record->triangleCount;
    }
    const View& view = frame_->view;
    if (!view.intersectsFrustum(boxModel)) return;
    Open& asked = level.batch.emplace_back();
    asked.cell = &cell;
    const bool isUnasked =
        counting_ == nullptr || triangles < options_.queryTriangles || crossesNear(view, boxModel);
    if (!isUnasked) asked.ticket = counting_->query(boxModel);
}

// Of a cell that is seen.
void SlabsStrategy::open(const Grid& grid, Level& level, const GridCell& cell, size_t depth,
                         double across) {
    takeUnseen(level, cell);
    const double acrossBelow = across * options_.branching;
    const bool isCut = options_.isNested && level.unseen.size() > 1 &&
                       acrossBelow <= kMostCellsAcross &&
                       spreadTriangles(level.unseen) > options_.splitTriangles;
    if (!isCut) {
        for (const GridPart& part : level.unseen) see(part.box);
        return;
    }
    const auto number = static_cast<int>(cell.number);
    const Vec3i at(number % grid.cells.x, number / grid.cells.x % grid.cells.y,
                   number / grid.cells.x / grid.cells.y);
    const Grid below{.origin = grid.origin + grid.side * Vec3d(at),
                     .side = grid.side / options_.branching,
                     .cells = Vec3i(options_.branching)};
    visitGrid(below, level.unseen, depth + 1, acrossBelow);
}

double SlabsStrategy::spreadTriangles(std::span<const GridPart> parts) const {
    double triangles = 0;
    for (const GridPart& part : parts) {
        const Node& node = entries_[part.box].node;
        const Vec3d whole = node.boxModel->max - node.boxModel->min;
        const Vec3d here = part.boxModel.max - part.boxModel.min;
        double share = 1.0;
        for (int k = 0; k < 3; ++k) share *= whole[k] > 0.0 ? here[k] / whole[k] : 1.0;
        triangles += share * node.record->triangleCount;
    }
    return triangles;
}

// With the way to it, from the top: parents are told first.
void SlabsStrategy::see(uint32_t index) {
    chain_.clear();
    for (; index != kNoParent && !entries_[index].isSeen; index = entries_[index].parent) {
        entries_[index].isSeen = true;
        chain_.push_back(index);
    }
    for (auto each = chain_.rbegin(); each != chain_.rend(); ++each) tell(*each);
}

void SlabsStrategy::tell(uint32_t index) {
    const Entry& entry = entries_[index];
    if (entry.role == Role::Cut) return draw(index);
    // Asks for the children's block, or uses it.
    static_cast<void>(frame_->tree.children(entry.node, priorityOf(index)));
    if (entry.role == Role::Refined) {
        frame_->sink.refine(entry.node);
        frame_->sink.keep(entry.node);
    } else if (entry.probeLevel > 0) {
        frame_->sink.want(entry.node, priorityOf(index), Use::StandIn);
    } else if (!drawStandIn(index)) {
        standInFor(index);
    }
}

void SlabsStrategy::draw(uint32_t index) {
    Entry& entry = entries_[index];
    const cache::PageState state = frame_->sink.want(entry.node, priorityOf(index), Use::Cut);
    if (entry.probeLevel > 0) return;
    if (state != cache::PageState::Resident) return standInFor(index);
    entry.isDrawn = true;
    frame_->sink.draw(entry.node, Use::Cut);
}

// The nearest resident ancestor covers a node that is seen and not there.
void SlabsStrategy::standInFor(uint32_t index) {
    for (index = entries_[index].parent; index != kNoParent; index = entries_[index].parent) {
        if (drawStandIn(index)) return;
    }
}

bool SlabsStrategy::drawStandIn(uint32_t index) {
    Entry& entry = entries_[index];
    if (entry.isDrawn) return true;
    if (frame_->sink.want(entry.node, priorityOf(index), Use::StandIn) !=
        cache::PageState::Resident) {
        return false;
    }
    entry.isDrawn = true;
    frame_->sink.draw(entry.node, Use::StandIn);
    return true;
}

// How far the parent's error exceeds what is allowed: how badly the node is missed.
double SlabsStrategy::excessOf(uint32_t index) const {
    const uint32_t parent = entries_[index].parent;
    if (parent == kNoParent || !(frame_->tauPx > 0.0)) return 1.0;
    return entries_[parent].ssePx / frame_->tauPx;
}

// The pixels of a ball of the box's diagonal, at most the picture's: cells say that a node is seen,
// not how much of it.
double SlabsStrategy::priorityOf(uint32_t index) const {
    const View& view = frame_->view;
    const Box3d& box = *entries_[index].node.boxModel;
    const double sidePx = view.ssePx(glm::length(box.max - box.min), box);
    const double picturePx = 1.0 * view.camera().widthPx * view.camera().heightPx;
    return requestPriority(std::min(sidePx * sidePx, picturePx), excessOf(index));
}

void SlabsStrategy::remember() {
    for (const Entry& entry : entries_) {
        *entry.memory = {frameNumber_, entry.isSeen, entry.isSeen && entry.role == Role::Refined};
        if (entry.isListed && !entry.isSeen && entry.probeLevel == 0) {
            frame_->sink.hide(entry.node);
        }
    }
}

}  // namespace

std::unique_ptr<Strategy> makeSlabsStrategy(const StrategyOptions& options) {
    return std::make_unique<SlabsStrategy>(options.slabs);
}

}  // namespace pagoda::hlod
