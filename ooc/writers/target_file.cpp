#include "ooc/writers/target_file.h"

#include "ooc/base/error.h"

#include <unistd.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace pagoda::ooc {
namespace {

constexpr size_t kBufferBytes = size_t{1} << 20;  // one write call a MiB

void refuseExisting(const std::filesystem::path& target) {
    std::error_code ignored;
    if (std::filesystem::exists(target, ignored)) {
        throw Error(target.string(), "", "exists already", "name another file or give --force");
    }
}

std::filesystem::path temporaryBeside(const std::filesystem::path& target) {
    std::filesystem::path path = target;
    path += ".partial-" + std::to_string(::getpid());
    return path;
}

}  // namespace

TargetFile::TargetFile(std::filesystem::path target, bool force)
    : target_(std::move(target)), temporary_(temporaryBeside(target_)), force_(force) {
    if (!force_) refuseExisting(target_);
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);  // of a dead process that had our number
    file_ = File::create(temporary_);
}

TargetFile::~TargetFile() {
    std::error_code ignored;
    if (!isPublished_ && file_.isOpen()) std::filesystem::remove(temporary_, ignored);
}

void TargetFile::append(std::span<const std::byte> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    if (buffer_.size() >= kBufferBytes) flush();
}

void TargetFile::append(std::string_view text) {
    append(std::as_bytes(std::span(text)));
}

void TargetFile::append(const File& source) {
    const uint64_t size = source.sizeBytes();
    std::vector<std::byte> block(kBufferBytes);
    for (uint64_t at = 0; at < size; at += block.size()) {
        block.resize(static_cast<size_t>(std::min<uint64_t>(size - at, kBufferBytes)));
        source.readAt(at, block);
        append(block);
    }
}

void TargetFile::patch(uint64_t offset, std::span<const std::byte> bytes) {
    flush();
    file_.writeAt(offset, bytes);
}

File& TargetFile::flushed() {
    flush();
    return file_;
}

void TargetFile::continueAt(uint64_t sizeBytes) {
    flush();
    written_ = sizeBytes;
}

uint64_t TargetFile::publish() {
    flush();
    file_.sync();
    if (!force_) refuseExisting(target_);
    std::error_code failure;
    std::filesystem::rename(temporary_, target_, failure);
    if (failure) {
        throw Error(target_.string(), "", "cannot rename the finished file: " + failure.message(),
                    "check the permissions of its folder");
    }
    isPublished_ = true;
    return written_;
}

void TargetFile::flush() {
    if (buffer_.empty()) return;
    file_.writeAt(written_, buffer_);
    written_ += buffer_.size();
    buffer_.clear();
}

ScratchStream::ScratchStream(const std::filesystem::path& folder)
    : file_(File::createScratch(folder)) {
}

void ScratchStream::append(std::span<const std::byte> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    if (buffer_.size() >= kBufferBytes) flush();
}

const File& ScratchStream::flushed() {
    flush();
    return file_;
}

void ScratchStream::flush() {
    if (buffer_.empty()) return;
    file_.writeAt(written_, buffer_);
    written_ += buffer_.size();
    buffer_.clear();
}

}  // namespace pagoda::ooc
