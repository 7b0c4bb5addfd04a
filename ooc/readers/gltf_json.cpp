// gltf_json.cpp: the check of a glTF document before tinygltf sees it. Tables of the fields that
// are used; each is copied if it is sound, refused with its place if not. Everything else (extras,
// animations, cameras, unknown extensions) is left behind, so nesting is bounded too.
#include "ooc/base/error.h"
#include "ooc/readers/gltf_document.h"
#include "ooc/readers/gltf_fields.h"

#include <algorithm>
#include <span>
#include <string_view>

namespace pagoda::ooc::gltf {
namespace {

constexpr Field kAsset[] = {{"version", Kind::Text, "", 0, true},
                            {"minVersion", Kind::Text},
                            {"copyright", Kind::Text},
                            {"generator", Kind::Text}};
constexpr Field kScene[] = {{"name", Kind::Text}, {"nodes", Kind::Indices, "nodes"}};
constexpr Field kNode[] = {{"name", Kind::Text},
                           {"mesh", Kind::Index, "meshes"},
                           {"children", Kind::Indices, "nodes"},
                           {"matrix", Kind::Numbers, "", 16},
                           {"rotation", Kind::Numbers, "", 4},
                           {"scale", Kind::Numbers, "", 3},
                           {"translation", Kind::Numbers, "", 3}};
constexpr Field kInstancing[] = {{"attributes", Kind::IndexMap, "accessors", 0, true}};
constexpr Field kMesh[] = {{"name", Kind::Text}};
constexpr Field kPrimitive[] = {{"attributes", Kind::IndexMap, "accessors"},
                                {"indices", Kind::Index, "accessors"},
                                {"material", Kind::Index, "materials"},
                                {"mode", Kind::Size}};
constexpr Field kDraco[] = {{"bufferView", Kind::Index, "bufferViews", 0, true},
                            {"attributes", Kind::IndexMap, "", 0, true}};
constexpr Field kAccessor[] = {
    {"bufferView", Kind::Index, "bufferViews"}, {"byteOffset", Kind::Size},
    {"componentType", Kind::Size, "", 0, true}, {"count", Kind::Size, "", 0, true},
    {"type", Kind::Text, "", 0, true},          {"normalized", Kind::Bool}};
constexpr Field kSparse[] = {{"count", Kind::Index, "", 0, true}};
constexpr Field kSparseIndices[] = {{"bufferView", Kind::Index, "bufferViews", 0, true},
                                    {"byteOffset", Kind::Index},
                                    {"componentType", Kind::Size, "", 0, true}};
constexpr Field kSparseValues[] = {{"bufferView", Kind::Index, "bufferViews", 0, true},
                                   {"byteOffset", Kind::Index}};
constexpr Field kBufferView[] = {{"buffer", Kind::Index, "buffers", 0, true},
                                 {"byteOffset", Kind::Size},
                                 {"byteLength", Kind::Size, "", 0, true},
                                 {"byteStride", Kind::Size}};
constexpr Field kMeshopt[] = {{"buffer", Kind::Index, "buffers", 0, true},
                              {"byteOffset", Kind::Size},
                              {"byteLength", Kind::Size, "", 0, true},
                              {"byteStride", Kind::Size, "", 0, true},
                              {"count", Kind::Size, "", 0, true},
                              {"mode", Kind::Text, "", 0, true},
                              {"filter", Kind::Text}};
constexpr Field kBuffer[] = {{"uri", Kind::Text}, {"byteLength", Kind::Size, "", 0, true}};
constexpr Field kImage[] = {{"uri", Kind::Text}, {"bufferView", Kind::Index, "bufferViews"}};
constexpr Field kMaterial[] = {{"name", Kind::Text}, {"alphaMode", Kind::Text}};
constexpr Field kPbr[] = {{"baseColorFactor", Kind::Numbers, "", 4}};
constexpr Field kSpecularGlossiness[] = {{"diffuseFactor", Kind::Numbers, "", 4}};
constexpr Field kTextureInfo[] = {{"index", Kind::Index, "textures", 0, true},
                                  {"texCoord", Kind::Index}};
constexpr Field kTextureTransform[] = {{"offset", Kind::Numbers, "", 2},
                                       {"rotation", Kind::Number},
                                       {"scale", Kind::Numbers, "", 2},
                                       {"texCoord", Kind::Index}};
constexpr Field kTexture[] = {{"sampler", Kind::Index, "samplers"},
                              {"source", Kind::Index, "images"}};
constexpr Field kWebp[] = {{"source", Kind::Index, "images", 0, true}};
constexpr Field kSampler[] = {
    {"magFilter", Kind::Index}, {"wrapS", Kind::Index}, {"wrapT", Kind::Index}};

// Required extensions that we understand, or whose absence leaves the shapes as they are.
constexpr std::string_view kUnderstood[] = {"KHR_draco_mesh_compression",
                                            "EXT_meshopt_compression",
                                            "KHR_meshopt_compression",
                                            "EXT_mesh_gpu_instancing",
                                            "KHR_mesh_quantization",
                                            "FB_ngon_encoding",
                                            "KHR_xmp_json_ld",
                                            "KHR_animation_pointer"};
constexpr std::string_view kHarmlessPrefixes[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                  "MSFT_texture_",  "KHR_lights_",  "EXT_lights_"};

class Checker : private JsonFields {
public:
    Checker(const SourceFile& source, const Json& root, Extras& extras)
        : JsonFields(source, root), extras_(extras) {}

