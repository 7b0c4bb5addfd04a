#include "ooc/readers/obj_materials.h"

#include "ooc/base/error.h"
#include "ooc/readers/source_file.h"
#include "ooc/readers/text_scan.h"
#include "ooc/readers/text_stream.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pagoda::ooc {
namespace {

uint32_t channel(double value) {
    return value > 0.0 ? static_cast<uint32_t>(std::lround(std::min(value, 1.0) * 255.0)) : 0u;
}

// Names as Windows writes them.
std::filesystem::path localPath(const std::filesystem::path& folder, std::string_view name) {
    std::string text(name);
    std::ranges::replace(text, '\\', '/');
    return folder / text;
}

}  // namespace

void ObjMaterials::addLibraries(const std::filesystem::path& objFolder, std::string_view names) {
    if (names.empty() || addLibrary(localPath(objFolder, names))) return;
    TextCursor cursor(names);
    for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
        if (!addLibrary(localPath(objFolder, word))) ++missing_;
    }
}

const ObjMaterials::Material* ObjMaterials::find(std::string_view name) const {
    const auto found = materials_.find(name);
    return found == materials_.end() ? nullptr : &found->second;
}

// The first definition of a name stays.
void ObjMaterials::finish(const std::string& name, const Material& material, double dissolve) {
    Material done = material;
    done.info.name = toUtf8(name);
    uint32_t alpha = channel(dissolve);
    const bool isNew = !materials_.contains(name);
    if (alpha == 0) {
        alpha = 255;
        invisible_ += isNew ? 1 : 0;
    }
    done.info.colour = (done.info.colour & 0x00FFFFFFu) | alpha << 24;
    done.info.isTranslucent = alpha < 255;
    if (isNew) materials_.emplace(name, done);
}

bool ObjMaterials::addLibrary(const std::filesystem::path& path) {
    lookedAt_.insert(path);
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code)) return false;
    std::optional<SourceFile> source;
    try {
        source.emplace(path);
    } catch (const Error&) {  // one that may not be read does not cost the shape either
        return false;
    }
    TextStream text(*source, nullptr);
    std::optional<std::string> name;
    Material material;
    double dissolve = 1.0;
    bool hasDissolve = false;  // d beats Tr, which files use in both senses
    std::string_view line;
    while (text.next(line)) {
        TextCursor cursor(line);
        const std::string_view keyword = cursor.word();
        if (equalsIgnoringCase(keyword, "newmtl")) {
            if (name) finish(*name, material, dissolve);
            name = std::string(cursor.rest());
            material = {};
            dissolve = 1.0;
            hasDissolve = false;
        } else if (equalsIgnoringCase(keyword, "kd")) {
            Vec3d colour;
            if (!cursor.number(colour.x)) continue;  // "spectral", "xyz"
            if (!cursor.number(colour.y) || !cursor.number(colour.z)) colour = Vec3d(colour.x);
            material.info.colour =
                channel(colour.x) | channel(colour.y) << 8 | channel(colour.z) << 16;
        } else if (equalsIgnoringCase(keyword, "d")) {
            hasDissolve |= cursor.number(dissolve);  // "-halo" stays opaque
        } else if (equalsIgnoringCase(keyword, "tr") && !hasDissolve) {
            double transparency = 0;
            if (cursor.number(transparency)) dissolve = 1.0 - transparency;
        } else if (equalsIgnoringCase(keyword, "map_kd")) {
            material.hasTexture = true;
        }
    }
    if (name) finish(*name, material, dissolve);
    return true;
}

}  // namespace pagoda::ooc
