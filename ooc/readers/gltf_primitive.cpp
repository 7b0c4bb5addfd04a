#include "ooc/readers/gltf_primitive.h"

#include "ooc/readers/drc_decode.h"

#include <draco/mesh/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

namespace pagoda::ooc::gltf {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

// Where the attributes of a primitive come from: accessors, or a decoded Draco mesh.
class Attributes {
public:
    Attributes(const SourceFile& source, const Document& document, Buffers& buffers,
               const tinygltf::Primitive& primitive, std::string where)
        : source_(source),
          document_(document),
          buffers_(buffers),
          primitive_(primitive),
          where_(std::move(where)) {}

    void decodeDraco(MemoryLease& lease);
    [[nodiscard]] const draco::Mesh* dracoMesh() const { return mesh_.get(); }
    [[nodiscard]] uint64_t vertexCount() const;
    [[nodiscard]] bool has(const std::string& name) const {
        return primitive_.attributes.contains(name);
    }
    // Components of the attribute, 0 where it is missing, of too few, or not as long as the
    // positions (then `ignored` says so).
    [[nodiscard]] int components(const std::string& name, int least,
                                 std::vector<std::string_view>& ignored) const;
    template <typename Out>
    void read(const std::string& name, const Selection& selection, int components,
              bool isAlwaysNormalised, Out* out) const;

    [[nodiscard]] const std::string& where() const { return where_; }
    [[noreturn]] void fail(const std::string& what) const { source_.fail(where_, what, kValidate); }

private:
    [[nodiscard]] const tinygltf::Accessor& accessor(const std::string& name) const {
        return document_.model.accessors[static_cast<size_t>(primitive_.attributes.at(name))];
    }
    [[nodiscard]] const draco::PointAttribute* dracoAttribute(const std::string& name) const;

