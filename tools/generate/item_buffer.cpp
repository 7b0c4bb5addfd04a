#include "tools/generate/item_buffer.h"

#include <algorithm>
#include <cmath>

namespace pagoda::tools {
namespace {

constexpr double kHalfHeightTangent = 0.57735026918962573;  // of 30 degrees

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const size_t middle = values.size() / 2;
    return values.size() % 2 != 0 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

}  // namespace

ItemBuffer::ItemBuffer(int width, int height) : width_(width), height_(height) {
}

void ItemBuffer::draw(const CollectedScene& scene, const Viewpoint& from) {
    const size_t pixels = static_cast<size_t>(width_) * static_cast<size_t>(height_);
    ids_.assign(pixels, kNothing);
    depths_.assign(pixels, 0.0f);
    seenThrough_.clear();
    inFrustum_ = 0;

    eye_ = from.eye;
    forward_ = glm::normalize(from.target - from.eye);
    const Vec3d up = std::abs(forward_.z) < 0.999 ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0);
    const double scale = height_ / 2.0 / kHalfHeightTangent;  // pixels a unit of slope
    right_ = glm::normalize(glm::cross(forward_, up));
    down_ = glm::cross(forward_, right_) * scale;
    right_ *= scale;
    for (const bool isTranslucent : {false, true}) {
        for (size_t t = 0; t < scene.triangleCount(); ++t) {
            if (scene.isTranslucent(t) == isTranslucent) {
                drawTriangle(&scene.corners[3 * t], static_cast<uint32_t>(t), isTranslucent);
            }
        }
    }
}

void ItemBuffer::drawTriangle(const Vec3f* corners, uint32_t id, bool isTranslucent) {
    Corner view[3];
    unsigned outside = ~0u;
    for (int i = 0; i < 3; ++i) {
        const Vec3d local = Vec3d(corners[i]) - eye_;
        const double w = glm::dot(local, forward_);
        const double x = glm::dot(local, right_) + w * width_ / 2;
        const double y = glm::dot(local, down_) + w * height_ / 2;
        view[i] = {x, y, w};
        outside &= (x < 0 ? 1u : 0u) | (x > w * width_ ? 2u : 0u) | (y < 0 ? 4u : 0u) |
                   (y > w * height_ ? 8u : 0u) | (w < kNearMetres ? 16u : 0u);
    }
    if (outside != 0) return;
    ++inFrustum_;
    Corner clipped[4];
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        const Corner& a = view[i];
        const Corner& b = view[(i + 1) % 3];
        if (a.w >= kNearMetres) clipped[count++] = a;
        if ((a.w >= kNearMetres) == (b.w >= kNearMetres)) continue;
        const double t = (kNearMetres - a.w) / (b.w - a.w);
        clipped[count++] = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), kNearMetres};
    }
    for (int i = 1; i + 1 < count; ++i) {
        drawClipped(clipped[0], clipped[i], clipped[i + 1], id, isTranslucent);
    }
}

void ItemBuffer::drawClipped(const Corner& a, const Corner& b, const Corner& c, uint32_t id,
                             bool isTranslucent) {
    const double ax = a.x / a.w, ay = a.y / a.w, bx = b.x / b.w, by = b.y / b.w, cx = c.x / c.w,
                 cy = c.y / c.w;
    const double area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (area == 0) return;
    const int x0 = static_cast<int>(
        std::clamp(std::ceil(std::min({ax, bx, cx}) - 0.5), 0.0, static_cast<double>(width_)));
    const int y0 = static_cast<int>(
        std::clamp(std::ceil(std::min({ay, by, cy}) - 0.5), 0.0, static_cast<double>(height_)));
    const int x1 = static_cast<int>(
        std::clamp(std::floor(std::max({ax, bx, cx}) + 0.5), 0.0, static_cast<double>(width_)));
    const int y1 = static_cast<int>(
        std::clamp(std::floor(std::max({ay, by, cy}) + 0.5), 0.0, static_cast<double>(height_)));
    const double inverse = 1 / area;
    for (int y = y0; y < y1; ++y) {
        const double py = y + 0.5;
        for (int x = x0; x < x1; ++x) {
            const double px = x + 0.5;
            const double u = ((bx - px) * (cy - py) - (by - py) * (cx - px)) * inverse;
            const double v = ((cx - px) * (ay - py) - (cy - py) * (ax - px)) * inverse;
            const double w = 1 - u - v;
            if (u < 0 || v < 0 || w < 0) continue;
            const float depth = static_cast<float>(u / a.w + v / b.w + w / c.w);
            const size_t pixel =
                static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
            if (depth <= depths_[pixel]) continue;
            if (isTranslucent) {
                if (seenThrough_.empty() || seenThrough_.back() != id) seenThrough_.push_back(id);
                continue;
            }
            depths_[pixel] = depth;
            ids_[pixel] = id;
        }
    }
}

uint64_t ItemBuffer::visibleCount() const {
    std::vector<uint32_t> seen(ids_.begin(), ids_.end());
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    if (!seen.empty() && seen.back() == kNothing) seen.pop_back();
    return seen.size() + seenThrough_.size();
}

VisibleShare measureVisibleShare(const CollectedScene& scene, std::span<const Viewpoint> views,
                                 int width, int height) {
    ItemBuffer buffer(width, height);
    std::vector<double> shares, inFrustum, visible;
    for (const Viewpoint& view : views) {
        buffer.draw(scene, view);
        if (buffer.inFrustumCount() == 0) continue;
        inFrustum.push_back(static_cast<double>(buffer.inFrustumCount()));
        visible.push_back(static_cast<double>(buffer.visibleCount()));
        shares.push_back(visible.back() / inFrustum.back());
    }
    VisibleShare result;
    if (shares.empty()) return result;
    result.largest = *std::max_element(shares.begin(), shares.end());
    result.median = median(shares);
    result.medianInFrustum = median(inFrustum);
    result.medianVisible = median(visible);
    return result;
}

}  // namespace pagoda::tools
