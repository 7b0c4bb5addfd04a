// embree_reference.h: a picture's depth by casting a ray through each pixel's centre with Embree:
// shares nothing with the renderer but the camera's definition. Triangles come straight from the
// readers.
#pragma once

#include "hlod/view/camera.h"
#include "ooc/readers/reader.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <vector>

namespace pagoda::test {

// Every opaque triangle of a file, corners in model units.
class TriangleCollector final : public ooc::TriangleSink {
public:
    std::vector<Vec3d> corners;

    uint32_t addObject(const ooc::ObjectInfo&) override { return objects_++; }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override {
        isTranslucent_.push_back(material.isTranslucent);
        return static_cast<uint32_t>(isTranslucent_.size() - 1);
    }
    void addTriangles(const ooc::TriangleBatch& batch) override {
        if (batch.material < isTranslucent_.size() && isTranslucent_[batch.material]) return;
        corners.insert(corners.end(), batch.positions.begin(), batch.positions.end());
    }
    void dropped(ooc::DropReason, uint64_t) override {}
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t) override {}

    static std::vector<Vec3d> read(const std::filesystem::path& path) {
        TriangleCollector sink;
        ooc::openReader(path, {})->read(sink);
        return std::move(sink.corners);
    }

private:
    uint32_t objects_ = 0;
    std::vector<bool> isTranslucent_;
};

// Rays start at the eye; the scene is moved there in double first, as Embree works in float.
class EmbreeReference {
public:
    EmbreeReference(const std::vector<Vec3d>& corners, const hlod::View& view)
        : view_(view), device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* const vertices = static_cast<float*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    3 * sizeof(float), corners.size()));
        auto* const indices = static_cast<unsigned*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(unsigned), corners.size() / 3));
        for (size_t i = 0; i < corners.size(); ++i) {
            const Vec3d relative = corners[i] - view.eye();
            for (int axis = 0; axis < 3; ++axis) {
                vertices[3 * i + static_cast<size_t>(axis)] = static_cast<float>(relative[axis]);
            }
            indices[i] = static_cast<unsigned>(i);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene_);
    }
    ~EmbreeReference() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeReference(const EmbreeReference&) = delete;
    EmbreeReference& operator=(const EmbreeReference&) = delete;

    // Distance along the direction of view at a point of the picture (pixel (0,0)'s centre is 0.5,
    // 0.5); infinite for nothing.
    [[nodiscard]] double depthAt(double x, double y) const {
        const hlod::Camera& camera = view_.camera();
        const Vec3d direction = view_.forward() +
                                (2 * x / camera.widthPx - 1) * view_.tanX() * view_.right() +
                                (1 - 2 * y / camera.heightPx) * view_.tanY() * view_.up();
        RTCRayHit hit{};
        hit.ray.dir_x = static_cast<float>(direction.x);
        hit.ray.dir_y = static_cast<float>(direction.y);
        hit.ray.dir_z = static_cast<float>(direction.z);
        hit.ray.tfar = std::numeric_limits<float>::infinity();
        hit.ray.mask = ~0u;
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_, &context, &hit);
        if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID)
            return std::numeric_limits<double>::infinity();
        return static_cast<double>(hit.ray.tfar);  // the direction is 1 along the view
    }

    // Does the picture change within `radius` pixels of this point: a silhouette, or an edge in
    // depth?
    [[nodiscard]] bool isNearEdge(double x, double y, double radius, double relativeDepth) const {
        const double centre = depthAt(x, y);
        for (int i = 0; i < 8; ++i) {
            const double angle = i * 0.78539816339744831;
            const double depth =
                depthAt(x + radius * std::cos(angle), y + radius * std::sin(angle));
            if (std::isinf(depth) != std::isinf(centre)) return true;
            if (!std::isinf(depth) && std::abs(depth - centre) > relativeDepth * centre)
                return true;
        }
        return false;
    }

private:
    const hlod::View& view_;
    RTCDevice device_;
    RTCScene scene_;
};

}  // namespace pagoda::test
