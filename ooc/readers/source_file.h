// source_file.h: the input file of a reader, and a forward stream of its bytes.
#pragma once

#include "ooc/base/file.h"
#include "ooc/readers/reader.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace pagoda::ooc {

// An open input that must not change while it is read: its stamp is taken when it is opened.
class SourceFile {
public:
    explicit SourceFile(const std::filesystem::path& path);
    // Text that begins with a byte order mark of UTF-16 is copied to scratch as UTF-8 and read from
    // there; errors still name `path`, and lines keep their numbers. Other files as they are.
    [[nodiscard]] static SourceFile openText(const std::filesystem::path& path,
                                             const std::filesystem::path& scratchFolder);

    [[nodiscard]] const File& file() const noexcept { return copy_.isOpen() ? copy_ : original_; }
    [[nodiscard]] const std::string& path() const noexcept { return original_.path(); }
    [[nodiscard]] uint64_t sizeBytes() const noexcept { return sizeBytes_; }

    // Throws Error if the file was written since it was opened. One fstat.
    void checkUnchanged() const;
    [[noreturn]] void fail(std::string place, std::string what, std::string remedy) const;
    [[noreturn]] void failAtByte(uint64_t offset, std::string what, std::string remedy = {}) const;
    [[noreturn]] void failAtLine(uint64_t line, std::string what, std::string remedy = {}) const;
    // The same for data that ends too early.
    [[noreturn]] void failCutShort(std::string place, std::string what) const;

private:
    File original_;
    File copy_;  // open: what is read in its place
    uint64_t sizeBytes_ = 0;
    uint64_t changeStamp_ = 0;
};

// Tells a sink how far the reading is: of the `passes` sweeps over a file each counts its part, so
// that one read() advances by the file's size at most (what the last block held is left out).
class ProgressMeter {
public:
    ProgressMeter(TriangleSink& sink, uint64_t passes) : sink_(sink), passes_(passes) {}
    void moved(uint64_t bytes);

private:
    TriangleSink& sink_;
    uint64_t passes_;
    uint64_t remainder_ = 0;
};

// Bytes of a file in order, through one buffer. Every refill checks that the file is unchanged and
// moves the meter (which is where Ctrl-C ends the reading).
class InputStream {
public:
    static constexpr size_t kBlockBytes = size_t{1} << 20;  // hides the call, stays in the cache

    InputStream(const SourceFile& source, ProgressMeter* meter, size_t blockBytes = kBlockBytes);

    // What lies ahead in the buffer, refilled until there are at least `wantedBytes` or the file
    // ends. Valid until the next call. Grows the buffer where a block is too small: callers bound
    // `wantedBytes`.
    [[nodiscard]] std::span<const std::byte> ahead(size_t wantedBytes) {
        if (end_ - begin_ < wantedBytes) refill(wantedBytes);
        return {buffer_.data() + begin_, end_ - begin_};
    }
    // Moves over bytes that ahead() showed.
    void take(size_t bytes) noexcept { begin_ += bytes; }
    // Moves on by any distance, also beyond what is in the buffer.
    void skip(uint64_t bytes);
    void seek(uint64_t offset);

    [[nodiscard]] uint64_t offset() const noexcept { return bufferOffset_ + begin_; }
    [[nodiscard]] uint64_t remainingBytes() const noexcept {
        return offset() < source_.sizeBytes() ? source_.sizeBytes() - offset() : 0;
    }
    [[nodiscard]] const SourceFile& source() const noexcept { return source_; }

private:
    void refill(size_t wantedBytes);

    const SourceFile& source_;
    ProgressMeter* meter_;  // none: says nothing
    std::vector<std::byte> buffer_;
    size_t begin_ = 0, end_ = 0;  // what of the buffer lies ahead
    uint64_t bufferOffset_ = 0;   // place in the file of the buffer's first byte
};

}  // namespace pagoda::ooc
