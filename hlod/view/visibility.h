// visibility.h: how a strategy asks what is seen. Stated here; implemented by GL queries (viewer/),
// a software rasteriser (hlod/raster/) and tests. A strategy either waits or treats an unknown
// answer as visible, never as hidden: pictures stay right at every latency. A box that holds the
// eye or crosses the near plane is visible, unasked (View::crossesNear). Render thread only.
#pragma once

#include "hlod/view/node_tree.h"
#include "ooc/base/box.h"

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace pagoda::hlod {

// A box in model units. `axes` are orthonormal; the identity for an axis-aligned one.
struct OrientedBox {
    Vec3d centre{0.0}, halfSize{0.0};
    glm::dmat3 axes{1.0};
};

// What is tested: a box (axis-aligned or oriented), a resident node's own mesh (paper 000), or
// boxes together: their pixels added up, those in front of each other too.
using QueryShape = std::variant<Box3d, OrientedBox, Node, std::vector<Box3d>>;

struct QueryTicket {
    uint64_t value = 0;
    [[nodiscard]] bool operator==(const QueryTicket&) const = default;
};

// Counts pixels of shapes that pass the depth test against what was drawn before the query. A
// ticket is answered once: poll() or wait() that gives the answer spends it.
class CountingVisibility {
public:
    virtual ~CountingVisibility() = default;
    [[nodiscard]] virtual QueryTicket query(const QueryShape& shape) = 0;
    // Visible pixels, or nullopt while pending. An answer delayed by F frames is pending until F
    // later frames have begun.
    [[nodiscard]] virtual std::optional<uint64_t> poll(QueryTicket ticket) = 0;
    // The answer, now.
    [[nodiscard]] virtual uint64_t wait(QueryTicket ticket) = 0;
    // All tickets that were not answered yet are void: nobody will ask about them.
    virtual void abandonAll() {}
    // Is poll() free? Where it makes the device begin what it would rather gather, it is not.
    [[nodiscard]] virtual bool isPollFree() const { return false; }
};

// Tests boxes against a pyramid of the depths drawn so far.
class PyramidVisibility {
public:
    virtual ~PyramidVisibility() = default;
    // Takes the depths of all that was drawn so far.
    virtual void build() = 0;
    // For each box, none of which crosses the near plane: 0 only when it is hidden by what was
    // drawn before build(); else an estimate, from above, of its visible pixels. `pixels` has as
    // many places as there are boxes. A call may wait for the device: ask many at once.
    virtual void visiblePixels(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) = 0;
};

// Pixels [minX, maxX) x [minY, maxY), from the top left.
struct PixelRect {
    int minX = 0, minY = 0, maxX = 0, maxY = 0;
};

// Asks the depth of what was drawn so far (paper 001).
class DepthVisibility {
public:
    virtual ~DepthVisibility() = default;
    // Is any pixel of the rectangle still background?
    [[nodiscard]] virtual bool anyFree(const PixelRect& rectangle) = 0;
    // Greatest view-space depth in the rectangle, model units; infinite where anything is free.
    [[nodiscard]] virtual double maxDepth(const PixelRect& rectangle) = 0;
};

}  // namespace pagoda::hlod
