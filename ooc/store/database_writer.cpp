#include "ooc/store/database_writer.h"

#include "ooc/base/error.h"
#include "ooc/store/index_packing.h"
#include "ooc/store/layout.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace pagoda::ooc {
namespace {

constexpr const char* kExists = "exists already";
constexpr const char* kExistsRemedy = "choose another name or pass --force";

std::filesystem::path folderOf(const std::filesystem::path& target) {
    return target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
}

std::string temporaryPrefix(const std::filesystem::path& target) {
    return std::string(".") + target.filename().string() + ".part-";
}

[[noreturn]] void fail(const std::filesystem::path& target, const char* action, int code) {
    throw Error(target.string(), "",
                std::string(action) + ": " + std::generic_category().message(code),
                "check the folder and its permissions");
}

// Makes a new file beside `target` and locks it: a lock dies with its process, so that what a
// killed build left can be told from what another build is writing.
File createTemporary(const std::filesystem::path& target, std::filesystem::path& temporary) {
    const std::filesystem::path folder = folderOf(target);
    std::error_code code;
    if (!std::filesystem::is_directory(folder, code)) {
        throw Error(target.string(), "", "cannot create: no folder " + folder.string(),
                    "make the folder first");
    }
    const std::string name = temporaryPrefix(target) + std::to_string(::getpid());
    temporary = folder / name;
    for (int i = 2; std::filesystem::exists(std::filesystem::symlink_status(temporary, code));
         ++i) {
        temporary = folder / (name + "-" + std::to_string(i));
    }
    File file = File::create(temporary);
    ::flock(file.descriptor(), LOCK_EX | LOCK_NB);  // a file system without locks: leftovers show
    return file;
}

// The name in the folder survives a power cut only after this. Not every file system can.
void syncFolder(const std::filesystem::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

// Never replaces an existing target.
void renameNew(const std::filesystem::path& from, const std::filesystem::path& to) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return;
    if (errno == EINVAL || errno == ENOSYS) {  // a file system without it: a link does not replace
        if (::link(from.c_str(), to.c_str()) == 0) {
            ::unlink(from.c_str());
            return;
        }
    }
    if (errno == EEXIST) throw Error(to.string(), "", kExists, kExistsRemedy);
    fail(to, "cannot publish", errno);
}

// At most kMaxNameBytes, cut between characters.
void cutName(std::string& name) {
    if (name.size() <= kMaxNameBytes) return;
    size_t end = kMaxNameBytes;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0u) == 0x80u) --end;
    name.resize(end);
}

FileRange append(File& file, std::span<const std::byte> bytes) {
    return {file.append(bytes), bytes.size(), hash64(bytes)};
}

DirectoryEntry appendBlock(File& file, std::span<const std::byte> bytes, size_t count) {
    if (bytes.size() > UINT32_MAX) throw std::logic_error("block beyond 4 GiB");
    const FileRange range = append(file, bytes);
    return {range.offset, range.checksum, static_cast<uint32_t>(bytes.size()),
            static_cast<uint32_t>(count)};
}

FileRange appendIndex(File& file, std::vector<NodeRecord>& nodes) {
    std::vector<DirectoryEntry> directory;
    for (const std::vector<uint32_t>& block : packIndexBlocks(nodes, kMaxNodesPerBlock)) {
        ByteWriter out;
        for (const uint32_t node : block) putNode(nodes[node], out);
        directory.push_back(appendBlock(file, out.bytes(), block.size()));
    }
    return append(file, directoryBytes(directory));
}

FileRange appendObjects(File& file, std::vector<ObjectRecord>& objects) {
    for (ObjectRecord& object : objects) cutName(object.name);
    std::vector<DirectoryEntry> directory;
    for (size_t first = 0; first < objects.size(); first += kObjectsPerBlock) {
        const size_t count = std::min<size_t>(objects.size() - first, kObjectsPerBlock);
        directory.push_back(
            appendBlock(file, objectBlockBytes(std::span(objects).subspan(first, count)), count));
    }
    return append(file, directoryBytes(directory));
}

}  // namespace

DatabaseWriter::DatabaseWriter(std::filesystem::path target, bool force, uint64_t expectedPageBytes)
    : target_(std::move(target)), force_(force) {
    std::error_code code;
    const auto status = std::filesystem::symlink_status(target_, code);
    if (std::filesystem::is_directory(status)) {
        throw Error(target_.string(), "", "is a folder", "choose another name");
    }
    if (!force_ && std::filesystem::exists(status)) {
        throw Error(target_.string(), "", kExists, kExistsRemedy);
    }
    file_ = createTemporary(target_, temporary_);
    try {
        file_.reserve(kHeaderBytes + expectedPageBytes);
        file_.append(std::vector<std::byte>(kHeaderBytes));
    } catch (...) {  // the destructor will not run
        ::unlink(temporary_.c_str());
        throw;
    }
}

DatabaseWriter::~DatabaseWriter() {
    if (!isPublished_) ::unlink(temporary_.c_str());
}

uint64_t DatabaseWriter::addPage(std::span<const std::byte> page) {
    if (page.size() > kMaxPageBytes) {
        throw Error(target_.string(), "", "a page of " + std::to_string(page.size()) + " bytes",
                    "lower --node-triangles");
    }
    return file_.append(page);
}

uint64_t DatabaseWriter::publish(Content content) {
    assert(!isPublished_);
    FileLayout layout;
    layout.header = content.header;
    Header& header = layout.header;
    header.nodeCount = content.nodes.size();
    header.leafCount =
        static_cast<uint64_t>(std::count_if(content.nodes.begin(), content.nodes.end(),
                                            [](const NodeRecord& n) { return n.isLeaf(); }));
    header.objectCount = content.objects.size();
    header.materialCount = content.materials.size();

    layout.pagesEnd = file_.append({});
    layout.indexDirectory = appendIndex(file_, content.nodes);
    layout.objectDirectory = appendObjects(file_, content.objects);
    for (MaterialRecord& material : content.materials) cutName(material.name);
    layout.materials = append(file_, materialBytes(content.materials));
    layout.metadata = append(file_, std::as_bytes(std::span<const char>(content.metadataJson)));
    header.fileBytes = layout.metadata.end() + kHeaderBytes;

    const std::vector<std::byte> head = headerBytes(layout);
    file_.append(head);
    file_.writeAt(0, head);
    FileLayout check;
    if (const std::string fault = parseHeader(head, header.fileBytes, check); !fault.empty()) {
        throw std::logic_error("header: " + fault);
    }
    file_.truncate(header.fileBytes);
    file_.sync();
    if (!force_) {
        renameNew(temporary_, target_);
    } else if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
        fail(target_, "cannot publish", errno);
    }
    isPublished_ = true;
    syncFolder(folderOf(target_));
    file_.close();
    return header.fileBytes;
}

std::vector<std::filesystem::path> findLeftovers(const std::filesystem::path& target) {
    std::vector<std::filesystem::path> leftovers;
    const std::string prefix = temporaryPrefix(target);
    std::error_code code;
    for (const auto& entry : std::filesystem::directory_iterator(folderOf(target), code)) {
        if (!entry.path().filename().string().starts_with(prefix)) continue;
        const int descriptor = ::open(entry.path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        if (descriptor < 0) continue;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) leftovers.push_back(entry.path());
        ::close(descriptor);
    }
    std::sort(leftovers.begin(), leftovers.end());
    return leftovers;
}

}  // namespace pagoda::ooc
