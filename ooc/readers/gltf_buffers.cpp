#include "ooc/readers/gltf_buffers.h"

#include "ooc/base/error.h"
#include "ooc/readers/gltf_files.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cstring>
#include <optional>

namespace pagoda::ooc::gltf {
namespace {

constexpr std::string_view kCutShort = "check that all files of the model were copied whole";

// Whether meshopt can be called at all: it asserts what we have to check.
const char* meshoptProblem(const MeshoptView& view) {
    using Mode = MeshoptView::Mode;
    using Filter = MeshoptView::Filter;
    if (view.mode != Mode::Attributes) {
        if (view.byteStride != 2 && view.byteStride != 4) return "has a byteStride not 2 or 4";
        if (view.mode == Mode::Triangles && view.count % 3 != 0) return "has a count not 3 times n";
        if (view.filter != Filter::None) return "has a filter, but no attributes";
        return nullptr;
    }
    if (view.byteStride == 0 || view.byteStride > 256 || view.byteStride % 4 != 0) {
        return "has a byteStride that is not a multiple of 4 up to 256";
    }
    if (view.filter == Filter::Octahedral && view.byteStride != 4 && view.byteStride != 8) {
        return "has filter OCTAHEDRAL, but a byteStride not 4 or 8";
    }
    if (view.filter == Filter::Quaternion && view.byteStride != 8) {
        return "has filter QUATERNION, but a byteStride not 8";
    }
    if (view.filter == Filter::Colour) return "has filter COLOR, which is not decoded";
    return nullptr;
}

bool decodeMeshopt(const MeshoptView& view, std::span<const std::byte> packed, std::byte* out) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(packed.data());
    const size_t count = view.count, stride = view.byteStride;
    using Filter = MeshoptView::Filter;
    switch (view.mode) {
        case MeshoptView::Mode::Triangles:
            return meshopt_decodeIndexBuffer(out, count, stride, bytes, packed.size()) == 0;
        case MeshoptView::Mode::Indices:
            return meshopt_decodeIndexSequence(out, count, stride, bytes, packed.size()) == 0;
        case MeshoptView::Mode::Attributes:
            break;
    }
    if (meshopt_decodeVertexBuffer(out, count, stride, bytes, packed.size()) != 0) return false;
    if (view.filter == Filter::Octahedral) meshopt_decodeFilterOct(out, count, stride);
    if (view.filter == Filter::Quaternion) meshopt_decodeFilterQuat(out, count, stride);
    if (view.filter == Filter::Exponential) meshopt_decodeFilterExp(out, count, stride);
    return true;
}

}  // namespace

void MemoryBudget::take(uint64_t bytes, const std::string& where) {
    if (bytes > limitBytes_ - usedBytes_) {
        constexpr uint64_t kMiB = uint64_t{1} << 20;
        source_.fail(where,
                     "needs " + std::to_string(bytes / kMiB + 1) + " MiB of memory beside " +
                         std::to_string(usedBytes_ / kMiB) +
                         " MiB already used, over the limit of " +
                         std::to_string(limitBytes_ / kMiB) + " MiB",
                     "raise --memory, or convert the model to PLY, OBJ or STL, which stream");
    }
    usedBytes_ += bytes;
}

Buffers::Buffers(const SourceFile& source, const Document& document, MemoryBudget& budget,
                 FileStamps& stamps)
    : source_(source), document_(document), budget_(budget), stamps_(stamps) {
}

std::span<const std::byte> Buffers::view(int bufferView) {
    const size_t index = static_cast<size_t>(bufferView);
    if (document_.extras.meshopt[index]) return decoded(bufferView);
    const tinygltf::BufferView& range = document_.model.bufferViews[index];
    const std::span<const std::byte> bytes = buffer(range.buffer);
    if (range.byteOffset > bytes.size() || range.byteLength > bytes.size() - range.byteOffset) {
        source_.fail(place("bufferViews", index),
                     "reaches beyond its buffer of " + std::to_string(bytes.size()) + " bytes",
                     std::string(kCutShort));
    }
    return bytes.subspan(range.byteOffset, range.byteLength);
}

std::span<const std::byte> Buffers::buffer(int index) {
    const auto found = buffers_.find(index);
    if (found != buffers_.end()) return found->second;
    const BufferSource& from = document_.extras.buffers[static_cast<size_t>(index)];
    const std::string where = place("buffers", static_cast<size_t>(index));
    std::vector<std::byte> bytes;
    if (!from.uri.empty()) {
        bytes = loadUri(from.uri, from.sizeBytes, where);
    } else if (index == 0 && document_.binaryOffset > 0) {
        if (document_.binaryBytes < from.sizeBytes) {
            source_.fail(where,
                         "has " + std::to_string(from.sizeBytes) + " bytes, but the binary chunk " +
                             std::to_string(document_.binaryBytes),
                         std::string(kCutShort));
        }
        budget_.take(from.sizeBytes, where);
        bytes.resize(from.sizeBytes);
        source_.file().readAt(document_.binaryOffset, bytes);
    } else {
        source_.fail(where, "has neither a uri nor a binary chunk", kValidate);
    }
    return buffers_[index] = std::move(bytes);
}