    std::string run();

private:
    template <typename CopyOne>
    void copySection(const char* name, CopyOne&& copyOne);

    void checkAsset();
    void checkExtensions();
    Json copyNode(const Json& from, const Where& where);
    Json copyMesh(const Json& from, const Where& where);
    Json copyPrimitive(const Json& from, const Where& where);
    Json copyAccessor(const Json& from, const Where& where) const;
    Json copyBufferView(const Json& from, const Where& where);
    MeshoptView meshoptView(const Json& from, const Where& where) const;
    Json copyMaterial(const Json& from, const Where& where) const;
    Json copyTextureInfo(const Json& from, const Where& where) const;
    Json copyTexture(const Json& from, const Where& where) const;
    void readBuffers();
    void readImages();

    Extras& extras_;
    Json out_ = Json::object();
};

template <typename CopyOne>
void Checker::copySection(const char* name, CopyOne&& copyOne) {
    const Json& items = section(name);
    Json& to = out_[name] = Json::array();
    for (size_t i = 0; i < items.size(); ++i) {
        const Where where = place(name, i);
        if (!items[i].is_object()) refuse(where, "is not an object");
        to.push_back(copyOne(items[i], where));
    }
}

void Checker::checkAsset() {
    const Json* asset = member(root_, "asset", "");
    if (asset == nullptr) refuse("asset", "is missing: not a glTF 2.0 file");
    out_["asset"] = copy(*asset, kAsset, "asset");
    for (const char* key : {"version", "minVersion"}) {
        const auto found = out_["asset"].find(key);
        if (found == out_["asset"].end()) continue;
        const std::string version = found->get<std::string>();
        const bool isKnown =
            std::string_view(key) == "version" ? version.starts_with("2.") : version == "2.0";
        if (!isKnown) {
            source_.fail(std::string("asset.") + key, "glTF version \"" + version + "\", not 2.0",
                         "convert it to glTF 2.0");
        }
    }
}

void Checker::checkExtensions() {
    for (const Json& item : section("extensionsRequired")) {
        if (!item.is_string()) refuse("extensionsRequired", "holds something that is not a string");
        const std::string name = item.get<std::string>();
        bool isKnown = false;
        for (const std::string_view known : kUnderstood) isKnown |= name == known;
        for (const std::string_view prefix : kHarmlessPrefixes) isKnown |= name.starts_with(prefix);
        if (!isKnown) {
            source_.fail("extensionsRequired",
                         "needs the extension " + name + ", which is not read",
                         "export it without");
        }
    }
    if (sizeOf("animations") > 0) extras_.ignored["animation"] = sizeOf("animations");
}

Json Checker::copyNode(const Json& from, const Where& where) {
    Json to = copy(from, kNode, where);
    if (const Json* instancing = extension(from, "EXT_mesh_gpu_instancing", where)) {
        to["extensions"]["EXT_mesh_gpu_instancing"] =
            copy(*instancing, kInstancing, where + ".extensions.EXT_mesh_gpu_instancing");
    }
    if (from.contains("skin")) ++extras_.ignored["skin (drawn unposed)"];
    return to;
}

Json Checker::copyPrimitive(const Json& from, const Where& where) {
    Json to = copy(from, kPrimitive, where);
    if (!to.contains("attributes")) to["attributes"] = Json::object();  // drawn as nothing
    if (to.value("mode", uint64_t{TINYGLTF_MODE_TRIANGLES}) > TINYGLTF_MODE_TRIANGLE_FAN) {
        refuse(where + ".mode", "is not one of the modes 0 to 6");
    }
    if (const Json* draco = extension(from, "KHR_draco_mesh_compression", where)) {
        to["extensions"]["KHR_draco_mesh_compression"] =
            copy(*draco, kDraco, where + ".extensions.KHR_draco_mesh_compression");
    }
    if (from.contains("targets")) ++extras_.ignored["morph targets"];
    return to;
}

Json Checker::copyMesh(const Json& from, const Where& where) {
    Json to = copy(from, kMesh, where);
    Json& primitives = to["primitives"] = Json::array();
    const auto found = from.find("primitives");
    if (found == from.end() || !found->is_array()) refuse(where, "has no array \"primitives\"");
    for (size_t i = 0; i < found->size(); ++i) {
        primitives.push_back(copyPrimitive((*found)[i], where + "." + place("primitives", i)));
    }
    return to;
}

Json Checker::copyAccessor(const Json& from, const Where& where) const {
    Json to = copy(from, kAccessor, where);
    const auto checkComponentType = [&](const Json& object, const Where& at) {
        const uint64_t type = object["componentType"].get<uint64_t>();
        if (type < 5120 || type > 5126 || type == 5124) {
            refuse(at + ".componentType", "is " + std::to_string(type) + ", which is not a type");
        }
    };
    checkComponentType(to, where);
    constexpr std::string_view kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4",
                                           "MAT2",   "MAT3", "MAT4"};
    const std::string type = to["type"].get<std::string>();
    if (std::ranges::find(kTypes, type) == std::end(kTypes)) {
        refuse(where + ".type", "is \"" + type + "\", which is not a type");
    }
    const Json* sparse = member(from, "sparse", where);
    if (sparse == nullptr) return to;
    const Where at = where + ".sparse";
    Json& sparseTo = to["sparse"] = copy(*sparse, kSparse, at);
    const Json* indices = member(*sparse, "indices", at);
    const Json* values = member(*sparse, "values", at);
    if (indices == nullptr || values == nullptr) refuse(at, "has no indices or no values");
    sparseTo["indices"] = copy(*indices, kSparseIndices, at + ".indices");
    checkComponentType(sparseTo["indices"], at + ".indices");
    sparseTo["values"] = copy(*values, kSparseValues, at + ".values");
    return to;
}

MeshoptView Checker::meshoptView(const Json& from, const Where& where) const {
    const Json checked = copy(from, kMeshopt, where);
    MeshoptView view;
    view.buffer = checked["buffer"].get<int>();
    view.byteOffset = checked.value("byteOffset", uint64_t{0});
    view.byteLength = checked["byteLength"].get<uint64_t>();
    view.byteStride = checked["byteStride"].get<uint64_t>();
    view.count = checked["count"].get<uint64_t>();
    const auto choose = [&](const char* key, std::string_view fallback,
                            std::span<const std::string_view> names) {
        const std::string name = checked.value(key, std::string(fallback));
        const auto found = std::ranges::find(names, name);
        if (found == names.end()) {
            refuse(where + "." + key, "is \"" + name + "\", which is not known");
        }
        return static_cast<uint8_t>(found - names.begin());
    };
    constexpr std::string_view kModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
    constexpr std::string_view kFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL",
                                             "COLOR"};
    view.mode = static_cast<MeshoptView::Mode>(choose("mode", "", kModes));
    view.filter = static_cast<MeshoptView::Filter>(choose("filter", "NONE", kFilters));
    return view;
}

