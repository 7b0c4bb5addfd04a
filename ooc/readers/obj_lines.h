// obj_lines.h: the lines of an OBJ file as its keywords see them.
#pragma once

#include "ooc/readers/text_scan.h"
#include "ooc/readers/text_stream.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace pagoda::ooc {

enum class ObjKeyword : uint8_t {
    Position,         // v
    Normal,           // vn
    Face,             // f, fo
    Object,           // o
    Group,            // g
    UseMaterial,      // usemtl
    MaterialLibrary,  // mtllib
    Line,             // l
    Point,            // p
    FreeForm,         // curv, surf and what belongs to them
    Silent,           // empty, comment, vt, s and others that carry nothing we draw
    Unknown
};

// Lines with continuations ("\" at the end) joined, comments cut off, and the keyword recognised.
class ObjLines {
public:
    ObjLines(const SourceFile& source, ProgressMeter* meter) : text_(source, meter) {}

    // False at the end of the file. `rest` is what follows the keyword, valid until the next call.
    [[nodiscard]] bool next(ObjKeyword& keyword, TextCursor& rest);
    [[nodiscard]] uint64_t lineNumber() const noexcept { return text_.lineNumber(); }

private:
    [[nodiscard]] std::string_view joined(std::string_view line);

    TextStream text_;
    std::string joined_;
};

}  // namespace pagoda::ooc
