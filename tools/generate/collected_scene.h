// collected_scene.h: a whole model in memory, for measuring it. 44 bytes a triangle.
#pragma once

#include "ooc/readers/reader.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::tools {

class CollectedScene final : public ooc::TriangleSink {
public:
    uint32_t addObject(const ooc::ObjectInfo& object) override {
        objects.push_back(object);
        return static_cast<uint32_t>(objects.size() - 1);
    }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override {
        materials.push_back(material);
        return static_cast<uint32_t>(materials.size() - 1);
    }
    void addTriangles(const ooc::TriangleBatch& batch) override {
        for (const Vec3d& position : batch.positions) corners.emplace_back(position);
        objectOf.insert(objectOf.end(), batch.triangleCount(), batch.object);
        materialOf.insert(materialOf.end(), batch.triangleCount(), batch.material);
    }
    void dropped(ooc::DropReason, uint64_t) override {}
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t) override {}

    [[nodiscard]] size_t triangleCount() const { return objectOf.size(); }
    [[nodiscard]] bool isTranslucent(size_t triangle) const {
        return materials[materialOf[triangle]].isTranslucent;
    }

    std::vector<ooc::ObjectInfo> objects;
    std::vector<ooc::MaterialInfo> materials;
    std::vector<Vec3f> corners;  // 3 a triangle
    std::vector<uint32_t> objectOf, materialOf;
};

}  // namespace pagoda::tools
