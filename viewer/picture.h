// picture.h: what a frame leaves behind, in host memory, and how it is written to files.
// Rows run from top to bottom. Formats of depth and ids: docs/frame.md.
#pragma once

#include "hlod/view/camera.h"
#include "ooc/node_id.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pagoda::viewer {

// Colours of the picture behind the model, sRGB, 0..255, top and bottom row.
struct Background {
    glm::u8vec3 top{112, 121, 131}, bottom{58, 62, 67};
};

struct Picture {
    int widthPx = 0, heightPx = 0;
    std::vector<uint8_t> colours;  // RGBA sRGB; alpha is how much the model covers
    std::vector<float>
        depthsModelUnits;  // along the direction of view; infinite for no opaque surface
    std::vector<uint32_t>
        nodeOrdinals;  // of the opaque surface; 0 for none, else 1 + index into nodes
    std::vector<uint32_t> triangles;  // its number in the node's page; beyond them, zippers
    std::vector<ooc::NodeId> nodes;

    [[nodiscard]] size_t pixelCount() const { return colours.size() / 4; }
    // Pixels that anything was drawn on, translucent or not.
    [[nodiscard]] uint64_t coveredPixels() const;
};

// All throw Error when the file cannot be written. An existing file is replaced.
void writePng(const Picture& picture, const std::filesystem::path& path);    // 8-bit RGB
void writeDepth(const Picture& picture, const std::filesystem::path& path);  // PFM
void writeIds(const Picture& picture,
              const std::filesystem::path& path);  // raw, and path + ".json"

}  // namespace pagoda::viewer
