// obj_materials.h: material libraries (MTL) of OBJ files: diffuse colour and dissolve.
#pragma once

#include "ooc/readers/reader.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace pagoda::ooc {

class ObjMaterials {
public:
    struct Material {
        MaterialInfo info;
        bool hasTexture = false;
    };

    // Adds the materials of the libraries that a mtllib line names, relative to `objFolder`. A name
    // may hold spaces: the whole line is tried first, then its words. What cannot be read is
    // counted.
    void addLibraries(const std::filesystem::path& objFolder, std::string_view names);

    // Null: no library defines it.
    [[nodiscard]] const Material* find(std::string_view name) const;
    // Every path that addLibraries() looked at.
    [[nodiscard]] const std::set<std::filesystem::path>& lookedAt() const noexcept {
        return lookedAt_;
    }
    [[nodiscard]] uint64_t missingLibraries() const noexcept { return missing_; }
    // Materials that say they are wholly transparent: taken as opaque, as nothing would be seen
    // (exporters disagree on which end of Tr and d is which).
    [[nodiscard]] uint64_t invisibleMaterials() const noexcept { return invisible_; }

private:
    bool addLibrary(const std::filesystem::path& path);
    void finish(const std::string& name, const Material& material, double dissolve);

    std::map<std::string, Material, std::less<>> materials_;
    std::set<std::filesystem::path> lookedAt_;
    uint64_t missing_ = 0, invisible_ = 0;
};

}  // namespace pagoda::ooc
