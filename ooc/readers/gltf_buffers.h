// gltf_buffers.h: the bytes behind a glTF document's buffer views, loaded when first asked for.
// Buffers come from the GLB's binary chunk, data URIs or files beside the model; views compressed
// by meshopt are decoded once. Everything counts against one memory budget.
#pragma once

#include "ooc/readers/gltf_document.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace pagoda::ooc::gltf {

// Bytes in use, refused beyond a limit: file contents are counted before they are allocated.
class MemoryBudget {
public:
    MemoryBudget(const SourceFile& source, uint64_t limitBytes)
        : source_(source), limitBytes_(limitBytes) {}
    // Throws Error naming `where` if `bytes` more do not fit.
    void take(uint64_t bytes, const std::string& where);
    void give(uint64_t bytes) noexcept { usedBytes_ -= bytes; }
    [[nodiscard]] uint64_t freeBytes() const noexcept { return limitBytes_ - usedBytes_; }

private:
    const SourceFile& source_;
    uint64_t limitBytes_, usedBytes_ = 0;
};

// A part of the budget that is given back at the end of a scope.
class MemoryLease {
public:
    explicit MemoryLease(MemoryBudget& budget) : budget_(budget) {}
    ~MemoryLease() { budget_.give(bytes_); }
    MemoryLease(const MemoryLease&) = delete;
    MemoryLease& operator=(const MemoryLease&) = delete;
    void take(uint64_t bytes, const std::string& where) {
        budget_.take(bytes, where);
        bytes_ += bytes;
    }

private:
    MemoryBudget& budget_;
    uint64_t bytes_ = 0;
};

// Change stamps of the files beside the model, by path: a second read must find the same.
using FileStamps = std::map<std::filesystem::path, uint64_t>;

class Buffers {
public:
    Buffers(const SourceFile& source, const Document& document, MemoryBudget& budget,
            FileStamps& stamps);

    // A buffer view's bytes, decoded. Valid as long as this lives. Throws Error.
    [[nodiscard]] std::span<const std::byte> view(int bufferView);
    // What an image's URI names. Throws Error where it cannot be had; nothing is kept.
    [[nodiscard]] std::vector<std::byte> imageFile(const std::string& uri,
                                                   const std::string& where);
    // True the first time it is asked for an accessor: its sparse indices are to be checked once,
    // however many primitives share it.
    [[nodiscard]] bool isNewSparse(int accessor) { return checkedSparse_.insert(accessor).second; }

private:
    [[nodiscard]] std::span<const std::byte> buffer(int index);
    [[nodiscard]] std::span<const std::byte> decoded(int bufferView);
    [[nodiscard]] std::vector<std::byte> loadUri(const std::string& uri, uint64_t expectedBytes,
                                                 const std::string& where);
    [[nodiscard]] std::vector<std::byte> loadFile(const std::string& uri, uint64_t expectedBytes,
                                                  const std::string& where);

    const SourceFile& source_;
    const Document& document_;
    MemoryBudget& budget_;
    FileStamps& stamps_;
    std::map<int, std::vector<std::byte>> buffers_;
    std::map<int, std::vector<std::byte>> decodedViews_;
    std::set<int> checkedSparse_;
};

}  // namespace pagoda::ooc::gltf
