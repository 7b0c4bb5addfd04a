#include "ooc/readers/text_stream.h"

#include <cstring>

namespace pagoda::ooc {

TextStream::TextStream(const SourceFile& source, ProgressMeter* meter, uint64_t offset,
                       uint64_t firstLine)
    : stream_(source, meter), line_(firstLine) {
    stream_.seek(offset);
    const std::span<const std::byte> start = stream_.ahead(1);
    if (start.empty()) return;
    constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";
    if (offset == 0 && start.size() >= kUtf8Mark.size() &&
        std::memcmp(start.data(), kUtf8Mark.data(), kUtf8Mark.size()) == 0) {
        stream_.take(kUtf8Mark.size());
    }
    if (std::memchr(start.data(), '\n', start.size()) == nullptr &&
        std::memchr(start.data(), '\r', start.size()) != nullptr) {
        lineEnd_ = '\r';
    }
}

bool TextStream::next(std::string_view& line) {
    size_t searched = 0;
    for (;;) {
        const std::span<const std::byte> bytes = stream_.ahead(searched + 1);
        const auto* text = reinterpret_cast<const char*>(bytes.data());
        if (bytes.empty()) return false;
        const void* found = bytes.size() == searched
                                ? nullptr
                                : std::memchr(text + searched, lineEnd_, bytes.size() - searched);
        if (found != nullptr) {
            const auto size = static_cast<size_t>(static_cast<const char*>(found) - text);
            line = {text, size};
            stream_.take(size + 1);
            ++line_;
            return true;
        }
        if (bytes.size() == searched) {  // the file ends here
            line = {text, bytes.size()};
            stream_.take(bytes.size());
            ++line_;
            return true;
        }
        searched = bytes.size();
        if (searched > kMaxLineBytes) {
            source().failAtLine(line_, "the line is longer than 64 MiB",
                                "check that it is text, or write it with line ends");
        }
    }
}

}  // namespace pagoda::ooc