    const SourceFile& source_;
    const Document& document_;
    Buffers& buffers_;
    const tinygltf::Primitive& primitive_;
    std::string where_;
    std::unique_ptr<draco::Mesh> mesh_;
};

void Attributes::decodeDraco(MemoryLease& lease) {
    const auto found = primitive_.extensions.find(kDraco);
    if (found == primitive_.extensions.end()) return;
    const std::span<const std::byte> packed =
        buffers_.view(found->second.Get("bufferView").GetNumberAsInt());
    std::string problem;
    const auto announced = dracoAnnouncement(packed, problem);
    if (!announced) fail(problem);
    if (!announced->isMesh) fail("its Draco stream is a point cloud");
    lease.take(announced->decodedBytes(), where_);
    mesh_ = decodeDracoMesh(packed, problem);
    if (mesh_ == nullptr) fail(problem);
    if (mesh_->num_faces() > announcedTriangles(document_.model, primitive_)) {
        fail("its Draco stream holds " + std::to_string(mesh_->num_faces()) +
             " triangles, more than its accessor says");
    }
}

uint64_t Attributes::vertexCount() const {
    return mesh_ != nullptr ? mesh_->num_points() : accessor("POSITION").count;
}

const draco::PointAttribute* Attributes::dracoAttribute(const std::string& name) const {
    if (mesh_ == nullptr) return nullptr;
    const tinygltf::Value& ids = primitive_.extensions.at(kDraco).Get("attributes");
    if (!ids.Has(name)) return nullptr;
    const auto id = static_cast<uint32_t>(ids.Get(name).GetNumberAsInt());
    const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(id);
    if (attribute == nullptr) fail("its Draco stream has no attribute " + std::to_string(id));
    return attribute;
}

int Attributes::components(const std::string& name, int least,
                           std::vector<std::string_view>& ignored) const {
    if (!has(name)) return 0;
    const tinygltf::Accessor& from = accessor(name);
    const draco::PointAttribute* packed = dracoAttribute(name);
    const int count = packed != nullptr
                          ? std::min(int{packed->num_components()}, 4)
                          : tinygltf::GetNumComponentsInType(static_cast<uint32_t>(from.type));
    if (count < least || count > 4) {
        ignored.emplace_back("vertex attribute of a wrong type");
        return 0;
    }
    if (packed == nullptr && from.count < vertexCount()) {
        ignored.emplace_back("vertex attribute shorter than the positions");
        return 0;
    }
    return count;
}

template <typename Out>
void Attributes::read(const std::string& name, const Selection& selection, int components,
                      bool isAlwaysNormalised, Out* out) const {
    const tinygltf::Accessor& from = accessor(name);
    if (const draco::PointAttribute* packed = dracoAttribute(name)) {
        std::array<double, 4> value{};
        for (uint64_t i = 0; i < selection.count; ++i) {
            if (!readDracoValue(*packed, static_cast<uint32_t>(selection.element(i)), components,
                                from.normalized || isAlwaysNormalised, value.data())) {
                fail("its Draco stream has no " + name + " for some vertices");
            }
            for (int c = 0; c < components; ++c) {
                *out++ = static_cast<Out>(value[static_cast<size_t>(c)]);
            }
        }
        return;
    }
    const AccessorView view(source_, document_, buffers_, primitive_.attributes.at(name));
    view.read(selection, components, out);
    if (!isAlwaysNormalised || from.normalized || view.isFloat()) return;
    // Exporters forget the flag where only one meaning makes sense (colours).
    const bool isShort = view.componentType() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    const Out scale = Out{1} / static_cast<Out>(isShort ? 65535 : 255);
    for (uint64_t i = 0; i < selection.count * static_cast<uint64_t>(components); ++i) {
        out[i] *= scale;
    }
}

// Corner lists of strips and fans as the specification gives them (section 3.7.2.1).
std::vector<uint32_t> triangulate(int mode, std::vector<uint32_t> list) {
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        list.resize(list.size() / 3 * 3);
        return list;
    }
    std::vector<uint32_t> corners;
    if (list.size() < 3) return corners;
    corners.reserve(3 * (list.size() - 2));
    for (size_t i = 0; i + 2 < list.size(); ++i) {
        if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
            corners.insert(corners.end(), {list[i + 1], list[i + 2], list[0]});
        } else {
            corners.insert(corners.end(), {list[i], list[i + 1 + i % 2], list[i + 2 - i % 2]});
        }
    }
    return corners;
}

// Keeps the triangles for which `isGood(corner)` holds three times; returns how many went.
template <typename IsGood>
uint64_t keepTriangles(std::vector<uint32_t>& corners, IsGood&& isGood) {
    size_t kept = 0;
    for (size_t at = 0; at < corners.size(); at += 3) {
        if (!isGood(corners[at]) || !isGood(corners[at + 1]) || !isGood(corners[at + 2])) continue;
        std::copy_n(corners.begin() + static_cast<std::ptrdiff_t>(at), 3,
                    corners.begin() + static_cast<std::ptrdiff_t>(kept));
        kept += 3;
    }
    const uint64_t gone = (corners.size() - kept) / 3;
    corners.resize(kept);
    return gone;
}

// Chooses what vertices to read and renumbers the corners: the range that is used, or, where many
// primitives share long accessors and each uses little of them, the vertices one by one.
Selection selectVertices(std::vector<uint32_t>& corners, std::vector<uint32_t>& used) {
    if (corners.empty()) return {};
    const auto [least, greatest] = std::ranges::minmax(corners);
    const uint64_t range = uint64_t{greatest} - least + 1;
    if (range <= 4 * corners.size() + 64) {
        for (uint32_t& corner : corners) corner -= least;
        return {least, range, {}};
    }
    used = corners;
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (uint32_t& corner : corners) {
        corner = static_cast<uint32_t>(std::ranges::lower_bound(used, corner) - used.begin());
    }
    return {0, used.size(), used};
}

