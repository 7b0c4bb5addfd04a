#include "ooc/readers/ply_header.h"

#include "ooc/readers/text_scan.h"

#include <algorithm>
#include <array>
#include <utility>

namespace pagoda::ooc {
namespace {

constexpr size_t kMaxHeaderBytes = size_t{1} << 20;  // comments can be long; data never gets here
constexpr size_t kMaxProperties = 4096;

constexpr std::array<std::pair<std::string_view, PlyScalar>, 16> kScalarNames = {{
    {"char", PlyScalar::Int8},
    {"int8", PlyScalar::Int8},
    {"uchar", PlyScalar::UInt8},
    {"uint8", PlyScalar::UInt8},
    {"short", PlyScalar::Int16},
    {"int16", PlyScalar::Int16},
    {"ushort", PlyScalar::UInt16},
    {"uint16", PlyScalar::UInt16},
    {"int", PlyScalar::Int32},
    {"int32", PlyScalar::Int32},
    {"uint", PlyScalar::UInt32},
    {"uint32", PlyScalar::UInt32},
    {"float", PlyScalar::Float32},
    {"float32", PlyScalar::Float32},
    {"double", PlyScalar::Float64},
    {"float64", PlyScalar::Float64},
}};

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return out;
}

std::string inQuotes(std::string_view text) {
    return '"' + printable(text) + '"';
}

class HeaderParser {
public:
    explicit HeaderParser(const SourceFile& source) : source_(source) {
        bytes_.resize(std::min<uint64_t>(kMaxHeaderBytes, source.sizeBytes()));
        bytes_.resize(source.file().readSomeAt(0, bytes_));
    }

