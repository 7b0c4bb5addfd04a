// gltf_fields.h: objects of a JSON document checked and copied field by field, by tables.
#pragma once

#include "ooc/readers/source_file.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace pagoda::ooc::gltf {

using Json = nlohmann::json;

enum class Kind : uint8_t { Text, Bool, Number, Size, Index, Numbers, Indices, IndexMap };

struct Field {
    const char* key;
    Kind kind;
    const char* section = "";  // Index, Indices, IndexMap: the array that they point into
    size_t length = 0;         // Numbers: how many
    bool isRequired = false;
};

// Reads a document by tables of fields. What is unsound is refused with its place in the document
// ("nodes[3].children[0]"); fields that no table names are left behind.
class JsonFields {
public:
    using Where = std::string;

    // Keeps both for its own lifetime; `root` must be an object.
    JsonFields(const SourceFile& source, const Json& root) : source_(source), root_(root) {}

    [[noreturn]] void refuse(const Where& where, const std::string& what) const;
    // An array of the document's root; an empty one where it is missing.
    [[nodiscard]] const Json& section(const char* name) const;
    [[nodiscard]] size_t sizeOf(const char* name) const { return section(name).size(); }
    // Objects within objects; null where they are missing.
    [[nodiscard]] const Json* member(const Json& object, const char* key, const Where& where) const;
    [[nodiscard]] const Json* extension(const Json& object, const char* name,
                                        const Where& where) const;
    // A whole number that names an item of `target`; of an empty one: that fits an int.
    void checkIndex(const Json& value, const char* target, const Where& where) const;
    // A new object of the fields that the table names.
    [[nodiscard]] Json copy(const Json& from, std::span<const Field> fields,
                            const Where& where) const;

protected:
    const SourceFile& source_;
    const Json& root_;

private:
    void checkField(const Json& value, const Field& field, const Where& where) const;
};

}  // namespace pagoda::ooc::gltf