bool isFinite(const Vec3d& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Makes normals unit length; one without a direction becomes that of a triangle at its vertex.
void mendNormals(DecodedPrimitive& decoded) {
    std::vector<bool> isBad;
    for (size_t i = 0; i < decoded.normals.size(); ++i) {
        Vec3f& normal = decoded.normals[i];
        const float length = glm::length(normal);
        if (std::isfinite(length) && length > 1e-6F) {
            normal /= length;
            continue;
        }
        isBad.resize(decoded.normals.size());
        isBad[i] = true;
        normal = {0, 0, 1};
    }
    if (isBad.empty()) return;
    decoded.ignored.emplace_back("normals without direction");
    for (size_t at = 0; at < decoded.corners.size(); at += 3) {
        const uint32_t* corner = &decoded.corners[at];
        if (!isBad[corner[0]] && !isBad[corner[1]] && !isBad[corner[2]]) continue;
        const Vec3d& a = decoded.positions[corner[0]];
        const Vec3d face =
            glm::cross(decoded.positions[corner[1]] - a, decoded.positions[corner[2]] - a);
        const double length = glm::length(face);
        if (!(length > 0) || !std::isfinite(length)) continue;
        for (int c = 0; c < 3; ++c) {
            if (isBad[corner[c]]) decoded.normals[corner[c]] = Vec3f(face / length);
        }
    }
}

// COLOR_0 times the base colour times its texture, all linear, as corner colours.
void bakeColours(const Attributes& attributes, const Selection& selection, Materials& materials,
                 const Surface& surface, DecodedPrimitive& decoded) {
    const int components = attributes.components("COLOR_0", 3, decoded.ignored);
    const Texture* texture = nullptr;
    std::string coordinates;
    if (surface.texture) {
        coordinates = "TEXCOORD_" + std::to_string(surface.texture->texCoord);
        if (attributes.components(coordinates, 2, decoded.ignored) < 2) {
            decoded.ignored.emplace_back("texture without coordinates");
        } else {
            std::string_view problem;
            texture = materials.texture(surface.texture->texture, problem);
            if (texture == nullptr) decoded.ignored.push_back(problem);
        }
    }
    if (components == 0 && texture == nullptr) return;

    std::vector<float> colours(selection.count * static_cast<uint64_t>(components));
    if (components > 0) {
        attributes.read("COLOR_0", selection, components, true, colours.data());
    }
    std::vector<float> uvs(texture != nullptr ? 2 * selection.count : 0);
    if (texture != nullptr) attributes.read(coordinates, selection, 2, false, uvs.data());
    decoded.colours.resize(selection.count);
    for (uint64_t i = 0; i < selection.count; ++i) {
        std::array<float, 4> value = surface.factor;
        for (int c = 0; c < components; ++c) {
            const float colour =
                colours[i * static_cast<uint64_t>(components) + static_cast<uint64_t>(c)];
            value[static_cast<size_t>(c)] *= std::isfinite(colour) ? colour : 1.0F;
        }
        if (texture != nullptr) {
            const auto texel = sampleAt(*texture, *surface.texture, uvs[2 * i], uvs[2 * i + 1]);
            for (size_t c = 0; c < 4; ++c) value[c] *= texel[c];
        }
        decoded.colours[i] = packColour(value, surface.isTranslucent);
    }
}

uint64_t listLength(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return 0;
    const int accessor = primitive.indices >= 0 ? primitive.indices : position->second;
    return model.accessors[static_cast<size_t>(accessor)].count;
}

// The corners of the triangles as the file orders them, not yet checked.
std::vector<uint32_t> readCorners(const SourceFile& source, const Document& document,
                                  Buffers& buffers, const tinygltf::Primitive& primitive,
                                  const Attributes& attributes, MemoryLease& lease,
                                  DecodedPrimitive& decoded) {
    if (const draco::Mesh* mesh = attributes.dracoMesh()) {
        std::vector<uint32_t> corners;
        corners.reserve(3 * size_t{mesh->num_faces()});
        for (draco::FaceIndex face(0); face < mesh->num_faces(); ++face) {
            for (const draco::PointIndex& point : mesh->face(face))
                corners.push_back(point.value());
        }
        return corners;
    }
    const uint64_t length = listLength(document.model, primitive);
    if (length > std::numeric_limits<uint32_t>::max()) attributes.fail("has over 2^32 corners");
    lease.take(sizeof(uint32_t) * (length + 3 * announcedTriangles(document.model, primitive)),
               attributes.where());
    std::vector<uint32_t> list(length);
    if (primitive.indices >= 0) {
        const AccessorView view(source, document, buffers, primitive.indices);
        const bool isUnsigned = view.componentType() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                view.componentType() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                                view.componentType() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        if (view.components() != 1 || !isUnsigned) {
            attributes.fail("its indices are not unsigned whole numbers");
        }
        view.readIndices(list.data());
    } else {
        std::iota(list.begin(), list.end(), 0U);
    }
    const bool isTriangles = primitive.mode == TINYGLTF_MODE_TRIANGLES;
    if (isTriangles ? length % 3 != 0 : length == 1 || length == 2) {
        decoded.ignored.emplace_back("corners too few for a triangle");
    }
    return triangulate(primitive.mode, std::move(list));
}

}  // namespace