Json Checker::copyBufferView(const Json& from, const Where& where) {
    Json to = copy(from, kBufferView, where);
    // tinygltf refuses strides that are no multiple of 4, which exporters write for index views.
    extras_.strides.push_back(to.value("byteStride", uint64_t{0}));
    to.erase("byteStride");
    std::optional<MeshoptView>& meshopt = extras_.meshopt.emplace_back();
    for (const char* name : {"KHR_meshopt_compression", "EXT_meshopt_compression"}) {
        const Json* compressed = extension(from, name, where);
        if (compressed != nullptr && !meshopt) {
            meshopt = meshoptView(*compressed, where + ".extensions." + name);
        }
    }
    return to;
}

Json Checker::copyTextureInfo(const Json& from, const Where& where) const {
    Json to = copy(from, kTextureInfo, where);
    if (const Json* transform = extension(from, "KHR_texture_transform", where)) {
        to["extensions"]["KHR_texture_transform"] =
            copy(*transform, kTextureTransform, where + ".extensions.KHR_texture_transform");
    }
    return to;
}

Json Checker::copyMaterial(const Json& from, const Where& where) const {
    Json to = copy(from, kMaterial, where);
    if (const Json* pbr = member(from, "pbrMetallicRoughness", where)) {
        const Where at = where + ".pbrMetallicRoughness";
        Json& pbrTo = to["pbrMetallicRoughness"] = copy(*pbr, kPbr, at);
        if (const Json* info = member(*pbr, "baseColorTexture", at)) {
            pbrTo["baseColorTexture"] = copyTextureInfo(*info, at + ".baseColorTexture");
        }
    }
    constexpr const char* kName = "KHR_materials_pbrSpecularGlossiness";
    if (const Json* glossy = extension(from, kName, where)) {
        const Where at = where + ".extensions." + kName;
        Json& glossyTo = to["extensions"][kName] = copy(*glossy, kSpecularGlossiness, at);
        if (const Json* info = member(*glossy, "diffuseTexture", at)) {
            glossyTo["diffuseTexture"] = copyTextureInfo(*info, at + ".diffuseTexture");
        }
        // An empty extension is dropped by tinygltf, but still replaces the base colour.
        glossyTo["present"] = true;
    }
    return to;
}