std::vector<std::byte> Buffers::loadUri(const std::string& uri, uint64_t expectedBytes,
                                        const std::string& where) {
    if (!uri.starts_with("data:")) return loadFile(uri, expectedBytes, where);
    const size_t comma = uri.find(',');
    if (comma == std::string::npos || !uri.substr(0, comma).ends_with(";base64")) {
        source_.fail(where + ".uri", "is a data URI, but not base64", kValidate);
    }
    MemoryLease copies(budget_);
    copies.take(4 * uri.size(), where);
    // tinygltf decodes a few media types only: it is always told the same one.
    std::vector<unsigned char> decoded;
    std::string mediaType;
    tinygltf::DecodeDataURI(&decoded, mediaType,
                            "data:application/octet-stream;base64," + uri.substr(comma + 1), 0,
                            false);
    if (decoded.size() < expectedBytes) {
        source_.fail(where,
                     "has " + std::to_string(expectedBytes) + " bytes, but its data URI " +
                         std::to_string(decoded.size()),
                     std::string(kCutShort));
    }
    const size_t size = expectedBytes == 0 ? decoded.size() : expectedBytes;
    budget_.take(size, where);
    std::vector<std::byte> bytes(size);
    if (size > 0) std::memcpy(bytes.data(), decoded.data(), size);
    return bytes;
}

std::vector<std::byte> Buffers::loadFile(const std::string& uri, uint64_t expectedBytes,
                                         const std::string& where) {
    const std::string name = percentDecoded(uri);
    const std::optional<std::filesystem::path> path = pathBeside(source_, uri);
    if (!path) {
        source_.fail(where + ".uri", "\"" + uri + "\" is not the name of a file beside the model",
                     "download it and name it by a relative path");
    }
    std::error_code problem;
    // Before it is opened: opening a FIFO would wait for ever.
    if (!std::filesystem::is_regular_file(*path, problem)) {
        source_.fail(where, "its file \"" + name + "\" is missing or not a regular file",
                     std::string(kCutShort));
    }
    const File file = File::openForReading(*path);
    const uint64_t stamp = file.changeStamp();
    if (stamps_.try_emplace(*path, stamp).first->second != stamp) {
        source_.fail(where, "its file \"" + name + "\" has changed since the first reading",
                     "start again");
    }
    const uint64_t fileBytes = file.sizeBytes();
    if (fileBytes < expectedBytes) {
        source_.fail(where,
                     "has " + std::to_string(expectedBytes) + " bytes, but its file \"" + name +
                         "\" " + std::to_string(fileBytes),
                     std::string(kCutShort));
    }
    const uint64_t size = expectedBytes == 0 ? fileBytes : expectedBytes;
    budget_.take(size, where);
    std::vector<std::byte> bytes(size);
    file.readAt(0, bytes);
    return bytes;
}

std::vector<std::byte> Buffers::imageFile(const std::string& uri, const std::string& where) {
    std::vector<std::byte> bytes = loadUri(uri, 0, where);
    budget_.give(bytes.size());
    return bytes;
}

std::span<const std::byte> Buffers::decoded(int bufferView) {
    const auto found = decodedViews_.find(bufferView);
    if (found != decodedViews_.end()) return found->second;
    const size_t index = static_cast<size_t>(bufferView);
    const MeshoptView& view = *document_.extras.meshopt[index];
    const std::string where = place("bufferViews", index) + " (meshopt compression)";
    if (const char* problem = meshoptProblem(view)) source_.fail(where, problem, kValidate);
    const std::span<const std::byte> all = buffer(view.buffer);
    if (view.byteOffset > all.size() || view.byteLength > all.size() - view.byteOffset) {
        source_.fail(where, "reaches beyond its buffer", std::string(kCutShort));
    }
    const std::span<const std::byte> packed = all.subspan(view.byteOffset, view.byteLength);
    if (view.count > budget_.freeBytes() / view.byteStride) {
        budget_.take(budget_.freeBytes() + 1, where);
    }
    budget_.take(view.count * view.byteStride, where);
    std::vector<std::byte> out(view.count * view.byteStride);
    if (!decodeMeshopt(view, packed, out.data())) {
        // 0xA0 is version 0 of the attribute codec; KHR_meshopt_compression also allows 0xA1.
        const bool isNewer = view.mode == MeshoptView::Mode::Attributes && !packed.empty() &&
                             packed[0] == std::byte{0xA1};
        source_.fail(where,
                     isNewer ? "is packed by version 1 of meshopt's attribute codec, which this "
                               "build's meshoptimizer does not know"
                             : "cannot be decoded",
                     isNewer ? "pack it with EXT_meshopt_compression (gltfpack -c or -cc)"
                             : std::string(kCutShort));
    }
    return decodedViews_[bufferView] = std::move(out);
}

}  // namespace pagoda::ooc::gltf
