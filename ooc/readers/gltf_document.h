// gltf_document.h: a glTF file without its buffers: JSON checked by us, then parsed by tinygltf.
// tinygltf trusts what it reads (it loads whatever a URI names, recurses over extras, drops broken
// primitives silently, refuses buffers without URI that meshopt compression leaves behind), so it
// is given only fields that are known and sound; buffers, images and meshopt views stay here.
#pragma once

#include "ooc/readers/source_file.h"

#include <tiny_gltf.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pagoda::ooc::gltf {

// What to do about a document that breaks the specification.
inline constexpr const char* kValidate = "check it with the glTF validator, or export it again";

// "meshes[3]", "meshes[3].primitives[0]": places in the JSON, for errors.
[[nodiscard]] std::string place(const char* section, size_t index);
[[nodiscard]] std::string primitivePlace(size_t mesh, size_t primitive);

struct BufferSource {
    std::string uri;  // empty: the binary chunk if this is buffer 0 of a GLB, else nothing
    uint64_t sizeBytes = 0;
};

struct ImageSource {
    std::string uri;
    int bufferView = -1;  // used where there is no URI
};

// EXT_meshopt_compression or KHR_meshopt_compression of a buffer view.
struct MeshoptView {
    enum class Mode : uint8_t { Attributes, Triangles, Indices };
    enum class Filter : uint8_t { None, Octahedral, Quaternion, Exponential, Colour };
    int buffer = -1;
    uint64_t byteOffset = 0, byteLength = 0;
    uint64_t byteStride = 0, count = 0;
    Mode mode = Mode::Attributes;
    Filter filter = Filter::None;
};

// What the JSON says beyond tinygltf's model, and what of it is ignored.
struct Extras {
    std::vector<BufferSource> buffers;
    std::vector<ImageSource> images;
    std::vector<std::optional<MeshoptView>> meshopt;  // per buffer view
    std::vector<uint64_t> strides;                    // per buffer view; 0: tightly packed
    std::map<std::string, uint64_t> ignored;          // phrase -> count
};

// Every index in `model` points at something that exists; every number is finite; types and
// component types are those of the specification. Sizes are not checked against buffers.
struct Document {
    tinygltf::Model model;  // without buffers, images
    Extras extras;
    uint64_t binaryOffset = 0, binaryBytes = 0;  // the GLB's binary chunk in the file
};

// Throws Error with the place in the JSON, or the byte in the file.
[[nodiscard]] Document loadDocument(const SourceFile& source, uint64_t memoryBytes);

// Step 2 of loadDocument(): the checked JSON, reduced to what tinygltf is to see. `text` is UTF-8.
[[nodiscard]] std::string checkJson(const SourceFile& source, std::string_view text,
                                    Extras& extras);

}  // namespace pagoda::ooc::gltf
