// target_file.h: a file that appears under its name only when it is complete.
// Bytes go to a temporary file beside the target; publish() renames it. Destroyed before that, it
// leaves nothing. One thread. Failures throw pagoda::Error.
#pragma once

#include "ooc/base/file.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace pagoda::ooc {

class TargetFile {
public:
    // Throws when `target` exists and not `force`.
    TargetFile(std::filesystem::path target, bool force);
    ~TargetFile();
    TargetFile(const TargetFile&) = delete;
    TargetFile& operator=(const TargetFile&) = delete;

    void append(std::span<const std::byte> bytes);  // buffered
    void append(std::string_view text);
    void append(const File& source);  // all of it, in blocks
    // Overwrites what was appended before.
    void patch(uint64_t offset, std::span<const std::byte> bytes);
    [[nodiscard]] uint64_t sizeBytes() const noexcept { return written_ + buffer_.size(); }
    // With nothing left in the buffer; for reading back and for moving what is there.
    [[nodiscard]] File& flushed();
    // The file now ends at `sizeBytes`, where appending goes on (after work on flushed()).
    void continueAt(uint64_t sizeBytes);

    // Syncs and renames. Returns the size.
    uint64_t publish();
    [[nodiscard]] const std::filesystem::path& target() const noexcept { return target_; }

private:
    void flush();

    std::filesystem::path target_, temporary_;
    bool force_ = false;
    bool isPublished_ = false;
    File file_;
    std::vector<std::byte> buffer_;
    uint64_t written_ = 0;
};

// Appends to an unlinked scratch file through a buffer.
class ScratchStream {
public:
    explicit ScratchStream(const std::filesystem::path& folder);
    void append(std::span<const std::byte> bytes);
    [[nodiscard]] uint64_t sizeBytes() const noexcept { return written_ + buffer_.size(); }
    [[nodiscard]] const File& flushed();

private:
    void flush();

    File file_;
    std::vector<std::byte> buffer_;
    uint64_t written_ = 0;
};

}  // namespace pagoda::ooc
