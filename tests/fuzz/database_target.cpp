// Any file as a database: opened, walked, every page decoded, verified. Checksums are mended first,
// or they would turn away every input before it reaches what is behind them.
#include "ooc/base/bytes.h"
#include "ooc/base/error.h"
#include "ooc/base/hash.h"
#include "ooc/store/database.h"
#include "ooc/store/layout.h"
#include "ooc/store/verify.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/targets.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace pagoda::fuzz {
namespace {

// Places in the header and in records, as ooc/FORMAT.md has them.
constexpr size_t kFileBytesAt = 120, kPagesEndAt = 128, kRangesAt = 136;
constexpr size_t kHeaderChecksumAt = ooc::kHeaderBytes - 8;
constexpr size_t kPageOffsetInRecord = 40, kPageChecksumInRecord = 48, kPageBytesInRecord = 64;

class Mender {
public:
    explicit Mender(std::vector<std::byte>& file) : file_(file) {}

    // From the inside out: pages, blocks, tables, header, footer. What lies outside of the file is
    // left as it is.
    void mend() {
        const size_t footer = file_.size() - ooc::kHeaderBytes;
        put<uint64_t>(kFileBytesAt, file_.size());
        mendPages(get<uint64_t>(kPagesEndAt), get<uint64_t>(kRangesAt));
        for (size_t range = 0; range < 4; ++range) {
            const size_t at = kRangesAt + 24 * range;
            if (range < 2) mendBlocks(get<uint64_t>(at), get<uint64_t>(at + 8));
            mendChecksum(get<uint64_t>(at), get<uint64_t>(at + 8), at + 16);
        }
        mendChecksum(0, kHeaderChecksumAt, kHeaderChecksumAt);
        std::copy_n(file_.begin(), ooc::kHeaderBytes,
                    file_.begin() + static_cast<ptrdiff_t>(footer));
    }

private:
    template <typename Value>
    [[nodiscard]] Value get(uint64_t at) const {
        Value value;
        std::memcpy(&value, file_.data() + at, sizeof value);
        return value;
    }
    template <typename Value>
    void put(uint64_t at, Value value) {
        std::memcpy(file_.data() + at, &value, sizeof value);
    }
    [[nodiscard]] bool isInFile(uint64_t offset, uint64_t bytes) const {
        return offset <= file_.size() && bytes <= file_.size() - offset;
    }
    void mendChecksum(uint64_t offset, uint64_t bytes, uint64_t checksumAt) {
        if (!isInFile(offset, bytes)) return;
        put(checksumAt, hash64(std::span(file_).subspan(offset, bytes)));
    }
    void mendPages(uint64_t begin, uint64_t end) {
        if (end > file_.size()) return;
        for (uint64_t at = begin; at < end && end - at >= ooc::kNodeRecordBytes;
             at += ooc::kNodeRecordBytes) {
            mendChecksum(get<uint64_t>(at + kPageOffsetInRecord),
                         get<uint32_t>(at + kPageBytesInRecord), at + kPageChecksumInRecord);
        }
    }
    void mendBlocks(uint64_t offset, uint64_t bytes) {
        if (!isInFile(offset, bytes)) return;
        for (uint64_t at = offset; bytes - (at - offset) >= ooc::kDirectoryEntryBytes;
             at += ooc::kDirectoryEntryBytes) {
            mendChecksum(get<uint64_t>(at), get<uint32_t>(at + 8), at + 16);
        }
    }

    std::vector<std::byte>& file_;
};

void walkAll(const ooc::Database& database) {
    uint64_t visited = 0;
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            require(++visited <= database.header().nodeCount, "a node is visited once");
            const auto page = database.readPage(node);
            require(page.value.has_value() == page.fault.empty(), "a page or a fault");
            return true;
        },
        [](uint32_t, const std::string& why) { require(!why.empty(), "a fault has a reason"); });
    for (uint32_t block = 0; block < database.objectBlockCount(); ++block) {
        const auto objects = database.readObjectBlock(block);
        require(objects.value.has_value() == objects.fault.empty(), "objects or a fault");
    }
}

}  // namespace

void openAnyDatabase(std::span<const std::byte> input) {
    std::vector<std::byte> bytes(input.begin(), input.end());
    if (bytes.size() >= 2 * ooc::kHeaderBytes) Mender(bytes).mend();
    const std::filesystem::path path = writeInput(bytes, ".pagoda");
    try {
        walkAll(ooc::Database::open(path));
    } catch (const Error& error) {
        require(!error.path().empty() && !error.problem().empty(), "an error has path and problem");
    }
    Progress progress;
    (void)ooc::verifyDatabase(path, 1, progress);
}

}  // namespace pagoda::fuzz
