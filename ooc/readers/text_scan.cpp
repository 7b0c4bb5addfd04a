#include "ooc/readers/text_scan.h"

#include <fast_float/fast_float.h>

#include <charconv>
#include <limits>

namespace pagoda::ooc {
namespace {

constexpr int kExactDigits = 15;  // what a double holds of any decimal mantissa
constexpr double kPowersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

// The plain numbers that files are full of: at most 15 digits, a point, no exponent. Mantissa and
// power of ten are exact doubles, so one division rounds right (Clinger). Null: something else.
const char* plainNumber(const char* at, const char* end, double& value) {
    const char* p = at;
    const bool isNegative = p != end && *p == '-';
    if (p != end && (*p == '-' || *p == '+')) ++p;
    const char* first = p;
    uint64_t mantissa = 0;
    while (p != end && isDigit(*p)) mantissa = mantissa * 10 + static_cast<uint64_t>(*p++ - '0');
    int digits = static_cast<int>(p - first);
    int decimals = 0;
    if (p != end && *p == '.') {
        const char* point = ++p;
        while (p != end && isDigit(*p)) {
            mantissa = mantissa * 10 + static_cast<uint64_t>(*p++ - '0');
        }
        decimals = static_cast<int>(p - point);
        digits += decimals;
    }
    if (digits == 0 || digits > kExactDigits || (p != end && !isBlank(*p))) return nullptr;
    const double magnitude = static_cast<double>(mantissa) / kPowersOfTen[decimals];
    value = isNegative ? -magnitude : magnitude;
    return p;
}

// "-1.#IND", "1.#QNAN", "1.#INF": how old C libraries of Windows print what is not finite.
bool isMicrosoftNan(const char* at, const char* end) {
    if (at != end && (*at == '-' || *at == '+')) ++at;
    return end - at > 3 && std::string_view(at, 3) == "1.#";
}

}  // namespace

std::string_view TextCursor::word() {
    skipBlanks();
    const char* first = at;
    while (at != end && !isBlank(*at)) ++at;
    return {first, static_cast<size_t>(at - first)};
}

std::string_view TextCursor::rest() {
    skipBlanks();
    const char* last = end;
    while (last != at && isBlank(last[-1])) --last;
    const std::string_view text(at, static_cast<size_t>(last - at));
    at = end;
    return text;
}

bool TextCursor::number(double& value) {
    skipBlanks();
    if (const char* after = plainNumber(at, end, value)) {
        at = after;
        return true;
    }
    if (isMicrosoftNan(at, end)) {
        (void)word();
        value = std::numeric_limits<double>::quiet_NaN();
        return true;
    }
    const char* first = at != end && *at == '+' ? at + 1 : at;
    const auto [after, code] = fast_float::from_chars(first, end, value);
    if (code != std::errc() || (after != end && !isBlank(*after)) || after == first) return false;
    if (first != at && (*first == '-' || *first == '+')) return false;
    at = after;
    return true;
}

bool TextCursor::integer(int64_t& value) {
    skipBlanks();
    const char* first = at != end && *at == '+' ? at + 1 : at;
    const auto [after, code] = std::from_chars(first, end, value);
    if (code != std::errc() || (after != end && !isBlank(*after))) return false;
    if (first != at && *first == '-') return false;
    at = after;
    return true;
}

bool parseCount(std::string_view word, uint64_t& value) {
    const char* end = word.data() + word.size();
    const auto [after, code] = std::from_chars(word.data(), end, value);
    return code == std::errc() && after == end && !word.empty();
}

bool equalsIgnoringCase(std::string_view a, std::string_view lowerCase) {
    if (a.size() != lowerCase.size()) return false;
    for (size_t k = 0; k < a.size(); ++k) {
        const char c = a[k] >= 'A' && a[k] <= 'Z' ? static_cast<char>(a[k] - 'A' + 'a') : a[k];
        if (c != lowerCase[k]) return false;
    }
    return true;
}

std::string printable(std::string_view text) {
    constexpr size_t kMaxQuoted = 40;
    std::string out;
    for (const char c : text.substr(0, kMaxQuoted)) out += c >= ' ' && c <= '~' ? c : '?';
    return text.size() > kMaxQuoted ? out + "..." : out;
}

namespace {

// Bytes of the well-formed UTF-8 sequence that begins `text`; 0: none does.
size_t utf8SequenceBytes(std::string_view text) {
    const auto byte = [&](size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned lead = byte(0);
    const size_t size = lead < 0x80   ? 1
                        : lead < 0xC2 ? 0
                        : lead < 0xE0 ? 2
                        : lead < 0xF0 ? 3
                        : lead < 0xF5 ? 4
                                      : 0;
    if (size == 0 || size > text.size()) return 0;
    for (size_t k = 1; k < size; ++k) {
        if ((byte(k) & 0xC0u) != 0x80u) return 0;
    }
    if (lead == 0xE0 && byte(1) < 0xA0) return 0;  // overlong
    if (lead == 0xED && byte(1) > 0x9F) return 0;  // a surrogate
    if (lead == 0xF0 && byte(1) < 0x90) return 0;  // overlong
    if (lead == 0xF4 && byte(1) > 0x8F) return 0;  // beyond U+10FFFF
    return size;
}

}  // namespace

std::string toUtf8(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        size_t size = utf8SequenceBytes(text);
        if (size > 0) {
            out.append(text.substr(0, size));
        } else {
            const auto byte = static_cast<unsigned char>(text[0]);
            out += static_cast<char>(0xC0u | (byte >> 6));
            out += static_cast<char>(0x80u | (byte & 0x3Fu));
            size = 1;
        }
        text.remove_prefix(size);
    }
    return out;
}

}  // namespace pagoda::ooc
