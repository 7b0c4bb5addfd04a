#include "ooc/readers/obj_faces.h"

namespace pagoda::ooc {
namespace {

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

// A whole number at `at`, or 0 (which no index of OBJ is) if there is none or it is beyond reason.
int64_t wholeNumber(const char*& at, const char* end) {
    constexpr int kMaxDigits = 17;
    const bool isNegative = at != end && *at == '-';
    if (isNegative || (at != end && *at == '+')) ++at;
    const char* first = at;
    int64_t value = 0;
    for (; at != end && isDigit(*at); ++at) {
        if (at - first < kMaxDigits) value = value * 10 + (*at - '0');
    }
    if (at - first > kMaxDigits) return 0;
    return isNegative ? -value : value;
}

uint64_t resolve(int64_t index, uint64_t soFar, uint64_t none) {
    const auto count = static_cast<int64_t>(soFar);
    if (index > 0 && index <= count) return static_cast<uint64_t>(index - 1);
    if (index < 0 && -index <= count) return static_cast<uint64_t>(count + index);
    return none;
}

uint32_t multiply(uint32_t a, uint32_t b) {
    uint32_t product = 0;
    for (unsigned shift = 0; shift < 32; shift += 8) {
        const uint32_t x = a >> shift & 255u, y = b >> shift & 255u;
        product |= (x * y + 127) / 255 << shift;
    }
    return product;
}

}  // namespace

ObjFaces::ObjFaces(const ObjVertices& vertices, const ObjMaterials& materials, TriangleSink& sink)
    : vertices_(vertices),
      library_(materials),
      sink_(sink),
      batcher_(sink, vertices.hasColours(), vertices.hasNormals()) {
}

void ObjFaces::setObject(std::string_view name) {
    object_ = name;
    group_.clear();
    isAimed_ = false;
}

void ObjFaces::setGroup(std::string_view name) {
    group_ = name;
    isAimed_ = false;
}

void ObjFaces::setMaterial(std::string_view name) {
    material_ = name;
    isAimed_ = false;
}

void ObjFaces::face(TextCursor text, uint64_t positionsSoFar, uint64_t normalsSoFar) {
    corners_.clear();
    while (corners_.size() < kMaxCutCorners && !text.atEnd()) {
        corners_.push_back(parseCorner(text, positionsSoFar, normalsSoFar));
    }
    if (corners_.size() < 3) return batcher_.drop(DropReason::TooFewCorners);
    if (!isAimed_) aim();
    if (corners_.size() == 3) return triangle(corners_[0], corners_[1], corners_[2]);
    if (text.atEnd()) return cutPolygon();
    ++fans_;  // as it streams: a line may be long
    fan();
    while (!text.atEnd()) {
        const Reference corner = parseCorner(text, positionsSoFar, normalsSoFar);
        triangle(corners_.front(), corners_.back(), corner);
        corners_.back() = corner;
    }
}

ObjFaces::Reference ObjFaces::parseCorner(TextCursor& text, uint64_t positionsSoFar,
                                          uint64_t normalsSoFar) {
    Reference reference;
    const char* at = text.at;
    const int64_t position = wholeNumber(at, text.end);
    int64_t normal = 0;
    bool namesNormal = false;
    if (at != text.end && *at == '/') {
        (void)wholeNumber(++at, text.end);  // texture coordinates
        if (at != text.end && *at == '/') {
            namesNormal = ++at != text.end && !isBlank(*at);
            normal = wholeNumber(at, text.end);
        }
    }
    const bool isClean = at == text.end || isBlank(*at);
    while (at != text.end && !isBlank(*at)) ++at;
    text.at = at;
    if (isClean) reference.position = resolve(position, positionsSoFar, kNone);
    if (namesNormal) {
        reference.normal = resolve(normal, normalsSoFar, kNone);
        missingNormals_ += reference.normal == kNone ? 1 : 0;
    }
    return reference;
}

void ObjFaces::cutPolygon() {
    positions_.clear();
    for (const Reference& corner : corners_) {
        if (corner.position == kNone) return fan();  // drops least
        positions_.push_back(vertices_.position(corner.position));
    }
    for (const PolygonCutter::Triangle& t : cutter_.cut(positions_)) {
        triangle(corners_[t[0]], corners_[t[1]], corners_[t[2]]);
    }
}

void ObjFaces::fan() {
    for (size_t k = 2; k < corners_.size(); ++k) {
        triangle(corners_[0], corners_[k - 1], corners_[k]);
    }
}

void ObjFaces::triangle(const Reference& a, const Reference& b, const Reference& c) {
    if (a.position == kNone || b.position == kNone || c.position == kNone) {
        return batcher_.drop(DropReason::IndexOutOfRange);
    }
    if (!batcher_.hasColours() && !batcher_.hasNormals()) {
        return batcher_.add(vertices_.position(a.position), vertices_.position(b.position),
                            vertices_.position(c.position));
    }
    batcher_.add(cornerOf(a), cornerOf(b), cornerOf(c));
}

Corner ObjFaces::cornerOf(const Reference& reference) const {
    Corner corner;
    corner.position = vertices_.position(reference.position);
    if (vertices_.hasColours()) {
        corner.colour = multiply(vertices_.colour(reference.position), colour_);
    }
    if (vertices_.hasNormals() && reference.normal != kNone) {
        corner.normal = vertices_.normal(reference.normal);
    }
    return corner;
}

void ObjFaces::aim() {
    const uint32_t object = objectId(object_, group_);
    batcher_.setTarget(object, materialId());
    isAimed_ = true;
}

uint32_t ObjFaces::objectId(const std::string& object, const std::string& group) {
    const auto [found, isNew] = objectIds_.try_emplace({object, group}, kUnknown);
    if (isNew) {
        ObjectInfo info;
        info.name = toUtf8(group.empty() ? object : group);
        if (!group.empty() && !object.empty()) info.parent = objectId(object, {});
        found->second = sink_.addObject(info);
    }
    return found->second;
}

uint32_t ObjFaces::materialId() {
    const auto [found, isNew] = materialIds_.try_emplace(material_);
    if (isNew) {
        MaterialInfo info;
        if (const ObjMaterials::Material* material = library_.find(material_)) {
            info = material->info;
            textures_ += material->hasTexture ? 1 : 0;
        } else if (!material_.empty()) {
            info.name = toUtf8(material_);
            ++undefinedMaterials_;
        }
        found->second = {sink_.addMaterial(info), info.colour};
    }
    colour_ = found->second.second;
    return found->second.first;
}

void ObjFaces::finish() {
    batcher_.finish();
    const auto say = [&](std::string_view what, uint64_t count) {
        if (count > 0) sink_.ignored(what, count);
    };
    say("material without a definition", undefinedMaterials_);
    say("texture of a material", textures_);
    say("normal that does not exist", missingNormals_);
    say("concavity of a polygon of more than 1024 corners", fans_);
}

}  // namespace pagoda::ooc