uint64_t announcedTriangles(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) return 0;
    const uint64_t length = listLength(model, primitive);
    if (primitive.mode == TINYGLTF_MODE_TRIANGLES) return length / 3;
    return length < 3 ? 0 : length - 2;
}

PrimitiveDecoder::PrimitiveDecoder(const SourceFile& source, const Document& document,
                                   Buffers& buffers, Materials& materials)
    : source_(source), document_(document), buffers_(buffers), materials_(materials) {
}

DecodedPrimitive PrimitiveDecoder::decode(int mesh, size_t index, MemoryLease& lease) {
    const tinygltf::Primitive& primitive =
        document_.model.meshes[static_cast<size_t>(mesh)].primitives[index];
    DecodedPrimitive decoded;
    Attributes attributes(source_, document_, buffers_, primitive,
                          primitivePlace(static_cast<size_t>(mesh), index));
    if (!attributes.has("POSITION")) {
        decoded.ignored.emplace_back("primitive without positions");
        return decoded;
    }
    attributes.decodeDraco(lease);
    decoded.corners =
        readCorners(source_, document_, buffers_, primitive, attributes, lease, decoded);
    const uint64_t vertices = attributes.vertexCount();
    decoded.indexOutOfRange =
        keepTriangles(decoded.corners, [&](uint32_t corner) { return corner < vertices; });

    std::vector<uint32_t> used;
    const Selection selection = selectVertices(decoded.corners, used);
    // Positions, normals, colours and texture coordinates, and the first two again transformed.
    lease.take(selection.count * 2 * (sizeof(Vec3d) + sizeof(Vec3f) + 6 * sizeof(float)),
               attributes.where());
    if (attributes.components("POSITION", 3, decoded.ignored) != 3) {
        attributes.fail("its POSITION is not of type VEC3");
    }
    decoded.positions.resize(selection.count);
    if (selection.count == 0) return decoded;
    attributes.read("POSITION", selection, 3, false, &decoded.positions[0].x);
    decoded.nonFinite = keepTriangles(
        decoded.corners, [&](uint32_t corner) { return isFinite(decoded.positions[corner]); });
    for (Vec3d& position : decoded.positions) {
        if (!isFinite(position)) position = Vec3d(0);  // of no triangle
    }
    if (attributes.components("NORMAL", 3, decoded.ignored) == 3) {
        decoded.normals.resize(selection.count);
        attributes.read("NORMAL", selection, 3, true, &decoded.normals[0].x);
        mendNormals(decoded);
    }
    bakeColours(attributes, selection, materials_, materials_.surface(primitive.material), decoded);
    return decoded;
}

}  // namespace pagoda::ooc::gltf
