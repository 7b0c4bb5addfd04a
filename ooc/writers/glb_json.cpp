#include "ooc/writers/glb_json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

namespace pagoda::ooc {
namespace {

using Json = nlohmann::ordered_json;
using Write = std::function<void(std::string_view)>;

constexpr int kFloat = 5126, kUnsignedShort = 5123;
constexpr uint32_t kWhite = 0xFFFFFFFFu;

std::string dump(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// "name":[ item, item ... ] with a leading comma; nothing for no items.
class ArrayWriter {
public:
    ArrayWriter(const Write& write, std::string name) : write_(write), name_(std::move(name)) {}
    ~ArrayWriter() {
        if (count_ > 0) write_("]");
    }
    ArrayWriter(const ArrayWriter&) = delete;
    ArrayWriter& operator=(const ArrayWriter&) = delete;
    void add(const Json& item) {
        if (count_++ == 0) {
            write_(",\"");
            write_(name_);
            write_("\":[");
        } else {
            write_(",");
        }
        write_(dump(item));
    }

private:
    const Write& write_;
    std::string name_;
    uint64_t count_ = 0;
};

Json materialJson(const MaterialInfo& material, bool isWhite) {
    const uint32_t colour = isWhite ? kWhite : material.colour;
    Json factor = Json::array();
    for (unsigned shift : {0u, 8u, 16u}) {
        factor.push_back(srgbToLinear(static_cast<uint8_t>((colour >> shift) & 255u)));
    }
    factor.push_back((colour >> 24) / 255.0);
    Json json;
    if (!material.name.empty()) json["name"] = material.name;
    json["pbrMetallicRoughness"] = {
        {"baseColorFactor", factor}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.8}};
    if (material.isTranslucent) json["alphaMode"] = "BLEND";
    json["doubleSided"] = true;
    return json;
}

// Corner colours have the material's colour in them, so their primitives need a white twin of it.
std::vector<uint32_t> writeMaterials(const GlbScene& scene, const Write& write) {
    ArrayWriter array(write, "materials");
    std::vector<bool> needsTwin(scene.materials.size(), false);
    for (const GlbPrimitive& primitive : scene.primitives) {
        if (primitive.colourOffset != GlbPrimitive::kAbsent &&
            primitive.material < scene.materials.size() &&
            scene.materials[primitive.material].colour != kWhite) {
            needsTwin[primitive.material] = true;
        }
    }
    for (const MaterialInfo& material : scene.materials) array.add(materialJson(material, false));
    std::vector<uint32_t> twins(scene.materials.size());
    uint32_t next = static_cast<uint32_t>(scene.materials.size());
    for (size_t i = 0; i < twins.size(); ++i) {
        twins[i] = static_cast<uint32_t>(i);
        if (!needsTwin[i]) continue;
        array.add(materialJson(scene.materials[i], true));
        twins[i] = next++;
    }
    return twins;
}

// A node for each object, numbered alike; the mesh of an object stands in its node. Returns the
// nodes without parent.
std::vector<uint32_t> writeNodes(const GlbScene& scene, const Write& write) {
    std::vector<std::vector<uint32_t>> children(scene.objects.size());
    std::vector<uint32_t> roots;
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const uint32_t parent = scene.objects[i].info.parent;
        (parent < i ? children[parent] : roots).push_back(i);
    }
    ArrayWriter array(write, "nodes");
    uint32_t mesh = 0;
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const GlbObject& object = scene.objects[i];
        const uint32_t parent = object.info.parent;
        Json json;
        if (!object.info.name.empty()) json["name"] = object.info.name;
        if (object.primitiveCount > 0) json["mesh"] = mesh++;
        if (!children[i].empty()) json["children"] = children[i];
        const Vec3d t = object.translation;
        if (parent < i) {
            const Vec3d local = t - scene.objects[parent].translation;
            if (local != Vec3d(0.0)) json["translation"] = {local.x, local.y, local.z};
        } else if (scene.turnsZUp) {  // (x, y, z) -> (x, z, -y), columns first
            json["matrix"] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, t.x, t.z, -t.y, 1};
        } else if (t != Vec3d(0.0)) {
            json["translation"] = {t.x, t.y, t.z};
        }
        array.add(json.is_null() ? Json::object() : json);
    }
    return roots;
}

void writeScene(const std::vector<uint32_t>& roots, const Write& write) {
    Json scene = Json::object();
    if (!roots.empty()) scene["nodes"] = roots;
    write(",\"scene\":0");
    ArrayWriter(write, "scenes").add(scene);
}

