// ply_vertices.h: the vertices of a PLY file, packed into scratch for reading in any order.
#pragma once

#include "ooc/base/file.h"
#include "ooc/readers/ply_header.h"
#include "ooc/readers/triangle_batcher.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>

namespace pagoda::ooc {

// Which properties of an element are a colour: red, green, blue and maybe alpha.
struct PlyColourProperties {
    std::array<std::optional<size_t>, 4> property;
    [[nodiscard]] bool isComplete() const { return property[0] && property[1] && property[2]; }
};
[[nodiscard]] PlyColourProperties findPlyColour(const PlyElement& element);
// A channel of that type as 0..255: floats are 0..1, 16 bits are scaled, NaN is 0.
[[nodiscard]] uint32_t plyColourChannel(double value, PlyScalar type);

// A vertex takes its position in the file's own precision, then 4 bytes of colour and 12 of normal
// where the file has them.
class PlyVertices {
public:
    // Throws Error if the element has no x, y, z.
    PlyVertices(const SourceFile& source, const PlyElement& element, uint64_t headerEndLine,
                const std::filesystem::path& scratchFolder);

    // Reads all vertices; once.
    template <typename Values>
    void load(Values& values);
    // The same where isPlainCopy(): the file's bytes are already packed as we pack them.
    [[nodiscard]] bool isPlainCopy(PlyFormat format) const;
    void loadPlain(InputStream& stream);

    [[nodiscard]] uint64_t count() const noexcept { return element_.count; }
    [[nodiscard]] bool hasColours() const noexcept { return colourOffset_ != kNone; }
    [[nodiscard]] bool hasNormals() const noexcept { return normalOffset_ != kNone; }

    // `index` < count(), after load.
    [[nodiscard]] Vec3d position(uint64_t index) const {
        const std::byte* from = data_ + index * strideBytes_;
        if (isDouble_) {
            Vec3d position;
            std::memcpy(&position, from, sizeof position);
            return position;
        }
        Vec3f position;
        std::memcpy(&position, from, sizeof position);
        return Vec3d(position);
    }
    [[nodiscard]] Corner corner(uint64_t index) const {
        Corner corner;
        corner.position = position(index);
        const std::byte* from = data_ + index * strideBytes_;
        if (hasColours()) {
            std::memcpy(&corner.colour, from + colourOffset_, sizeof corner.colour);
            corner.colour |= alphaMask_;
        }
        if (hasNormals()) std::memcpy(&corner.normal, from + normalOffset_, sizeof corner.normal);
        return corner;
    }

private:
    static constexpr size_t kNone = SIZE_MAX;
    struct Row;
    template <typename Values>
    static uint32_t readVertex(Row& row, Values& values, std::byte* out, size_t rowBytes);
    void finish();

    const SourceFile& source_;
    const PlyElement& element_;
    ScratchArray scratch_;
    std::array<size_t, 3> positionProperties_{};
    std::array<std::optional<size_t>, 3> normalProperties_;
    PlyColourProperties colourProperties_;
    bool isDouble_ = false;
    uint32_t highestAlpha_ = 0;
    // ORed into colours. All alphas are zero in files of exporters that do not know what it is, and
    // nothing would be seen: opaque is meant.
    uint32_t alphaMask_ = 0;
    size_t strideBytes_ = 0, colourOffset_ = kNone, normalOffset_ = kNone;
    const std::byte* data_ = nullptr;
};

}  // namespace pagoda::ooc
