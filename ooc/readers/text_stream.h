// text_stream.h: a text file line by line, each counted.
#pragma once

#include "ooc/readers/source_file.h"

#include <cstdint>
#include <string_view>

namespace pagoda::ooc {

// Lines end in LF or CR LF (the CR counts as a blank), or in CR alone where the start of the file
// holds no LF at all. A last line without an end is a line.
class TextStream {
public:
    // A longer line is refused: no sane file has one, and a line is held whole.
    static constexpr size_t kMaxLineBytes = size_t{64} << 20;

    explicit TextStream(const SourceFile& source, ProgressMeter* meter, uint64_t offset = 0,
                        uint64_t firstLine = 1);

    // False at the end of the file. The line is valid until the next call.
    [[nodiscard]] bool next(std::string_view& line);
    // Number of the line that next() gave last, counted from 1.
    [[nodiscard]] uint64_t lineNumber() const noexcept { return line_ - 1; }
    // Bytes behind that line.
    [[nodiscard]] uint64_t remainingBytes() const noexcept { return stream_.remainingBytes(); }
    // Where the next line begins, and its number, so that another stream can go on there.
    [[nodiscard]] uint64_t offset() const noexcept { return stream_.offset(); }
    [[nodiscard]] uint64_t nextLineNumber() const noexcept { return line_; }
    [[nodiscard]] const SourceFile& source() const noexcept { return stream_.source(); }

private:
    InputStream stream_;
    char lineEnd_ = '\n';
    uint64_t line_;  // number of the next line
};

}  // namespace pagoda::ooc
