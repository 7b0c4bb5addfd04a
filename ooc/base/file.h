// file.h: files by RAII. Every failure throws pagoda::Error with path, byte and remedy.
// All offsets and sizes are bytes, 64-bit. A File may be used from several threads with the
// positional calls (readAt, writeAt); append() is for one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace pagoda {

class File {
public:
    File() = default;
    ~File();
    File(File&& other) noexcept;
    File& operator=(File&& other) noexcept;
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    [[nodiscard]] static File openForReading(const std::filesystem::path& path);
    // Makes a new file, which must not exist.
    [[nodiscard]] static File create(const std::filesystem::path& path);
    // A scratch file in `folder`, already unlinked: the kernel frees it however we end.
    [[nodiscard]] static File createScratch(const std::filesystem::path& folder);

    [[nodiscard]] bool isOpen() const noexcept { return descriptor_ >= 0; }
    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    [[nodiscard]] uint64_t sizeBytes() const;
    // Changes whenever the file is written: size, modification time and inode in one number.
    [[nodiscard]] uint64_t changeStamp() const;

    // Reads exactly `out.size()` bytes, or throws ("file cut short").
    void readAt(uint64_t offset, std::span<std::byte> out) const;
    // Reads up to `out.size()` bytes; returns how many (0 at the end).
    [[nodiscard]] size_t readSomeAt(uint64_t offset, std::span<std::byte> out) const;
    void writeAt(uint64_t offset, std::span<const std::byte> bytes);
    // Writes behind what was appended before; returns the offset where it began.
    uint64_t append(std::span<const std::byte> bytes);
    // Reserves disk for the range, so that a full disk is said now and not in mid-write.
    void reserve(uint64_t sizeBytes);
    void truncate(uint64_t sizeBytes);
    // Gives the range's disk space back; it reads as zeros then. Without effect where the file
    // system cannot.
    void discard(uint64_t offset, uint64_t sizeBytes) const noexcept;
    void sync();
    void close();
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

private:
    File(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}

    int descriptor_ = -1;
    uint64_t appendedBytes_ = 0;
    std::string path_;
};

// A file's bytes, whole. For small files only: throws when it is larger than `maxBytes`.
[[nodiscard]] std::vector<std::byte> readWholeFile(const std::filesystem::path& path,
                                                   uint64_t maxBytes);

// A growing array of fixed-size records in an unlinked scratch file, mapped for random reading:
// vertices that faces name in any order live here, so memory does not grow with the model.
// append() from one thread; bytes() after seal().
class ScratchArray {
public:
    explicit ScratchArray(const std::filesystem::path& folder);
    ~ScratchArray();
    ScratchArray(const ScratchArray&) = delete;
    ScratchArray& operator=(const ScratchArray&) = delete;

    void append(std::span<const std::byte> bytes);
    // Writes what is buffered and maps all of it. May be called again after more append()s.
    void seal();
    // Valid until the next append() or seal().
    [[nodiscard]] std::span<const std::byte> bytes() const noexcept { return mapped_; }
    [[nodiscard]] uint64_t sizeBytes() const noexcept { return written_ + buffer_.size(); }

private:
    void flush();
    void unmap() noexcept;

    File file_;
    std::vector<std::byte> buffer_;
    uint64_t written_ = 0;
    std::span<const std::byte> mapped_;
};

}  // namespace pagoda
