#include "ooc/readers/ply_vertices.h"

#include "ooc/readers/ply_values.h"

#include <algorithm>
#include <cmath>

namespace pagoda::ooc {
namespace {

constexpr size_t kPackedBlockBytes = size_t{256} << 10;

bool needsDouble(PlyScalar type) {
    return type == PlyScalar::Float64 || type == PlyScalar::Int32 || type == PlyScalar::UInt32;
}

}  // namespace

PlyColourProperties findPlyColour(const PlyElement& element) {
    return {{element.find({"red", "r", "diffuse_red"}),
             element.find({"green", "g", "diffuse_green"}),
             element.find({"blue", "b", "diffuse_blue"}),
             element.find({"alpha", "a", "diffuse_alpha"})}};
}

uint32_t plyColourChannel(double value, PlyScalar type) {
    if (isFloating(type)) value *= 255.0;
    if (type == PlyScalar::UInt16 || type == PlyScalar::Int16) value /= 257.0;
    if (type == PlyScalar::Int8 && value < 0) value += 256.0;  // bytes by another name
    if (!(value > 0)) return 0;
    return static_cast<uint32_t>(std::min(value, 255.0) + 0.5);
}

PlyVertices::PlyVertices(const SourceFile& source, const PlyElement& element,
                         uint64_t headerEndLine, const std::filesystem::path& scratchFolder)
    : source_(source), element_(element), scratch_(scratchFolder) {
    constexpr std::string_view kAxes[] = {"x", "y", "z"};
    constexpr std::string_view kNormals[] = {"nx", "ny", "nz"};
    for (size_t axis = 0; axis < 3; ++axis) {
        const auto found = element.find({kAxes[axis]});
        if (!found) {
            source.failAtLine(headerEndLine,
                              "vertices have no property " + std::string(kAxes[axis]),
                              "write the file again with x, y and z");
        }
        positionProperties_[axis] = *found;
        isDouble_ |= needsDouble(element.properties[*found].type);
        normalProperties_[axis] = element.find({kNormals[axis]});
    }
    strideBytes_ = isDouble_ ? sizeof(Vec3d) : sizeof(Vec3f);
    colourProperties_ = findPlyColour(element);
    if (colourProperties_.isComplete()) {
        colourOffset_ = strideBytes_;
        strideBytes_ += sizeof(uint32_t);
    }
    if (normalProperties_[0] && normalProperties_[1] && normalProperties_[2]) {
        normalOffset_ = strideBytes_;
        strideBytes_ += sizeof(Vec3f);
    }
}

// One vertex on its way from the file's properties to the packed bytes.
struct PlyVertices::Row {
    enum Target : uint8_t { kPosition = 0, kColour = 3, kNormal = 7, kNothing = 10 };

    explicit Row(const PlyVertices& vertices) : vertices_(vertices) {
        targets_.assign(vertices.element_.properties.size(), kNothing);
        const auto aim = [&](std::optional<size_t> property, size_t target) {
            if (property) targets_[*property] = static_cast<uint8_t>(target);
        };
        for (size_t k = 0; k < 3; ++k) aim(vertices.positionProperties_[k], kPosition + k);
        if (vertices.hasColours()) {
            for (size_t k = 0; k < 4; ++k) aim(vertices.colourProperties_.property[k], kColour + k);
        }
        if (vertices.hasNormals()) {
            for (size_t k = 0; k < 3; ++k) aim(vertices.normalProperties_[k], kNormal + k);
        }
    }

    // Reads a vertex; returns its colour (white where it has none).
    template <typename Values>
    uint32_t read(Values& values, std::byte* out) {
        const std::vector<PlyProperty>& properties = vertices_.element_.properties;
        for (size_t k = 0; k < properties.size(); ++k) {
            if (properties[k].isList()) {
                values.skipList(properties[k]);
            } else {
                set(k, values.number(properties[k].type));
            }
        }
        values.endItem();
        return pack(out);
    }
    // The same from binary data without lists, all of which is at `from`.
    uint32_t readRow(const std::byte* from, bool swapsBytes, std::byte* out) {
        const std::vector<PlyProperty>& properties = vertices_.element_.properties;
        for (size_t k = 0; k < properties.size(); ++k) {
            const PlyScalar type = properties[k].type;
            if (targets_[k] != kNothing) set(k, loadPlyScalar(from, type, swapsBytes));
            from += plyScalarBytes(type);
        }
        return pack(out);
    }

private:
    void set(size_t property, double value) {
        const uint8_t target = targets_[property];
        const PlyScalar type = vertices_.element_.properties[property].type;
        if (target < kColour || target >= kNormal) {
            fields_[target] = value;
        } else {
            channels_[target - kColour] = type == PlyScalar::UInt8 ? static_cast<uint32_t>(value)
                                                                   : plyColourChannel(value, type);
        }
    }

