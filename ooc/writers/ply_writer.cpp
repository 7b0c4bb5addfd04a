// ply_writer.cpp: binary little-endian PLY, indexed.
// Vertices go straight into the file behind a header of fixed size, faces into scratch, appended at
// the end. A vertex record grows when the mesh shows that it must (a coordinate that is no float, a
// colour, a normal): what is written so far is then widened in place, back to front. In practice
// that happens with the first batch or never.
#include "ooc/base/error.h"
#include "ooc/writers/corner_welder.h"
#include "ooc/writers/float_exact.h"
#include "ooc/writers/target_file.h"
#include "ooc/writers/writer_kinds.h"

#include <algorithm>
#include <cstring>

namespace pagoda::ooc {
namespace {

constexpr size_t kHeaderBytes = 512;  // the longest header is about 420, the rest is a comment
constexpr uint32_t kWhite = 0xFFFFFFFFu;

struct VertexLayout {
    bool hasDoubles = false, hasNormals = false, hasColours = false;

    [[nodiscard]] size_t bytes() const {
        return (hasDoubles ? 24u : 12u) + (hasNormals ? 12u : 0u) + (hasColours ? 4u : 0u);
    }
    [[nodiscard]] bool operator==(const VertexLayout&) const = default;
};

struct Vertex {
    Vec3d position{0.0};
    Vec3f normal{0.0f};
    uint32_t colour = kWhite;
};

void store(const Vertex& vertex, const VertexLayout& layout, std::byte* out) {
    if (layout.hasDoubles) {
        std::memcpy(out, &vertex.position, 24), out += 24;
    } else {
        const Vec3f position(vertex.position);
        std::memcpy(out, &position, 12), out += 12;
    }
    if (layout.hasNormals) std::memcpy(out, &vertex.normal, 12), out += 12;
    if (layout.hasColours) std::memcpy(out, &vertex.colour, 4);
}

Vertex load(const std::byte* in, const VertexLayout& layout) {
    Vertex vertex;
    if (layout.hasDoubles) {
        std::memcpy(&vertex.position, in, 24), in += 24;
    } else {
        Vec3f position;
        std::memcpy(&position, in, 12), in += 12;
        vertex.position = position;
    }
    if (layout.hasNormals) std::memcpy(&vertex.normal, in, 12), in += 12;
    if (layout.hasColours) std::memcpy(&vertex.colour, in, 4);
    return vertex;
}

std::string makeHeader(const VertexLayout& layout, uint64_t vertices, uint64_t faces) {
    const std::string real = layout.hasDoubles ? "double" : "float";
    std::string elements = "element vertex " + std::to_string(vertices) + "\n";
    for (const char* name : {"x", "y", "z"}) elements += "property " + real + " " + name + "\n";
    if (layout.hasNormals) {
        for (const char* name : {"nx", "ny", "nz"}) {
            elements += std::string("property float ") + name + "\n";
        }
    }
    if (layout.hasColours) {
        for (const char* name : {"red", "green", "blue", "alpha"}) {
            elements += std::string("property uchar ") + name + "\n";
        }
    }
    elements += "element face " + std::to_string(faces) + "\n";
    elements += vertices > INT32_MAX ? "property list uchar uint vertex_indices\n"
                                     : "property list uchar int vertex_indices\n";
    elements += "end_header\n";
    // The comment that fills the header stands before the elements: behind the last property
    // OpenMesh 9.0 takes what follows for the first vertex.
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment written by Pagoda ";
    text.append(kHeaderBytes - text.size() - 1 - elements.size(), '.');
    return text + "\n" + elements;
}

class PlyWriter final : public MeshWriter {
public:
    PlyWriter(const std::filesystem::path& target, bool force)
        : file_(target, force), faces_(folderOf(target)) {
        file_.append(makeHeader(layout_, 0, 0));
    }

    uint32_t addObject(const ObjectInfo&) override { return objects_++; }

    uint32_t addMaterial(const MaterialInfo& material) override {
        materialColours_.push_back(material.colour);
        return static_cast<uint32_t>(materialColours_.size() - 1);
    }

