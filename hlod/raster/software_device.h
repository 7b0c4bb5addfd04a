// software_device.h: draws frames on the CPU, without shading: depths and ids, and exact answers at
// once. For tests, soaks and machines without GL: the same frames as on GL go through the same
// cache, strategies and runner. Zippers and translucent parts are left out. Render thread only.
#pragma once

#include "hlod/raster/box_raster.h"
#include "hlod/raster/triangle_raster.h"
#include "hlod/view/device.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace pagoda::hlod {

class SoftwareDevice final : public Device {
public:
    // `lattice` is the scene's; pages of one database.
    SoftwareDevice(const ooc::Lattice& lattice, uint64_t gpuBudgetBytes)
        : pages_(gpuBudgetBytes), raster_(lattice), queries_(raster_), pyramid_(raster_) {}

    [[nodiscard]] SoftwarePages& pages() noexcept { return pages_; }
    // Is there counting at all, and is asking whether an answer is there free? From now on.
    void setCounting(bool isThere, bool isPollFree) {
        hasCounting_ = isThere;
        queries_.isPollFree_ = isPollFree;
    }

    void beginFrame(const View& view) override;
    void draw(const Node& node) override;
    [[nodiscard]] bool drawsOnCpu() const override { return true; }
    [[nodiscard]] CountingVisibility* counting() override {
        return hasCounting_ ? &queries_ : nullptr;
    }
    [[nodiscard]] PyramidVisibility* pyramid() override { return &pyramid_; }
    void endFrame(const FrameCut& cut, FrameRecord& record) override;

    // The last frame's.
    [[nodiscard]] const SoftwarePicture& picture() const noexcept { return raster_.picture(); }

private:
    // Boxes are counted when they are asked about.
    class Queries final : public CountingVisibility {
    public:
        explicit Queries(const TriangleRaster& drawn) : drawn_(drawn) {}
        void beginFrame(const View& view);
        [[nodiscard]] QueryTicket query(const QueryShape& shape) override;
        [[nodiscard]] std::optional<uint64_t> poll(QueryTicket ticket) override {
            return wait(ticket);
        }
        [[nodiscard]] uint64_t wait(QueryTicket ticket) override;
        void abandonAll() override { answers_.clear(); }
        [[nodiscard]] bool isPollFree() const override { return isPollFree_; }
        bool isPollFree_ = false, isStale_ = true;  // stale: drawn since
        uint64_t queries_ = 0;

    private:
        const TriangleRaster& drawn_;
        const View* view_ = nullptr;  // of this frame
        BoxRaster boxes_;
        uint64_t nextTicket_ = 1;
        std::unordered_map<uint64_t, uint64_t> answers_;
    };
    // Keeps its own depths: what is drawn after build() hides nothing.
    class Pyramid final : public PyramidVisibility {
    public:
        explicit Pyramid(const TriangleRaster& drawn) : drawn_(drawn) {}
        void beginFrame(const View& view) { view_ = &view; }
        void build() override;
        void visiblePixels(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) override {
            boxes_.visiblePixels(boxesModel, pixels);
        }

    private:
        const TriangleRaster& drawn_;
        const View* view_ = nullptr;
        std::vector<float> depths_;
        BoxRaster boxes_;
    };

    SoftwarePages pages_;
    TriangleRaster raster_;
    Queries queries_;
    Pyramid pyramid_;
    bool hasCounting_ = true;
    uint64_t drawnNodes_ = 0, drawnTriangles_ = 0;
};

}  // namespace pagoda::hlod
