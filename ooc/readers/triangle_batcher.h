// triangle_batcher.h: collects triangles of one object and material, and hands them to the sink
// in batches of kBatchTriangles.
#pragma once

#include "ooc/readers/reader.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace pagoda::ooc {

// What a reader knows of a corner. A zero normal means none: the face's own stands in.
struct Corner {
    Vec3d position{0};
    uint32_t colour = 0xFFFFFFFFu;
    Vec3f normal{0};
};

class TriangleBatcher {
public:
    TriangleBatcher(TriangleSink& sink, bool hasColours, bool hasNormals);
    TriangleBatcher(const TriangleBatcher&) = delete;
    TriangleBatcher& operator=(const TriangleBatcher&) = delete;

    // Later triangles belong to these; hands on what belongs to others.
    void setTarget(uint32_t object, uint32_t material);

    // Drops and counts the triangle if a coordinate is not finite.
    void add(const Corner& a, const Corner& b, const Corner& c) {
        if (!addPositions(a.position, b.position, c.position)) return;
        if (hasColours_) {
            uint32_t* out = batch_.colours.data() + 3 * count_;
            out[0] = a.colour;
            out[1] = b.colour;
            out[2] = c.colour;
        }
        if (hasNormals_) addNormals(a, b, c);
        commit();
    }
    // The same for input without colours and normals (as the constructor was told).
    void add(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        if (addPositions(a, b, c)) commit();
    }
    void drop(DropReason reason, uint64_t triangles = 1) {
        dropped_[static_cast<size_t>(reason)] += triangles;
    }
    // Hands on what is left, then the dropped triangles by reason. Call it once, at the end.
    void finish();

    [[nodiscard]] bool hasColours() const noexcept { return hasColours_; }
    [[nodiscard]] bool hasNormals() const noexcept { return hasNormals_; }

private:
    bool addPositions(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        // A product with zero is NaN where a factor is NaN or infinite, and cannot overflow.
        const Vec3d probe = a * 0.0 + b * 0.0 + c * 0.0;
        if (!(probe.x + probe.y + probe.z == 0.0)) {
            drop(DropReason::NonFinite);
            return false;
        }
        Vec3d* out = batch_.positions.data() + 3 * count_;
        out[0] = a;
        out[1] = b;
        out[2] = c;
        return true;
    }
    void addNormals(const Corner& a, const Corner& b, const Corner& c);
    void commit() {
        if (++count_ == kBatchTriangles) flush();
    }
    void resize(size_t triangles);
    void flush();

    TriangleSink& sink_;
    bool hasColours_, hasNormals_;
    size_t count_ = 0;  // triangles in the batch, whose arrays are always full size
    TriangleBatch batch_;
    std::array<uint64_t, static_cast<size_t>(DropReason::Count)> dropped_{};
};

// Unit length, or zero where there is no direction.
[[nodiscard]] Vec3f unitNormal(double x, double y, double z);

}  // namespace pagoda::ooc
