// collecting_sink.h: a sink that keeps all it is given, for tests of readers on small files. It
// checks on the way what reader.h promises of every batch.
#pragma once

#include "ooc/readers/reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace pagoda::ooc::test {

struct CollectedTriangle {
    Vec3d corner[3];
    uint32_t colour[3];  // the batch's, or its material's where it has none
    Vec3f normal[3];     // zero: none
    uint32_t object, material;
    bool operator==(const CollectedTriangle&) const = default;
};

struct CollectingSink : TriangleSink {
    std::vector<ObjectInfo> objects;
    std::vector<MaterialInfo> materials;
    std::vector<CollectedTriangle> triangles;
    std::map<DropReason, uint64_t> drops;
    std::map<std::string, uint64_t> ignoredThings;
    uint64_t advancedBytes = 0, batches = 0;

    uint32_t addObject(const ObjectInfo& object) override {
        EXPECT_TRUE(object.parent == ObjectInfo::kNoParent || object.parent < objects.size());
        objects.push_back(object);
        return static_cast<uint32_t>(objects.size() - 1);
    }
    uint32_t addMaterial(const MaterialInfo& material) override {
        materials.push_back(material);
        return static_cast<uint32_t>(materials.size() - 1);
    }
    void addTriangles(const TriangleBatch& batch) override {
        ++batches;
        const size_t corners = batch.positions.size();
        ASSERT_GT(corners, 0u);
        ASSERT_EQ(corners % 3, 0u);
        ASSERT_TRUE(batch.colours.empty() || batch.colours.size() == corners);
        ASSERT_TRUE(batch.normals.empty() || batch.normals.size() == corners);
        ASSERT_LT(batch.object, objects.size());
        ASSERT_LT(batch.material, materials.size());
        for (size_t first = 0; first < corners; first += 3) {
            CollectedTriangle triangle{};
            triangle.object = batch.object;
            triangle.material = batch.material;
            for (size_t k = 0; k < 3; ++k) {
                triangle.corner[k] = batch.positions[first + k];
                triangle.colour[k] = batch.colours.empty() ? materials[batch.material].colour
                                                           : batch.colours[first + k];
                if (batch.normals.empty()) continue;
                triangle.normal[k] = batch.normals[first + k];
                EXPECT_NEAR(glm::length(triangle.normal[k]), 1.0f, 1e-5f);
            }
            triangles.push_back(triangle);
        }
    }
    void dropped(DropReason reason, uint64_t count) override { drops[reason] += count; }
    void ignored(std::string_view what, uint64_t count) override {
        ignoredThings[std::string(what)] += count;
    }
    void advance(uint64_t bytes) override { advancedBytes += bytes; }

    [[nodiscard]] uint64_t droppedCount() const {
        uint64_t sum = 0;
        for (const auto& [reason, count] : drops) sum += count;
        return sum;
    }
    // Delivered and dropped: what stats.json calls `tris`.
    [[nodiscard]] uint64_t triangleCount() const { return triangles.size() + droppedCount(); }
    [[nodiscard]] double area() const {
        double sum = 0;
        for (const CollectedTriangle& t : triangles) {
            sum +=
                glm::length(glm::cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0])) / 2;
        }
        return sum;
    }
    [[nodiscard]] Box3d box() const {
        Box3d box;
        for (const CollectedTriangle& t : triangles) {
            for (const Vec3d& corner : t.corner) box.extend(corner);
        }
        return box;
    }
};

// Reads a file once into a sink.
[[nodiscard]] inline CollectingSink readAll(const std::filesystem::path& path,
                                            const ReaderOptions& options = {}) {
    CollectingSink sink;
    openReader(path, options)->read(sink);
    return sink;
}

}  // namespace pagoda::ooc::test
