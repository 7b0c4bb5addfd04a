// gltf_builder.h: little glTF files written by hand, one buffer as data URI, for tests.
#pragma once

#include "tests/ooc/readers/test_files.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace pagoda::ooc::test {

using Json = nlohmann::json;

inline std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t group = 0;
        for (size_t k = 0; k < 3; ++k) {
            const auto byte = i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u;
            group = group << 8 | byte;
        }
        for (size_t k = 0; k < 4; ++k) {
            const bool isPadding = i + k > bytes.size();
            text += isPadding ? '=' : kDigits[group >> (18 - 6 * k) & 63];
        }
    }
    return text;
}

// 2x2 pixels: red, green; blue, white of alpha 128.
inline constexpr const char* kFourColours =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAE0lEQVR42mP4z8DwHwyB"
    "NAg0AABJSQl4nFEXkgAAAABJRU5ErkJggg==";

// A document with one mesh of one primitive, "root" (the JSON) free for changes.
struct GltfBuilder {
    Json root = {{"asset", {{"version", "2.0"}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"nodes", {{{"mesh", 0}}}},
                 {"meshes", {{{"primitives", {{{"attributes", Json::object()}}}}}}},
                 {"accessors", Json::array()},
                 {"bufferViews", Json::array()}};
    std::string buffer;

    Json& primitive() { return root["meshes"][0]["primitives"][0]; }
    Json& node() { return root["nodes"][0]; }

    // Bytes as a new buffer view; returns its index.
    template <typename Scalar>
    size_t addView(const std::vector<Scalar>& values) {
        buffer.resize((buffer.size() + 3) / 4 * 4);
        const size_t bytes = values.size() * sizeof(Scalar);
        root["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes}});
        buffer.append(reinterpret_cast<const char*>(values.data()), bytes);
        return root["bufferViews"].size() - 1;
    }
    size_t addAccessor(size_t view, int componentType, const char* type, size_t count,
                       bool isNormalised = false) {
        root["accessors"].push_back({{"bufferView", view},
                                     {"componentType", componentType},
                                     {"type", type},
                                     {"count", count},
                                     {"normalized", isNormalised}});
        return root["accessors"].size() - 1;
    }
    // Floats, `components` an element.
    size_t addFloats(const std::vector<float>& values, size_t components) {
        constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
        return addAccessor(addView(values), 5126, kTypes[components], values.size() / components);
    }
    void setPositions(const std::vector<float>& values) {
        primitive()["attributes"]["POSITION"] = addFloats(values, 3);
    }
    // The triangle (0,0,0), (1,0,0), (0,1,0), seen from +z.
    void setTriangle() { setPositions({0, 0, 0, 1, 0, 0, 0, 1, 0}); }

    std::string text() {
        if (!buffer.empty()) {
            root["buffers"] = {{{"uri", "data:application/octet-stream;base64," + base64(buffer)},
                                {"byteLength", buffer.size()}}};
        }
        return root.dump();
    }
    std::filesystem::path write(const TempFolder& folder, const char* name = "test.gltf") {
        return folder.write(name, text());
    }
};

}  // namespace pagoda::ooc::test
