#include "ooc/base/file.h"

#include "ooc/base/error.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace pagoda {
namespace {

constexpr size_t kScratchBufferBytes = size_t{1} << 20;  // one write call a MiB
constexpr size_t kMaxIoBytes = size_t{1} << 30;          // Linux moves at most 2 GiB a call

[[noreturn]] void fail(const std::string& path, const std::string& place, const char* action) {
    const int code = errno;
    std::string remedy;
    if (code == ENOSPC || code == EDQUOT) {
        remedy = "free disk space, or name a folder on another disk (for scratch: --scratch)";
    } else if (code == EFBIG) {
        remedy = "the limit is the file system's, or set with ulimit -f";
    } else if (code == EACCES || code == EPERM || code == EROFS) {
        remedy = "check the permissions";
    } else if (code == ENOENT || code == ENOTDIR) {
        remedy = "check the path";
    }
    throw Error(path, place, std::string(action) + ": " + std::generic_category().message(code),
                remedy);
}

std::string at(uint64_t offset) {
    return "byte " + std::to_string(offset);
}

}  // namespace

File::~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      appendedBytes_(std::exchange(other.appendedBytes_, 0)),
      path_(std::move(other.path_)) {
}

File& File::operator=(File&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(appendedBytes_, other.appendedBytes_);
    std::swap(path_, other.path_);
    return *this;
}

File File::openForReading(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) fail(path.string(), "", "cannot open");
    File file(descriptor, path.string());
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) fail(file.path_, "", "cannot look at");
    if (!S_ISREG(status.st_mode)) {
        throw Error(file.path_, "", "not a regular file", "name a file");
    }
    return file;
}

File File::create(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor < 0) fail(path.string(), "", "cannot create");
    return File(descriptor, path.string());
}

File File::createScratch(const std::filesystem::path& folder) {
    // Without a name from the start, where the file system can: nothing to find after kill -9.
    const int nameless = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (nameless >= 0) return File(nameless, folder.string() + " (scratch)");
    std::string name = (folder / ".pagoda-scratch-XXXXXX").string();
    const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor < 0) fail(folder.string(), "", "cannot create a scratch file");
    ::unlink(name.c_str());
    return File(descriptor, folder.string() + " (scratch)");
}

uint64_t File::sizeBytes() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) fail(path_, "", "cannot look at");
    return static_cast<uint64_t>(status.st_size);
}

uint64_t File::changeStamp() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) fail(path_, "", "cannot look at");
    uint64_t stamp = 0;
    for (const uint64_t part :
         {static_cast<uint64_t>(status.st_size), static_cast<uint64_t>(status.st_mtim.tv_sec),
          static_cast<uint64_t>(status.st_mtim.tv_nsec), static_cast<uint64_t>(status.st_ino)}) {
        stamp = stamp * 0x9E3779B97F4A7C15ull + part;
    }
    return stamp;
}

size_t File::readSomeAt(uint64_t offset, std::span<std::byte> out) const {
    size_t done = 0;
    while (done < out.size()) {
        const size_t wanted = std::min(out.size() - done, kMaxIoBytes);
        const ssize_t got =
            ::pread(descriptor_, out.data() + done, wanted, static_cast<off_t>(offset + done));
        if (got < 0) {
            if (errno == EINTR) continue;
            fail(path_, at(offset + done), "cannot read");
        }
        if (got == 0) break;
        done += static_cast<size_t>(got);
    }
    return done;
}

void File::readAt(uint64_t offset, std::span<std::byte> out) const {
    const size_t got = readSomeAt(offset, out);
    if (got != out.size()) {
        throw Error(path_, at(offset + got), "file cut short", "check that it was copied whole");
    }
}

void File::writeAt(uint64_t offset, std::span<const std::byte> bytes) {
    size_t done = 0;
    while (done < bytes.size()) {
        const size_t wanted = std::min(bytes.size() - done, kMaxIoBytes);
        const ssize_t put =
            ::pwrite(descriptor_, bytes.data() + done, wanted, static_cast<off_t>(offset + done));
        if (put < 0) {
            if (errno == EINTR) continue;
            fail(path_, at(offset + done), "cannot write");
        }
        done += static_cast<size_t>(put);
    }
}

uint64_t File::append(std::span<const std::byte> bytes) {
    const uint64_t offset = appendedBytes_;
    writeAt(offset, bytes);
    appendedBytes_ += bytes.size();
    return offset;
}

void File::reserve(uint64_t sizeBytes) {
    if (sizeBytes == 0) return;
    const int code = ::posix_fallocate(descriptor_, 0, static_cast<off_t>(sizeBytes));
    if (code == EOPNOTSUPP || code == EINVAL) return;  // a file system without it
    if (code != 0) {
        errno = code;
        fail(path_, "", "cannot reserve space");
    }
}

void File::truncate(uint64_t sizeBytes) {
    if (::ftruncate(descriptor_, static_cast<off_t>(sizeBytes)) != 0) {
        fail(path_, at(sizeBytes), "cannot set the size");
    }
}

void File::discard(uint64_t offset, uint64_t sizeBytes) const noexcept {
    if (sizeBytes == 0) return;
    (void)::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                      static_cast<off_t>(offset), static_cast<off_t>(sizeBytes));
}

void File::sync() {
    if (::fsync(descriptor_) != 0) fail(path_, "", "cannot sync");
}

void File::close() {
    if (descriptor_ < 0) return;
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0) fail(path_, "", "cannot close");
}

std::vector<std::byte> readWholeFile(const std::filesystem::path& path, uint64_t maxBytes) {
    const File file = File::openForReading(path);
    const uint64_t size = file.sizeBytes();
    if (size > maxBytes) {
        throw Error(path.string(), "",
                    "file of " + std::to_string(size) + " bytes where at most " +
                        std::to_string(maxBytes) + " are taken into memory",
                    "raise --memory");
    }
    std::vector<std::byte> bytes(size);
    file.readAt(0, bytes);
    return bytes;
}

ScratchArray::ScratchArray(const std::filesystem::path& folder)
    : file_(File::createScratch(folder)) {
}

ScratchArray::~ScratchArray() {
    unmap();
}

void ScratchArray::append(std::span<const std::byte> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    if (buffer_.size() >= kScratchBufferBytes) flush();
}

void ScratchArray::flush() {
    file_.writeAt(written_, buffer_);
    written_ += buffer_.size();
    buffer_.clear();
}

void ScratchArray::seal() {
    flush();
    unmap();
    if (written_ == 0) return;
    void* memory = ::mmap(nullptr, written_, PROT_READ, MAP_SHARED, file_.descriptor(), 0);
    if (memory == MAP_FAILED) fail(file_.path(), "", "cannot map");
    mapped_ = {static_cast<const std::byte*>(memory), written_};
}

void ScratchArray::unmap() noexcept {
    if (mapped_.empty()) return;
    ::munmap(const_cast<std::byte*>(mapped_.data()), mapped_.size());
    mapped_ = {};
}

}  // namespace pagoda
