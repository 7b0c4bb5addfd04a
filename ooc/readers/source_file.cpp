#include "ooc/readers/source_file.h"

#include "ooc/base/error.h"
#include "ooc/readers/utf16.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace pagoda::ooc {

SourceFile::SourceFile(const std::filesystem::path& path)
    : original_(File::openForReading(path)),
      sizeBytes_(original_.sizeBytes()),
      changeStamp_(original_.changeStamp()) {
}

SourceFile SourceFile::openText(const std::filesystem::path& path,
                                const std::filesystem::path& scratchFolder) {
    SourceFile source(path);
    std::byte mark[2] = {};
    if (source.original_.readSomeAt(0, mark) < 2) return source;
    const bool isLittle = mark[0] == std::byte{0xFF} && mark[1] == std::byte{0xFE};
    const bool isBig = mark[0] == std::byte{0xFE} && mark[1] == std::byte{0xFF};
    if (!isLittle && !isBig) return source;
    File copy = File::createScratch(scratchFolder);
    source.sizeBytes_ = copyUtf16AsUtf8(source, isBig, copy);
    source.copy_ = std::move(copy);
    return source;
}

void SourceFile::checkUnchanged() const {
    if (original_.changeStamp() != changeStamp_) {
        fail("", "the file was written while it was read", "start again when it is complete");
    }
}

void SourceFile::fail(std::string place, std::string what, std::string remedy) const {
    throw Error(path(), std::move(place), std::move(what), std::move(remedy));
}

void SourceFile::failAtByte(uint64_t offset, std::string what, std::string remedy) const {
    fail("byte " + std::to_string(offset), std::move(what), std::move(remedy));
}

void SourceFile::failAtLine(uint64_t line, std::string what, std::string remedy) const {
    fail("line " + std::to_string(line), std::move(what), std::move(remedy));
}

void SourceFile::failCutShort(std::string place, std::string what) const {
    fail(std::move(place), std::move(what), "file cut short? copy or download it again");
}

void ProgressMeter::moved(uint64_t bytes) {
    remainder_ += bytes;
    sink_.advance(remainder_ / passes_);
    remainder_ %= passes_;
}

InputStream::InputStream(const SourceFile& source, ProgressMeter* meter, size_t blockBytes)
    : source_(source), meter_(meter), buffer_(blockBytes) {
}

void InputStream::skip(uint64_t bytes) {
    if (bytes <= end_ - begin_) {
        begin_ += static_cast<size_t>(bytes);
    } else {
        seek(offset() + bytes);
    }
}

void InputStream::seek(uint64_t offset) {
    if (meter_ != nullptr) meter_->moved(begin_);
    bufferOffset_ = offset;
    begin_ = end_ = 0;
}

void InputStream::refill(size_t wantedBytes) {
    const size_t kept = end_ - begin_;
    if (meter_ != nullptr) meter_->moved(begin_);  // what was taken since the last time
    std::memmove(buffer_.data(), buffer_.data() + begin_, kept);
    bufferOffset_ += begin_;
    begin_ = 0;
    end_ = kept;
    if (buffer_.size() < wantedBytes) buffer_.resize(std::max(wantedBytes, buffer_.size() * 2));
    source_.checkUnchanged();
    const size_t got = source_.file().readSomeAt(
        bufferOffset_ + kept, std::span(buffer_.data() + kept, buffer_.size() - kept));
    end_ += got;
}

}  // namespace pagoda::ooc
