// box_queries.h: occlusion queries by GL: one query object a box, from a pool. Boxes are drawn
// relative to the eye, front faces only (each pixel counts once), grown by half a pixel and 1e-5 of
// their distance and tested with GEQUAL, so that a box never hides behind its own content
// (rounding and subpixel snap). Render thread only, context current.
#pragma once

#include "hlod/view/visibility.h"
#include "viewer/gl_names.h"
#include "viewer/lattice_view.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace pagoda::viewer {

class BoxQueries final : public hlod::CountingVisibility {
public:
    // `flushDraws` draws what is still gathered, leaving the state of opaque drawing; called before
    // each query. `restoreState` goes back to that state after a box. `isPollFree`: see
    // CountingVisibility.
    BoxQueries(std::function<void()> flushDraws, std::function<void()> restoreState,
               bool isPollFree);
    ~BoxQueries() override;
    BoxQueries(const BoxQueries&) = delete;
    BoxQueries& operator=(const BoxQueries&) = delete;

    void beginFrame(const hlod::View& view, const LatticeView& latticeView,
                    const ooc::Lattice& lattice);

    // Of boxes along the axes, one or more; other shapes are not implemented here.
    [[nodiscard]] hlod::QueryTicket query(const hlod::QueryShape& shape) override;
    [[nodiscard]] std::optional<uint64_t> poll(hlod::QueryTicket ticket) override;
    [[nodiscard]] uint64_t wait(hlod::QueryTicket ticket) override;
    void abandonAll() override { freeNames_ = names_; }
    [[nodiscard]] bool isPollFree() const override { return isPollFree_; }

    [[nodiscard]] uint64_t queriesThisFrame() const noexcept { return queries_; }
    [[nodiscard]] double msThisFrame() const noexcept { return ms_; }  // issuing and waiting

private:
    [[nodiscard]] GlId takeName();
    void drawBox(const Box3d& boxModel);

    std::function<void()> flushDraws_, restoreState_;
    bool isPollFree_;
    GlProgram program_;
    GlVertexArray emptyArray_;
    std::vector<GlId> freeNames_, names_;  // names_: all that were made
    Vec3d eyeModel_{0.0};
    double stepModel_ = 1.0;
    double pixelPerDistance_ = 0.0;  // half a pixel's size at distance 1
    uint64_t queries_ = 0;
    double ms_ = 0.0;
};

}  // namespace pagoda::viewer