    PlyHeader parse() {
        if (nextLine() != "ply") fail("does not begin with \"ply\"", "check that it is a PLY file");
        bool hasFormat = false;
        for (;;) {
            TextCursor cursor(nextLine());
            const std::string_view keyword = cursor.word();
            if (keyword.empty() || keyword == "comment") continue;
            if (keyword == "end_header") break;
            if (keyword == "obj_info") {
                ++header_.ignoredLines;
            } else if (keyword == "format") {
                parseFormat(cursor);
                hasFormat = true;
            } else if (keyword == "element") {
                parseElement(cursor);
            } else if (keyword == "property") {
                parseProperty(cursor);
            } else {
                fail("header line " + inQuotes(keyword) + " is not known");
            }
        }
        if (!hasFormat) fail("the header has no format line");
        header_.dataOffset = at_;
        header_.dataLine = line_ + 1;
        checkCounts();
        return std::move(header_);
    }

private:
    // Without blanks at either side. The first line decides how lines end: where it ends in CR LF
    // or CR alone so do all, and a line feed that begins binary data is not taken for an end.
    std::string_view nextLine() {
        const auto text =
            std::string_view(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
        if (line_ == 0) {
            const size_t end = text.find_first_of("\r\n");
            endsInCr_ = end != text.npos && text[end] == '\r' && text.substr(end, 2) != "\r\n";
        }
        ++line_;
        const size_t end = text.find(endsInCr_ ? '\r' : '\n', at_);
        if (end == text.npos) failUnended(text);
        TextCursor cursor(text.substr(at_, end - at_));
        at_ = end + 1;
        return cursor.rest();
    }

    [[noreturn]] void failUnended(std::string_view text) const {
        if (line_ == 1 && !text.starts_with("ply")) {
            fail("does not begin with \"ply\"", "check that it is a PLY file");
        }
        if (bytes_.size() == kMaxHeaderBytes) fail("the header has no end within 1 MiB");
        source_.failCutShort("line " + std::to_string(line_), "the header has no end_header");
    }

    void parseFormat(TextCursor& cursor) {
        const std::string_view name = cursor.word();
        if (name == "ascii") {
            header_.format = PlyFormat::Ascii;
        } else if (name == "binary_little_endian") {
            header_.format = PlyFormat::BinaryLittleEndian;
        } else if (name == "binary_big_endian") {
            header_.format = PlyFormat::BinaryBigEndian;
        } else {
            fail("format " + inQuotes(name) + " is not known");
        }
        (void)cursor.word();  // the version: 1.0 is the only one there is
        expectEnd(cursor);
    }

    void parseElement(TextCursor& cursor) {
        PlyElement element;
        element.name = lower(cursor.word());
        const std::string_view count = cursor.word();
        if (element.name.empty()) fail("element without a name");
        if (!parseCount(count, element.count)) fail(inQuotes(count) + " is not a count");
        expectEnd(cursor);
        if (header_.findElement(element.name))
            fail("element " + inQuotes(element.name) + " comes twice");
        header_.elements.push_back(std::move(element));
    }

    void parseProperty(TextCursor& cursor) {
        if (header_.elements.empty()) fail("property before any element");
        PlyProperty property;
        std::string_view type = cursor.word();
        if (type == "list") {
            property.countType = parseScalar(cursor.word());
            if (isFloating(*property.countType)) fail("a list cannot be counted in floats");
            type = cursor.word();
        }
        property.type = parseScalar(type);
        property.name = lower(cursor.word());
        if (property.name.empty()) fail("property without a name");
        expectEnd(cursor);
        std::vector<PlyProperty>& properties = header_.elements.back().properties;
        if (properties.size() == kMaxProperties) fail("more than 4096 properties");
        properties.push_back(std::move(property));
    }

    PlyScalar parseScalar(std::string_view name) const {
        for (const auto& [known, scalar] : kScalarNames) {
            if (name == known) return scalar;
        }
        fail("type " + inQuotes(name) + " is not known");
    }

    void expectEnd(TextCursor& cursor) const {
        if (const std::string_view rest = cursor.rest(); !rest.empty()) {
            fail(inQuotes(rest) + " is too much on this line");
        }
    }

    // No count is believed that the data cannot hold: an item takes its bytes in binary, at least a
    // digit and a separator for each value in ASCII.
    void checkCounts() const {
        uint64_t left = source_.sizeBytes() - header_.dataOffset;
        const bool isAscii = header_.format == PlyFormat::Ascii;
        if (isAscii) ++left;  // the last value needs no separator
        for (const PlyElement& element : header_.elements) {
            const uint64_t least = isAscii ? 2 * element.properties.size() : element.leastBytes();
            if (least == 0) continue;
            if (element.count > left / least) {
                source_.failCutShort("byte " + std::to_string(source_.sizeBytes()),
                                     "the header announces " + std::to_string(element.count) +
                                         " of " + inQuotes(element.name) + ", the file holds " +
                                         std::to_string(left / least) + " at most");
            }
            left -= element.count * least;
        }
    }

    [[noreturn]] void fail(std::string what, std::string remedy = {}) const {
        source_.failAtLine(line_, std::move(what), std::move(remedy));
    }

    const SourceFile& source_;
    std::vector<std::byte> bytes_;
    size_t at_ = 0;
    uint64_t line_ = 0;
    bool endsInCr_ = false;
    PlyHeader header_;
};

}  // namespace

bool PlyElement::hasLists() const {
    return std::ranges::any_of(properties, [](const PlyProperty& p) { return p.isList(); });
}

uint64_t PlyElement::leastBytes() const {
    uint64_t sum = 0;
    for (const PlyProperty& property : properties) sum += property.leastBytes();
    return sum;
}

std::optional<size_t> PlyElement::find(std::initializer_list<std::string_view> names,
                                       bool isList) const {
    for (size_t k = 0; k < properties.size(); ++k) {
        if (properties[k].isList() != isList) continue;
        if (std::ranges::find(names, properties[k].name) != names.end()) return k;
    }
    return std::nullopt;
}

std::optional<size_t> PlyHeader::findElement(std::string_view name) const {
    for (size_t k = 0; k < elements.size(); ++k) {
        if (elements[k].name == name) return k;
    }
    return std::nullopt;
}

PlyHeader readPlyHeader(const SourceFile& source) {
    return HeaderParser(source).parse();
}

}  // namespace pagoda::ooc
