#include "ooc/readers/obj_lines.h"

#include <algorithm>
#include <array>

namespace pagoda::ooc {
namespace {

constexpr std::array<std::string_view, 22> kFreeFormWords = {
    "vp",   "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm",  "trim",  "hole",
    "scrv", "sp",     "end", "con",  "bzp",  "bsp",  "cdc",   "cdp",  "ctech", "stech", "res"};
constexpr std::array<std::string_view, 13> kSilentWords = {
    "s",         "mg", "bevel",  "c_interp", "d_interp", "lod", "shadow_obj",
    "trace_obj", "vt", "maplib", "usemap",   "call",     "csh"};

ObjKeyword longKeyword(std::string_view word) {
    if (word == "usemtl") return ObjKeyword::UseMaterial;
    if (word == "mtllib") return ObjKeyword::MaterialLibrary;
    if (word == "fo") return ObjKeyword::Face;
    if (std::ranges::find(kSilentWords, word) != kSilentWords.end()) return ObjKeyword::Silent;
    if (std::ranges::find(kFreeFormWords, word) != kFreeFormWords.end()) {
        return ObjKeyword::FreeForm;
    }
    return ObjKeyword::Unknown;
}

ObjKeyword keywordOf(std::string_view word) {
    if (word.empty() || word[0] == '#') return ObjKeyword::Silent;
    if (word.size() == 1) {
        switch (word[0]) {
            case 'v':
                return ObjKeyword::Position;
            case 'f':
                return ObjKeyword::Face;
            case 'o':
                return ObjKeyword::Object;
            case 'g':
                return ObjKeyword::Group;
            case 'l':
                return ObjKeyword::Line;
            case 'p':
                return ObjKeyword::Point;
            default:
                break;
        }
    }
    if (word == "vn") return ObjKeyword::Normal;
    if (word == "vt") return ObjKeyword::Silent;
    return longKeyword(word);
}

bool isContinued(std::string_view line) {
    while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return !line.empty() && line.back() == '\\';
}

// Numbers end at a comment; names may hold a '#'.
bool holdsNumbers(ObjKeyword keyword) {
    return keyword == ObjKeyword::Position || keyword == ObjKeyword::Normal ||
           keyword == ObjKeyword::Face;
}

}  // namespace

bool ObjLines::next(ObjKeyword& keyword, TextCursor& rest) {
    std::string_view line;
    if (!text_.next(line)) return false;
    if (isContinued(line)) line = joined(line);
    rest = TextCursor(line);
    keyword = keywordOf(rest.word());
    if (holdsNumbers(keyword)) {
        const std::string_view numbers(rest.at, static_cast<size_t>(rest.end - rest.at));
        const size_t comment = numbers.find('#');
        if (comment != numbers.npos) rest.end = rest.at + comment;
    }
    return true;
}

std::string_view ObjLines::joined(std::string_view line) {
    joined_.clear();
    while (isContinued(line)) {
        joined_.append(line.substr(0, line.rfind('\\')));
        joined_ += ' ';
        line = {};
        if (joined_.size() > TextStream::kMaxLineBytes) {
            text_.source().failAtLine(lineNumber(), "the continued line is longer than 64 MiB",
                                      "check that it is an OBJ file");
        }
        if (!text_.next(line)) break;
    }
    joined_.append(line);
    return joined_;
}

}  // namespace pagoda::ooc
