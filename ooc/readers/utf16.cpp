#include "ooc/readers/utf16.h"

#include "ooc/readers/source_file.h"

#include <vector>

namespace pagoda::ooc {
namespace {

constexpr uint32_t kReplacement = 0xFFFD;

void appendUtf8(std::vector<std::byte>& out, uint32_t code) {
    const auto put = [&](uint32_t byte) { out.push_back(static_cast<std::byte>(byte)); };
    if (code < 0x80) return put(code);
    if (code < 0x800) {
        put(0xC0u | code >> 6);
    } else if (code < 0x10000) {
        put(0xE0u | code >> 12);
        put(0x80u | (code >> 6 & 0x3Fu));
    } else {
        put(0xF0u | code >> 18);
        put(0x80u | (code >> 12 & 0x3Fu));
        put(0x80u | (code >> 6 & 0x3Fu));
    }
    put(0x80u | (code & 0x3Fu));
}

}  // namespace

uint64_t copyUtf16AsUtf8(const SourceFile& source, bool isBigEndian, File& copy) {
    InputStream stream(source, nullptr);
    stream.seek(2);
    std::vector<std::byte> out;
    uint64_t written = 0;
    uint32_t high = 0;  // first half of a pair that waits for its second
    for (;;) {
        const std::span<const std::byte> block = stream.ahead(2);
        if (block.size() < 2) break;
        out.clear();
        for (size_t k = 0; k + 1 < block.size(); k += 2) {
            const auto first = std::to_integer<uint32_t>(block[k + (isBigEndian ? 0 : 1)]);
            const auto second = std::to_integer<uint32_t>(block[k + (isBigEndian ? 1 : 0)]);
            const uint32_t unit = first << 8 | second;
            const bool isHigh = unit >= 0xD800 && unit < 0xDC00;
            const bool isLow = unit >= 0xDC00 && unit < 0xE000;
            if (high != 0 && !isLow) appendUtf8(out, kReplacement);
            if (isLow) {
                const uint32_t pair = 0x10000 + ((high - 0xD800) << 10) + (unit - 0xDC00);
                appendUtf8(out, high != 0 ? pair : kReplacement);
            } else if (!isHigh) {
                appendUtf8(out, unit);
            }
            high = isHigh ? unit : 0;
        }
        stream.take(block.size() / 2 * 2);
        copy.append(out);
        written += out.size();
    }
    return written;
}

}  // namespace pagoda::ooc
