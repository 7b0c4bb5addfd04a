#include "ooc/readers/gltf_fields.h"

#include "ooc/readers/gltf_document.h"

#include <fmt/format.h>

#include <limits>

namespace pagoda::ooc::gltf {
namespace {

constexpr uint64_t kMaxExactInteger = uint64_t{1} << 53;  // as JSON is read elsewhere

}  // namespace

void JsonFields::refuse(const Where& where, const std::string& what) const {
    source_.fail(where, what, kValidate);
}

const Json& JsonFields::section(const char* name) const {
    static const Json kNothing = Json::array();
    const auto found = root_.find(name);
    if (found == root_.end()) return kNothing;
    if (!found->is_array()) refuse(name, "is not an array");
    return *found;
}

const Json* JsonFields::member(const Json& object, const char* key, const Where& where) const {
    const auto found = object.find(key);
    if (found == object.end()) return nullptr;
    if (!found->is_object()) {
        refuse(where.empty() ? Where(key) : where + "." + key, "is not an object");
    }
    return &*found;
}

const Json* JsonFields::extension(const Json& object, const char* name, const Where& where) const {
    const Json* extensions = member(object, "extensions", where);
    return extensions == nullptr ? nullptr : member(*extensions, name, where + ".extensions");
}

void JsonFields::checkIndex(const Json& value, const char* target, const Where& where) const {
    if (!value.is_number_unsigned()) refuse(where, "is not a whole number from 0");
    const uint64_t index = value.get<uint64_t>();
    const uint64_t count =
        *target == '\0' ? uint64_t{std::numeric_limits<int>::max()} + 1 : uint64_t{sizeOf(target)};
    if (index < count) return;
    refuse(where,
           "is " + std::to_string(index) +
               (*target == '\0' ? std::string(", too large")
                                : ", but there are " + std::to_string(count) + " " + target));
}

void JsonFields::checkField(const Json& value, const Field& field, const Where& where) const {
    switch (field.kind) {
        case Kind::Text:
            if (!value.is_string()) refuse(where, "is not a string");
            return;
        case Kind::Bool:
            if (!value.is_boolean()) refuse(where, "is not true or false");
            return;
        case Kind::Number:
            if (!value.is_number()) refuse(where, "is not a number");
            return;
        case Kind::Size:
            if (!value.is_number_unsigned() || value.get<uint64_t>() > kMaxExactInteger) {
                refuse(where, "is not a whole number from 0 to 2^53");
            }
            return;
        case Kind::Index:
            checkIndex(value, field.section, where);
            return;
        case Kind::Numbers:
            if (!value.is_array() || value.size() != field.length) {
                refuse(where, "is not an array of " + std::to_string(field.length) + " numbers");
            }
            for (const Json& item : value) {
                if (!item.is_number()) refuse(where, "holds something that is not a number");
            }
            return;
        case Kind::Indices:
            if (!value.is_array()) refuse(where, "is not an array");
            for (size_t i = 0; i < value.size(); ++i) {
                checkIndex(value[i], field.section, place(where.c_str(), i));
            }
            return;
        case Kind::IndexMap:
            if (!value.is_object()) refuse(where, "is not an object");
            for (const auto& [key, item] : value.items()) {
                checkIndex(item, field.section, fmt::format("{}.{}", where, key));
            }
            return;
    }
}

Json JsonFields::copy(const Json& from, std::span<const Field> fields, const Where& where) const {
    if (!from.is_object()) refuse(where, "is not an object");
    Json to = Json::object();
    for (const Field& field : fields) {
        const auto found = from.find(field.key);
        if (found == from.end()) {
            if (field.isRequired) refuse(where, std::string("has no \"") + field.key + "\"");
            continue;
        }
        checkField(*found, field, where + "." + field.key);
        to[field.key] = *found;
    }
    return to;
}

}  // namespace pagoda::ooc::gltf