Json Checker::copyTexture(const Json& from, const Where& where) const {
    Json to = copy(from, kTexture, where);
    if (const Json* webp = extension(from, "EXT_texture_webp", where)) {
        to["extensions"]["EXT_texture_webp"] = copy(*webp, kWebp, where + ".extensions");
    }
    return to;
}

void Checker::readBuffers() {
    for (size_t i = 0; i < sizeOf("buffers"); ++i) {
        const Json checked = copy(section("buffers")[i], kBuffer, place("buffers", i));
        extras_.buffers.push_back(
            {checked.value("uri", std::string()), checked["byteLength"].get<uint64_t>()});
    }
}

void Checker::readImages() {
    for (size_t i = 0; i < sizeOf("images"); ++i) {
        const Json checked = copy(section("images")[i], kImage, place("images", i));
        extras_.images.push_back(
            {checked.value("uri", std::string()), checked.value("bufferView", -1)});
    }
}

std::string Checker::run() {
    if (!root_.is_object()) refuse("JSON", "is not an object");
    checkAsset();
    checkExtensions();
    readBuffers();
    readImages();
    copySection("bufferViews", [&](auto& from, auto& at) { return copyBufferView(from, at); });
    copySection("accessors", [&](auto& from, auto& at) { return copyAccessor(from, at); });
    copySection("meshes", [&](auto& from, auto& at) { return copyMesh(from, at); });
    copySection("nodes", [&](auto& from, auto& at) { return copyNode(from, at); });
    copySection("scenes", [&](auto& from, auto& at) { return copy(from, kScene, at); });
    copySection("materials", [&](auto& from, auto& at) { return copyMaterial(from, at); });
    copySection("textures", [&](auto& from, auto& at) { return copyTexture(from, at); });
    copySection("samplers", [&](auto& from, auto& at) { return copy(from, kSampler, at); });
    if (root_.contains("scene")) {
        checkIndex(root_["scene"], "scenes", "scene");
        out_["scene"] = root_["scene"];
    }
    // tinygltf wants a buffer view for indices, which Draco leaves out: they get one of no use,
    // one past the end, and loadDocument() takes it away again.
    const size_t views = out_["bufferViews"].size();
    out_["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
    for (const Json& mesh : out_["meshes"]) {
        for (const Json& primitive : mesh["primitives"]) {
            if (!primitive.contains("indices")) continue;
            Json& accessor = out_["accessors"][primitive["indices"].get<size_t>()];
            if (!accessor.contains("bufferView")) accessor["bufferView"] = views;
        }
    }
    return out_.dump();
}

// A number beyond the range of a double: the library quotes it, but does not say where it is.
[[noreturn]] void failNumber(const SourceFile& source, std::string_view text,
                             std::string_view said) {
    const size_t end = said.rfind('\''), begin = end == 0 ? end : said.rfind('\'', end - 1);
    if (begin == std::string_view::npos || end == begin) {
        source.fail("JSON", std::string(said), kValidate);
    }
    const std::string_view number = said.substr(begin + 1, end - begin - 1);
    source.fail("byte " + std::to_string(text.find(number) + 1) + " of the JSON",
                std::string(number) + " is beyond the range of a double", kValidate);
}

}  // namespace

std::string checkJson(const SourceFile& source, std::string_view text, Extras& extras) {
    try {
        const Json root = Json::parse(text);
        return Checker(source, root, extras).run();
    } catch (const Json::parse_error& failure) {
        source.fail("byte " + std::to_string(failure.byte) + " of the JSON", "not JSON", kValidate);
    } catch (const Json::out_of_range& failure) {
        failNumber(source, text, failure.what());
    }
}

}  // namespace pagoda::ooc::gltf