    void addTriangles(const TriangleBatch& batch) override {
        widen(layoutFor(batch));
        welder_.weld(batch);
        writeVertices(batch);
        writeFaces();
        vertexCount_ += welder_.vertices().size();
        if (vertexCount_ > UINT32_MAX) {
            throw Error(file_.target().string(), "", "PLY holds at most 4,294,967,295 vertices",
                        "write part of it, or name it .obj");
        }
    }

    uint64_t finish() override {
        file_.append(faces_.flushed());
        const std::string header = makeHeader(layout_, vertexCount_, faceCount_);
        file_.patch(0, std::as_bytes(std::span(header)));
        return file_.publish();
    }

private:
    [[nodiscard]] uint32_t materialColour(const TriangleBatch& batch) const {
        return batch.material < materialColours_.size() ? materialColours_[batch.material] : kWhite;
    }

    [[nodiscard]] VertexLayout layoutFor(const TriangleBatch& batch) const {
        VertexLayout layout = layout_;
        layout.hasNormals |= !batch.normals.empty();
        layout.hasColours |= !batch.colours.empty() || materialColour(batch) != kWhite;
        layout.hasDoubles |=
            !std::all_of(batch.positions.begin(), batch.positions.end(), [](const Vec3d& position) {
                return isFloatExact(position.x) && isFloatExact(position.y) &&
                       isFloatExact(position.z);
            });
        return layout;
    }

    void widen(const VertexLayout& wider) {
        if (wider == layout_) return;
        File& file = file_.flushed();
        const size_t oldBytes = layout_.bytes(), newBytes = wider.bytes();
        constexpr uint64_t kBlock = 16384;  // vertices
        std::vector<std::byte> in, out;
        for (uint64_t end = vertexCount_; end > 0;) {
            const uint64_t begin = end > kBlock ? end - kBlock : 0;
            in.resize((end - begin) * oldBytes);
            out.resize((end - begin) * newBytes);
            file.readAt(kHeaderBytes + begin * oldBytes, in);
            for (uint64_t i = 0; i < end - begin; ++i) {
                store(load(&in[i * oldBytes], layout_), wider, &out[i * newBytes]);
            }
            file.writeAt(kHeaderBytes + begin * newBytes, out);
            end = begin;
        }
        file_.continueAt(kHeaderBytes + vertexCount_ * newBytes);
        layout_ = wider;
    }

    void writeVertices(const TriangleBatch& batch) {
        const size_t bytes = layout_.bytes();
        block_.resize(welder_.vertices().size() * bytes);
        std::byte* out = block_.data();
        for (const uint32_t corner : welder_.vertices()) {
            Vertex vertex{.position = batch.positions[corner]};
            vertex.colour = batch.colours.empty() ? materialColour(batch) : batch.colours[corner];
            if (!batch.normals.empty()) vertex.normal = batch.normals[corner];
            store(vertex, layout_, out);
            out += bytes;
        }
        file_.append(block_);
    }

    void writeFaces() {
        const std::span<const uint32_t> indices = welder_.indices();
        block_.resize(indices.size() / 3 * 13);
        std::byte* out = block_.data();
        for (size_t i = 0; i + 2 < indices.size(); i += 3) {
            *out = std::byte{3};
            uint32_t corners[3];
            for (size_t c = 0; c < 3; ++c) {
                corners[c] = static_cast<uint32_t>(vertexCount_) + indices[i + c];
            }
            std::memcpy(out + 1, corners, 12);
            out += 13;
        }
        faceCount_ += indices.size() / 3;
        faces_.append(block_);
    }

    TargetFile file_;
    ScratchStream faces_;
    VertexLayout layout_;
    CornerWelder welder_;
    std::vector<std::byte> block_;
    std::vector<uint32_t> materialColours_;
    uint64_t vertexCount_ = 0, faceCount_ = 0;
    uint32_t objects_ = 0;
};

}  // namespace

std::unique_ptr<MeshWriter> createPlyWriter(const std::filesystem::path& target, bool force) {
    return std::make_unique<PlyWriter>(target, force);
}

}  // namespace pagoda::ooc
