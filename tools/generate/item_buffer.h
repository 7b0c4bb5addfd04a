// item_buffer.h: which triangle shows at each pixel: a small software z-buffer.
// For measuring scenes and for tests; no GL. Perspective, 60 degrees from bottom to top, z up; both
// sides of triangles count. Triangles nearer than kNearMetres are clipped there.
#pragma once

#include "tools/generate/collected_scene.h"
#include "tools/generate/generator.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::tools {

class ItemBuffer {
public:
    static constexpr uint32_t kNothing = UINT32_MAX;
    static constexpr double kNearMetres = 0.05;

    ItemBuffer(int width, int height);

    // Draws the opaque triangles, then tests the translucent ones, which hide nothing.
    void draw(const CollectedScene& scene, const Viewpoint& from);

    [[nodiscard]] int width() const noexcept { return width_; }
    [[nodiscard]] int height() const noexcept { return height_; }
    // The nearest opaque triangle of each pixel, rows from the top.
    [[nodiscard]] std::span<const uint32_t> ids() const noexcept { return ids_; }
    // 1 / distance along the view axis; 0 where there is nothing.
    [[nodiscard]] std::span<const float> inverseDepths() const noexcept { return depths_; }
    // Triangles with a pixel, translucent ones in front of the opaque included.
    [[nodiscard]] uint64_t visibleCount() const;
    // Triangles not wholly outside one of the frustum's planes.
    [[nodiscard]] uint64_t inFrustumCount() const noexcept { return inFrustum_; }

private:
    struct Corner {
        double x, y, w;  // pixels times w; distance along the view axis
    };

    void drawTriangle(const Vec3f* corners, uint32_t id, bool isTranslucent);
    void drawClipped(const Corner& a, const Corner& b, const Corner& c, uint32_t id,
                     bool isTranslucent);

    int width_, height_;
    std::vector<uint32_t> ids_;
    std::vector<float> depths_;
    std::vector<uint32_t> seenThrough_;  // translucent triangles with a pixel
    uint64_t inFrustum_ = 0;
    Vec3d eye_{0.0}, right_{0.0}, down_{0.0}, forward_{0.0};
};

// Visible triangles over triangles in the frustum, median over the viewpoints; 0 without any.
struct VisibleShare {
    double median = 0, largest = 0;
    double medianInFrustum = 0, medianVisible = 0;
};
[[nodiscard]] VisibleShare measureVisibleShare(const CollectedScene& scene,
                                               std::span<const Viewpoint> views, int width,
                                               int height);

}  // namespace pagoda::tools