// The order in which meshes and accessors list the primitives.
std::vector<uint32_t> primitivesByObject(const GlbScene& scene) {
    std::vector<uint32_t> order(scene.primitives.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return scene.primitives[a].object < scene.primitives[b].object;
    });
    return order;
}

void writeMeshes(const GlbScene& scene, const std::vector<uint32_t>& order,
                 const std::vector<uint32_t>& twins, const Write& write) {
    ArrayWriter array(write, "meshes");
    uint32_t accessor = 0;
    for (size_t i = 0; i < order.size();) {
        const uint32_t object = scene.primitives[order[i]].object;
        Json primitives = Json::array();
        for (; i < order.size() && scene.primitives[order[i]].object == object; ++i) {
            const GlbPrimitive& primitive = scene.primitives[order[i]];
            const bool hasColours = primitive.colourOffset != GlbPrimitive::kAbsent;
            Json json;
            json["attributes"]["POSITION"] = accessor++;
            if (primitive.normalOffset != GlbPrimitive::kAbsent) {
                json["attributes"]["NORMAL"] = accessor++;
            }
            if (hasColours) json["attributes"]["COLOR_0"] = accessor++;
            json["indices"] = accessor++;
            if (primitive.material < twins.size()) {
                json["material"] = hasColours ? twins[primitive.material] : primitive.material;
            }
            primitives.push_back(std::move(json));
        }
        array.add({{"primitives", primitives}});
    }
}

void writeAccessors(const GlbScene& scene, const std::vector<uint32_t>& order,
                    const std::array<int, 4>& views, const Write& write) {
    ArrayWriter array(write, "accessors");
    const auto accessor = [&](int stream, uint64_t offset, int component, uint32_t count,
                              const char* type) {
        Json json = {{"bufferView", views[static_cast<size_t>(stream)]},
                     {"byteOffset", offset},
                     {"componentType", component},
                     {"count", count},
                     {"type", type}};
        return json;
    };
    for (const uint32_t index : order) {
        const GlbPrimitive& p = scene.primitives[index];
        Json position = accessor(0, p.positionOffset, kFloat, p.vertexCount, "VEC3");
        position["min"] = {p.min.x, p.min.y, p.min.z};
        position["max"] = {p.max.x, p.max.y, p.max.z};
        array.add(position);
        if (p.normalOffset != GlbPrimitive::kAbsent) {
            array.add(accessor(1, p.normalOffset, kFloat, p.vertexCount, "VEC3"));
        }
        if (p.colourOffset != GlbPrimitive::kAbsent) {
            Json colour = accessor(2, p.colourOffset, kUnsignedShort, p.vertexCount, "VEC4");
            colour["normalized"] = true;
            array.add(colour);
        }
        array.add(accessor(3, p.indexOffset, kUnsignedShort, p.indexCount, "SCALAR"));
    }
}

// One view a stream that holds anything; returns their numbers.
std::array<int, 4> writeViews(const GlbScene& scene, const Write& write) {
    constexpr std::array<int, 4> kStrides{12, 12, 8, 0};
    std::array<int, 4> numbers{};
    int next = 0;
    uint64_t offset = 0;
    ArrayWriter array(write, "bufferViews");
    for (size_t stream = 0; stream < 4; ++stream) {
        const uint64_t bytes = scene.streamBytes[stream];
        if (bytes == 0) continue;
        Json json = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}};
        if (kStrides[stream] > 0) json["byteStride"] = kStrides[stream];
        json["target"] = stream == 3 ? 34963 : 34962;  // indices, vertices
        array.add(json);
        numbers[stream] = next++;
        offset += bytes;
    }
    return numbers;
}

}  // namespace

void writeGlbJson(const GlbScene& scene, const Write& write) {
    write(R"({"asset":{"version":"2.0","generator":"Pagoda"})");
    writeScene(writeNodes(scene, write), write);
    const std::vector<uint32_t> twins = writeMaterials(scene, write);
    const std::vector<uint32_t> order = primitivesByObject(scene);
    writeMeshes(scene, order, twins, write);
    writeAccessors(scene, order, writeViews(scene, write), write);
    if (scene.binBytes() > 0) {
        ArrayWriter(write, "buffers").add({{"byteLength", scene.binBytes()}});
    }
    write("}");
}

}  // namespace pagoda::ooc
