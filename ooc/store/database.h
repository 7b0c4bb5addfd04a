// database.h: reads a database. Opening costs the header, the block directories, materials and
// metadata: it does not grow with what is never looked at. Nothing read is trusted.
// Const calls may come from any thread at once. Faults of single pages and blocks are values, so
// that a flipped bit costs that page alone; open() throws Error for the
// rest.
#pragma once

#include "ooc/base/file.h"
#include "ooc/store/records.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pagoda::ooc {

// Position of a node's record.
struct NodeRef {
    uint32_t block = 0, index = 0;
    [[nodiscard]] auto operator<=>(const NodeRef&) const = default;
};

struct IndexBlock {
    std::vector<NodeRecord> nodes;
};

template <typename T>
struct Loaded {
    std::optional<T> value;
    std::string fault;  // why not, when there is no value
};

class Database {
public:
    // Falls back on the footer when the header is broken (headerFault() says so). Throws Error when
    // neither is sound, or materials or directories are broken.
    [[nodiscard]] static Database open(const std::filesystem::path& path);

    [[nodiscard]] const std::string& path() const noexcept { return file_.path(); }
    [[nodiscard]] const Header& header() const noexcept { return header_; }
    [[nodiscard]] const std::string& headerFault() const noexcept { return headerFault_; }
    [[nodiscard]] const std::vector<MaterialRecord>& materials() const noexcept {
        return materials_;
    }
    // JSON text; "{}" and a fault when its checksum is wrong.
    [[nodiscard]] const std::string& metadataJson() const noexcept { return metadata_; }
    [[nodiscard]] const std::string& metadataFault() const noexcept { return metadataFault_; }

    [[nodiscard]] uint32_t blockCount() const noexcept;
    // Every record of a block that loads is sound in itself: id, box in the lattice, page in the
    // file, children in an existing place further on. Their ids are checked where they lie in the
    // same block; who follows a reference into another block compares with NodeRecord::childId().
    [[nodiscard]] Loaded<IndexBlock> readBlock(uint32_t block) const;
    // The same from the bytes of indexRanges()[block], checked against its checksum.
    [[nodiscard]] Loaded<IndexBlock> decodeBlock(uint32_t block,
                                                 std::span<const std::byte> bytes) const;
    // The root is record 0 of block 0.
    [[nodiscard]] Loaded<std::vector<std::byte>> readPageBytes(const NodeRecord& node) const;
    // The page decoded and held against its record: counts, box, flags, and object and material
    // ids.
    [[nodiscard]] Loaded<Page> readPage(const NodeRecord& node) const;
    // The same from bytes read elsewhere, checked against the record's checksum.
    [[nodiscard]] Loaded<Page> decodePage(const NodeRecord& node,
                                          std::span<const std::byte> bytes) const;

    [[nodiscard]] Loaded<ObjectRecord> readObject(
        uint32_t object) const;  // loads its block: for single look-ups
    [[nodiscard]] uint32_t objectBlockCount() const noexcept;
    [[nodiscard]] Loaded<std::vector<ObjectRecord>> readObjectBlock(uint32_t block) const;

    // A range of the file and its checksum: all of them together tile the file (verify).
    struct Range {
        std::string name;
        uint64_t offset = 0, bytes = 0, checksum = 0;
    };
    [[nodiscard]] const std::vector<Range>& indexRanges() const noexcept { return indexRanges_; }
    [[nodiscard]] const std::vector<Range>& objectRanges() const noexcept { return objectRanges_; }
    // Header, directories, materials, metadata, footer; not the pages, which records hold.
    [[nodiscard]] const std::vector<Range>& otherRanges() const noexcept { return otherRanges_; }
    [[nodiscard]] const File& file() const noexcept { return file_; }

private:
    Database() = default;

    File file_;
    Header header_;
    std::string headerFault_;
    std::vector<MaterialRecord> materials_;
    std::string metadata_ = "{}", metadataFault_;
    std::vector<Range> indexRanges_, objectRanges_, otherRanges_;
    uint64_t pagesEnd_ = 0;
};

// Walks every node, parents before children, loading index blocks as it goes (each once, one at a
// time kept a level). `visit(const NodeRecord&, NodeRef) -> bool` returns false to skip the
// subtree. Faults of blocks go to `fault(uint32_t block, const std::string& why)`: that block's
// nodes, and all below, are not visited.
template <typename Visit, typename Fault>
void forEachNode(const Database& database, Visit&& visit, Fault&& fault);

// The same walk for who needs families: `visitor` has
//   bool enter(const NodeRecord&, NodeRef);   // as `visit`
//   void children(const NodeRecord& parent, std::span<const NodeRecord> children);  // before they
//   are
//                                             // entered; not called where their block is broken
//   void fault(uint32_t block, const std::string& why);
template <typename Visitor>
void walkIndex(const Database& database, Visitor& visitor);

}  // namespace pagoda::ooc

#include "ooc/store/database_walk.inl"
