// text_scan.h: numbers and words in text, for the readers of text formats. No locale.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pagoda::ooc {

[[nodiscard]] constexpr bool isBlank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || c == '\0';
}

// A line (or part of one) and the place in it. Words are separated by blanks.
struct TextCursor {
    const char* at = nullptr;
    const char* end = nullptr;

    TextCursor() = default;
    explicit TextCursor(std::string_view text) : at(text.data()), end(text.data() + text.size()) {}

    void skipBlanks() {
        while (at != end && isBlank(*at)) ++at;
    }
    [[nodiscard]] bool atEnd() {
        skipBlanks();
        return at == end;
    }
    // The next word, empty at the end.
    [[nodiscard]] std::string_view word();
    // All that is left, without blanks at either side: names hold spaces.
    [[nodiscard]] std::string_view rest();

    // The next word as a number: decimal with or without exponent, a leading '+', nan, inf (as
    // C libraries print them). False
    // (and the cursor stays at the word) if it is something else.
    [[nodiscard]] bool number(double& value);
    // The next word as a whole number; false if it is something else or beyond 64 bits.
    [[nodiscard]] bool integer(int64_t& value);
};

// The whole of `word` as a count: digits only. False beyond 64 bits.
[[nodiscard]] bool parseCount(std::string_view word, uint64_t& value);
// ASCII letters only.
[[nodiscard]] bool equalsIgnoringCase(std::string_view a, std::string_view lowerCase);
// The start of `text` with anything unprintable as '?': errors quote what they found.
[[nodiscard]] std::string printable(std::string_view text);
// UTF-8 as it is, where it is valid; other bytes are taken for Latin-1.
[[nodiscard]] std::string toUtf8(std::string_view text);

}  // namespace pagoda::ooc
