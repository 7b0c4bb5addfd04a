#include "ooc/readers/ply_sampler.h"

#include "ooc/readers/indexed_faces.h"
#include "ooc/readers/ply_values.h"
#include "ooc/readers/read_ahead.h"
#include "ooc/readers/scattered_order.h"

#include <algorithm>
#include <array>
#include <vector>

namespace pagoda::ooc {
namespace {

// Neighbours in the file are mostly neighbours in space, so a block's faces need few blocks of
// vertices.
constexpr size_t kVertexBlocks = 256;  // kept: 1 MiB

size_t offsetOf(const PlyElement& element, size_t property) {
    size_t offset = 0;
    for (size_t k = 0; k < property; ++k) offset += element.properties[k].leastBytes();
    return offset;
}

struct ScalarPlace {
    size_t offset = 0;
    PlyScalar type = PlyScalar::Float32;
};

// Opaque: a sketch does not blend.
struct ColourPlaces {
    std::array<ScalarPlace, 3> channels;
    bool isComplete = false;

    ColourPlaces(const PlyElement& element, const PlyColourProperties& colour, size_t listBytes,
                 size_t list)
        : isComplete(colour.isComplete()) {
        for (size_t k = 0; isComplete && k < 3; ++k) {
            const size_t property = *colour.property[k];
            // A list before it is longer than its least.
            const size_t beyond = property > list ? listBytes : 0;
            channels[k] = {offsetOf(element, property) + beyond, element.properties[property].type};
        }
    }
    [[nodiscard]] uint32_t read(const std::byte* row, bool swapsBytes) const {
        uint32_t colour = 0xFF000000u;
        for (size_t k = 0; k < 3; ++k) {
            const double value =
                loadPlyScalar(row + channels[k].offset, channels[k].type, swapsBytes);
            colour |= plyColourChannel(value, channels[k].type) << (8 * k);
        }
        return colour;
    }
};

// Vertices where they lie in the file, by blocks of whole rows, each kept until another one needs
// its place.
class VerticesInFile {
public:
    VerticesInFile(const SourceFile& source, const PlyHeader& header, const PlySampleLayout& layout)
        : source_(source),
          element_(header.elements[layout.vertexElement]),
          swapsBytes_(header.format == PlyFormat::BinaryBigEndian),
          offset_(layout.vertexOffset),
          rowBytes_(layout.vertexBytes),
          rowsInBlock_(std::max<uint64_t>(1, BlockSample::kBlockBytes / layout.vertexBytes)),
          colour_(element_, findPlyColour(element_), 0, SIZE_MAX),
          blocks_(kVertexBlocks) {
        constexpr std::string_view kAxes[] = {"x", "y", "z"};
        for (size_t axis = 0; axis < 3; ++axis) {
            const size_t property = *element_.find({kAxes[axis]});
            axes_[axis] = {offsetOf(element_, property), element_.properties[property].type};
        }
    }

    [[nodiscard]] uint64_t count() const noexcept { return element_.count; }
    [[nodiscard]] bool hasColours() const noexcept { return colour_.isComplete; }
    [[nodiscard]] Vec3d position(uint64_t index) const { return positionIn(row(index)); }
    [[nodiscard]] Corner corner(uint64_t index) const {
        const std::byte* const from = row(index);
        Corner corner;
        corner.position = positionIn(from);
        if (hasColours()) corner.colour = colour_.read(from, swapsBytes_);
        return corner;
    }

private:
    struct Block {
        uint64_t number = UINT64_MAX;
        std::vector<std::byte> bytes;
    };

    [[nodiscard]] Vec3d positionIn(const std::byte* from) const {
        Vec3d position;
        for (int axis = 0; axis < 3; ++axis) {
            const ScalarPlace& place = axes_[static_cast<size_t>(axis)];
            position[axis] = loadPlyScalar(from + place.offset, place.type, swapsBytes_);
        }
        return position;
    }
    [[nodiscard]] const std::byte* row(uint64_t index) const {
        const uint64_t number = index / rowsInBlock_, first = number * rowsInBlock_;
        Block& block = blocks_[number % kVertexBlocks];
        if (block.number != number) {
            block.bytes.resize(std::min(rowsInBlock_, count() - first) * rowBytes_);
            block.number = UINT64_MAX;  // until it is there
            source_.file().readAt(offset_ + first * rowBytes_, block.bytes);
            block.number = number;
        }
        return block.bytes.data() + (index - first) * rowBytes_;
    }

