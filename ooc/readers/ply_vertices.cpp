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
        std::array<uint32_t, 4> channels = {255, 255, 255, 255};
        for (size_t k = 0; k < properties.size(); ++k) {
            if (properties[k].isList()) {
                values.skipList(properties[k]);
                continue;
            }
            const double value = values.number(properties[k].type);
            const uint8_t target = targets_[k];
            if (target >= kColour && target < kNormal) {
                channels[target - kColour] = plyColourChannel(value, properties[k].type);
            } else {
                fields_[target] = value;
            }
        }
        values.endItem();
        const uint32_t colour =
            channels[0] | channels[1] << 8 | channels[2] << 16 | channels[3] << 24;
        pack(colour, out);
        return colour;
    }

private:
    void pack(uint32_t colour, std::byte* out) const {
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
    }

    const PlyVertices& vertices_;
    std::vector<uint8_t> targets_;     // by property
    std::array<double, 11> fields_{};  // by target; the last takes what nobody wants
};

template <typename Values>
void PlyVertices::load(Values& values) {
    Row row(*this);
    std::vector<std::byte> block(kPackedBlockBytes / strideBytes_ * strideBytes_);
    size_t filled = 0;
    for (uint64_t k = 0; k < element_.count; ++k) {
        const uint32_t alpha = row.read(values, block.data() + filled) >> 24;
        highestAlpha_ = std::max(highestAlpha_, alpha);
        lowestAlpha_ = std::min(lowestAlpha_, alpha);
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
    const bool meansNothing = highestAlpha_ == 0;
    hasAlpha_ = hasColours() && !meansNothing && lowestAlpha_ < 255;
    alphaMask_ = meansNothing ? 0xFF000000u : 0;
}

Corner PlyVertices::corner(uint64_t index) const {
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

}  // namespace pagoda::ooc
