// ply_header.h: the header of a PLY file: elements, their properties, where the data begins.
#pragma once

#include "ooc/readers/source_file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pagoda::ooc {

enum class PlyFormat : uint8_t { Ascii, BinaryLittleEndian, BinaryBigEndian };
enum class PlyScalar : uint8_t { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

[[nodiscard]] constexpr size_t plyScalarBytes(PlyScalar scalar) {
    constexpr size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return kBytes[static_cast<size_t>(scalar)];
}
[[nodiscard]] constexpr bool isFloating(PlyScalar scalar) {
    return scalar >= PlyScalar::Float32;
}

struct PlyProperty {
    std::string name;  // lower case
    PlyScalar type = PlyScalar::Float32;
    std::optional<PlyScalar> countType;  // lists only

    [[nodiscard]] bool isList() const { return countType.has_value(); }
    // In binary data; for a list the least, its count.
    [[nodiscard]] size_t leastBytes() const { return plyScalarBytes(countType.value_or(type)); }
};

struct PlyElement {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties;

    [[nodiscard]] bool hasLists() const;
    [[nodiscard]] uint64_t leastBytes() const;  // of one item in binary data
    // Index of the first property with one of the names (and of a list or not, as asked).
    [[nodiscard]] std::optional<size_t> find(std::initializer_list<std::string_view> names,
                                             bool isList = false) const;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::Ascii;
    std::vector<PlyElement> elements;
    uint64_t dataOffset = 0;    // in the file
    uint64_t dataLine = 1;      // number of the data's first line, for ASCII
    uint64_t ignoredLines = 0;  // obj_info and the like

    [[nodiscard]] std::optional<size_t> findElement(std::string_view name) const;
};

// Reads and checks the header: names and types are known, no element twice, and the counts are not
// above what the file's size allows. Throws Error with the line.
[[nodiscard]] PlyHeader readPlyHeader(const SourceFile& source);

}  // namespace pagoda::ooc