    const SourceFile& source_;
    const PlyElement& element_;
    bool swapsBytes_;
    uint64_t offset_;
    size_t rowBytes_;
    uint64_t rowsInBlock_;
    std::array<ScalarPlace, 3> axes_;
    ColourPlaces colour_;
    mutable std::vector<Block> blocks_;
};

// Bytes of all elements in [first, last), none of which has a list.
std::optional<uint64_t> bytesOfPlain(const PlyHeader& header, size_t first, size_t last) {
    uint64_t bytes = 0;
    for (size_t k = first; k < last; ++k) {
        if (header.elements[k].hasLists()) return std::nullopt;
        bytes += header.elements[k].count * header.elements[k].leastBytes();  // header: it fits
    }
    return bytes;
}

}  // namespace

std::optional<PlySampleLayout> findPlySampleLayout(const SourceFile& source,
                                                   const PlyHeader& header) {
    const auto vertices = header.findElement("vertex"), faces = header.findElement("face");
    if (header.format == PlyFormat::Ascii || !vertices || !faces) return std::nullopt;
    const PlyElement& vertex = header.elements[*vertices];
    const PlyElement& face = header.elements[*faces];
    if (vertex.count == 0 || face.count == 0 || vertex.hasLists()) return std::nullopt;
    if (!vertex.find({"x"}) || !vertex.find({"y"}) || !vertex.find({"z"})) return std::nullopt;
    const auto layout = findPlyFaces(face);
    const auto lists =
        std::ranges::count_if(face.properties, [](const PlyProperty& p) { return p.isList(); });
    if (!layout || lists != 1) return std::nullopt;
    // All but the faces' lists have a length that is known; what is left is theirs.
    const auto beforeVertices = bytesOfPlain(header, 0, std::min(*vertices, *faces));
    const auto between =
        bytesOfPlain(header, std::min(*vertices, *faces) + 1, std::max(*vertices, *faces));
    const auto after =
        bytesOfPlain(header, std::max(*vertices, *faces) + 1, header.elements.size());
    if (!beforeVertices || !between || !after) return std::nullopt;
    const uint64_t vertexBytes = vertex.count * vertex.leastBytes();
    const uint64_t known = header.dataOffset + *beforeVertices + *between + *after + vertexBytes +
                           face.count * face.leastBytes();
    const size_t indexBytes = plyScalarBytes(face.properties[layout->cornerList].type);
    if (source.sizeBytes() < known) return std::nullopt;
    const uint64_t indices = (source.sizeBytes() - known) / indexBytes;
    const uint64_t corners = indices / face.count;
    if (corners < 3 || corners > 4 || (source.sizeBytes() - known) % indexBytes != 0 ||
        indices % face.count != 0) {
        return std::nullopt;
    }
    PlySampleLayout found{.vertexElement = *vertices,
                          .faceElement = *faces,
                          .vertexBytes = vertex.leastBytes(),
                          .faceBytes = face.leastBytes() + corners * indexBytes,
                          .corners = corners,
                          .faces = *layout};
    const uint64_t first = header.dataOffset + *beforeVertices;
    const bool areVerticesFirst = *vertices < *faces;
    found.vertexOffset = areVerticesFirst ? first : first + face.count * found.faceBytes + *between;
    found.faceOffset = areVerticesFirst ? first + vertexBytes + *between : first;
    return found;
}

void samplePly(const SourceFile& source, const PlyHeader& header, const PlySampleLayout& layout,
               TriangleSink& sink, uint64_t triangles, const std::function<bool()>& isEnough) {
    const PlyElement& element = header.elements[layout.faceElement];
    const PlyProperty& list = element.properties[layout.faces.cornerList];
    const bool swaps = header.format == PlyFormat::BinaryBigEndian;
    const size_t countOffset = offsetOf(element, layout.faces.cornerList);
    const size_t indexOffset = countOffset + plyScalarBytes(*list.countType);
    const size_t indexBytes = plyScalarBytes(list.type);
    const VerticesInFile vertices(source, header, layout);
    const ColourPlaces faceColour(element, layout.faces.colour, layout.corners * indexBytes,
                                  layout.faces.cornerList);
    const bool usesFaceColours = faceColour.isComplete && !vertices.hasColours();
    IndexedFaces<VerticesInFile> faces(vertices, sink, vertices.hasColours() || usesFaceColours,
                                       false);

    const uint64_t wanted = std::max<uint64_t>(1, triangles / (layout.corners - 2));
    std::vector<std::byte> block;
    std::vector<uint64_t> indices(layout.corners);
    readAhead(source.file());
    BlockSample order(element.count, layout.faceBytes);
    BlockSample::Visit visit;
    for (uint64_t taken = 0; taken < wanted && order.next(visit) && !isEnough();) {
        block.resize(visit.rows * layout.faceBytes);
        source.file().readAt(layout.faceOffset + visit.firstRow * layout.faceBytes, block);
        for (uint64_t k = visit.phase; k < visit.rows; k += visit.stride, ++taken) {
            const std::byte* const row = block.data() + k * layout.faceBytes;
            const double length = loadPlyScalar(row + countOffset, *list.countType, swaps);
            if (length != static_cast<double>(layout.corners)) continue;  // the sizes lied
            for (size_t corner = 0; corner < indices.size(); ++corner) {
                const double index =
                    loadPlyScalar(row + indexOffset + corner * indexBytes, list.type, swaps);
                indices[corner] = index < 0 ? UINT64_MAX : static_cast<uint64_t>(index);
            }
            if (usesFaceColours) faces.setFaceColour(faceColour.read(row, swaps));
            faces.face(indices);
        }
    }
    faces.finish();
}

}  // namespace pagoda::ooc