    uint32_t pack(std::byte* out) const {
        const uint32_t colour =
            channels_[0] | channels_[1] << 8 | channels_[2] << 16 | channels_[3] << 24;
        const Vec3d position(fields_[kPosition], fields_[kPosition + 1], fields_[kPosition + 2]);
        if (vertices_.isDouble_) {
            std::memcpy(out, &position, sizeof position);
        } else {
            const Vec3f narrow(position);
            std::memcpy(out, &narrow, sizeof narrow);
        }
        if (vertices_.hasColours()) {
            std::memcpy(out + vertices_.colourOffset_, &colour, sizeof colour);
        }
        if (vertices_.hasNormals()) {
            const Vec3f normal =
                unitNormal(fields_[kNormal], fields_[kNormal + 1], fields_[kNormal + 2]);
            std::memcpy(out + vertices_.normalOffset_, &normal, sizeof normal);
        }
        return colour;
    }

    const PlyVertices& vertices_;
    std::vector<uint8_t> targets_;  // by property
    std::array<uint32_t, 4> channels_ = {255, 255, 255, 255};
    std::array<double, 11> fields_{};  // by target; the last takes what nobody wants
};

// `rowBytes` > 0: no lists, so a binary vertex can be taken at once.
template <typename Values>
uint32_t PlyVertices::readVertex(Row& row, Values& values, std::byte* out, size_t rowBytes) {
    if constexpr (Values::kIsBinary) {
        if (rowBytes > 0) {
            return row.readRow(values.take(rowBytes), values.swapsBytes(), out);
        }
    }
    return row.read(values, out);
}

template <typename Values>
void PlyVertices::load(Values& values) {
    Row row(*this);
    std::vector<std::byte> block(kPackedBlockBytes / strideBytes_ * strideBytes_);
    size_t filled = 0;
    const auto rowBytes = element_.hasLists() ? 0 : static_cast<size_t>(element_.leastBytes());
    for (uint64_t k = 0; k < element_.count; ++k) {
        std::byte* const out = block.data() + filled;
        const uint32_t alpha = readVertex(row, values, out, rowBytes) >> 24;
        highestAlpha_ = std::max(highestAlpha_, alpha);
        filled += strideBytes_;
        if (filled == block.size()) {
            scratch_.append(block);
            filled = 0;
        }
    }
    scratch_.append(std::span(block).first(filled));
    finish();
}
template void PlyVertices::load(PlyBinaryValues&);
template void PlyVertices::load(PlyAsciiValues&);

bool PlyVertices::isPlainCopy(PlyFormat format) const {
    return format == PlyFormat::BinaryLittleEndian && element_.properties.size() == 3 &&
           positionProperties_ == std::array<size_t, 3>{0, 1, 2} &&
           element_.leastBytes() == strideBytes_ &&
           std::ranges::all_of(element_.properties,
                               [](const PlyProperty& p) { return isFloating(p.type); });
}

void PlyVertices::loadPlain(InputStream& stream) {
    uint64_t left = element_.count * strideBytes_;
    while (left > 0) {
        std::span<const std::byte> block = stream.ahead(1);
        if (block.empty()) {
            source_.failCutShort("byte " + std::to_string(stream.offset()),
                                 "the data ends among the vertices");
        }
        block = block.first(static_cast<size_t>(std::min<uint64_t>(left, block.size())));
        scratch_.append(block);
        stream.take(block.size());
        left -= block.size();
    }
    finish();
}

void PlyVertices::finish() {
    scratch_.seal();
    data_ = scratch_.bytes().data();
    if (highestAlpha_ == 0) alphaMask_ = 0xFF000000u;
}

}  // namespace pagoda::ooc
