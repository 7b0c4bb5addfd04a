#include "ooc/readers/gltf_document.h"

#include "ooc/base/error.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <limits>
#include <span>

namespace pagoda::ooc::gltf {
namespace {

constexpr uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr uint32_t kBinaryChunk = 0x004E4942;
constexpr const char* kExportAgain = "copy it again, or export it again";
constexpr uint64_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
// A DOM takes up to about 24 times its text ("{},{},"): the JSON may use a part of the memory only.
constexpr uint64_t kMemoryPerJsonByte = 32;

uint32_t readUint32(const SourceFile& source, uint64_t offset) {
    std::array<unsigned char, 4> bytes{};
    source.file().readAt(offset, std::as_writable_bytes(std::span(bytes)));
    return uint32_t{bytes[0]} | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 |
           uint32_t{bytes[3]} << 24;
}

struct Range {
    uint64_t offset = 0, length = 0;
};

// Finds the JSON text and the binary chunk of a GLB.
Range findChunks(const SourceFile& source, Document& document) {
    if (source.sizeBytes() < kHeaderBytes) source.failCutShort("byte 0", "no GLB header");
    const uint32_t version = readUint32(source, 4);
    if (version != 2) {
        source.failAtByte(4, "GLB version " + std::to_string(version) + ", not 2",
                          "convert it to glTF 2.0");
    }
    const uint64_t length = readUint32(source, 8);
    if (length > source.sizeBytes()) {
        source.failCutShort("byte 8", "the header says " + std::to_string(length) + " bytes, the " +
                                          "file has " + std::to_string(source.sizeBytes()));
    }
    if (length < source.sizeBytes()) document.extras.ignored["bytes after the GLB"] = 1;

    Range json;
    uint64_t chunk = 0;
    for (uint64_t at = kHeaderBytes; at + kChunkHeaderBytes <= length; ++chunk) {
        const uint64_t size = readUint32(source, at);
        const uint32_t kind = readUint32(source, at + 4);
        const uint64_t data = at + kChunkHeaderBytes;
        if (size > length - data)
            source.failAtByte(at, "chunk reaches beyond the file", kExportAgain);
        if (chunk == 0 && kind != kJsonChunk)
            source.failAtByte(at, "first chunk is not JSON", kExportAgain);
        if (chunk == 0) {
            json = {data, size};
        } else if (chunk == 1 && kind == kBinaryChunk) {
            document.binaryOffset = data;
            document.binaryBytes = size;
        } else {
            ++document.extras.ignored["GLB chunk of unknown kind or place"];
        }
        at = data + size;
    }
    if (chunk == 0) source.failAtByte(kHeaderBytes, "GLB without a JSON chunk", kExportAgain);
    return json;
}

std::string readText(const SourceFile& source, const Range& range, uint64_t memoryBytes) {
    const uint64_t limit =
        std::min<uint64_t>(memoryBytes / kMemoryPerJsonByte, std::numeric_limits<uint32_t>::max());
    if (range.length > limit) {
        source.fail("",
                    "the JSON has " + std::to_string(range.length) + " bytes, more than the " +
                        std::to_string(limit) + " that the memory limit leaves it",
                    "raise --memory");
    }
    std::string text(range.length, '\0');
    source.file().readAt(range.offset, std::as_writable_bytes(std::span(text)));
    return text;
}

void parse(const SourceFile& source, const std::string& text, Document& document) {
    tinygltf::TinyGLTF loader;
    std::string errors, warnings;
    bool isLoaded = false;
    try {
        isLoaded = loader.LoadASCIIFromString(&document.model, &errors, &warnings, text.data(),
                                              static_cast<unsigned>(text.size()), "");
    } catch (const std::exception& failure) {
        errors = failure.what();
    }
    if (isLoaded) return;
    std::ranges::replace(errors, '\n', ' ');
    source.fail("JSON", "not understood by tinygltf: " + errors, kValidate);
}

}  // namespace

std::string place(const char* section, size_t index) {
    return std::string(section) + "[" + std::to_string(index) + "]";
}

std::string primitivePlace(size_t mesh, size_t primitive) {
    return place("meshes", mesh) + "." + place("primitives", primitive);
}

Document loadDocument(const SourceFile& source, uint64_t memoryBytes) {
    if (source.sizeBytes() == 0) source.failCutShort("byte 0", "empty file");
    Document document;
    Range range{0, source.sizeBytes()};
    if (source.sizeBytes() >= 4 && readUint32(source, 0) == kMagic) {
        range = findChunks(source, document);
    }
    const std::string checked =
        checkJson(source, readText(source, range, memoryBytes), document.extras);
    parse(source, checked, document);

    tinygltf::Model& model = document.model;
    const size_t views = document.extras.meshopt.size();
    for (size_t i = 0; i < views; ++i) model.bufferViews[i].byteStride = document.extras.strides[i];
    // checkJson() gave indices without a view (Draco) one past the end, which tinygltf insists on.
    for (tinygltf::Accessor& accessor : model.accessors) {
        if (accessor.bufferView >= 0 && static_cast<size_t>(accessor.bufferView) >= views) {
            accessor.bufferView = -1;
        }
    }
    return document;
}

}  // namespace pagoda::ooc::gltf
