// layout.h: the bytes of a database's header, records and tables, and back. Bytes: ooc/FORMAT.md.
// Used by the store's own files only; everyone else sees records.h. Parsers return what is wrong as
// text (empty: nothing), and trust nothing: every number is in its range afterwards.
#pragma once

#include "ooc/base/bytes.h"
#include "ooc/store/records.h"

#include <span>
#include <string>
#include <vector>

namespace pagoda::ooc {

inline constexpr char kMagic[6] = {'P', 'A', 'G', 'O', 'D', 'A'};
inline constexpr uint16_t kFormatVersion = 1;
inline constexpr size_t kHeaderBytes = 256;
inline constexpr size_t kNodeRecordBytes = 96;
inline constexpr size_t kDirectoryEntryBytes = 24;
inline constexpr size_t kObjectRecordBytes = 48;
inline constexpr size_t kMaterialRecordBytes = 16;
inline constexpr uint32_t kMaxNodesPerBlock = 512;
inline constexpr uint32_t kObjectsPerBlock = 4096;
inline constexpr uint32_t kMaxNameBytes = 65535;
inline constexpr uint32_t kMaxPageBytes = 1u << 30;

// A range of the file under one checksum.
struct FileRange {
    uint64_t offset = 0, bytes = 0, checksum = 0;
    [[nodiscard]] uint64_t end() const { return offset + bytes; }
};

// Where everything is. In file order: header, pages, index blocks, index directory, object blocks,
// object directory, materials, metadata, footer; each begins where the one before ends.
struct FileLayout {
    Header header;
    uint64_t pagesEnd = 0;  // pages lie in [kHeaderBytes, pagesEnd); index blocks follow
    FileRange indexDirectory, objectDirectory, materials, metadata;
};

// One block of nodes or objects.
struct DirectoryEntry {
    uint64_t offset = 0, checksum = 0;
    uint32_t bytes = 0, count = 0;
};

[[nodiscard]] std::vector<std::byte> headerBytes(const FileLayout& layout);
// `fileBytes` is the file's real size: a header that says otherwise is wrong.
[[nodiscard]] std::string parseHeader(std::span<const std::byte> bytes, uint64_t fileBytes,
                                      FileLayout& layout);

[[nodiscard]] std::vector<std::byte> directoryBytes(std::span<const DirectoryEntry> entries);
// The blocks tile [begin, end) of the file and hold `count` records in all.
[[nodiscard]] std::string parseDirectory(std::span<const std::byte> bytes, uint64_t begin,
                                         uint64_t end, uint64_t count,
                                         std::vector<DirectoryEntry>& entries);

void putNode(const NodeRecord& node, ByteWriter& out);
// Only the bytes; checkNode() does the rest.
[[nodiscard]] NodeRecord getNode(ByteReader& in);
// What one record can say wrong on its own and within the file.
[[nodiscard]] std::string checkNode(const NodeRecord& node, const Header& header,
                                    uint64_t pagesEnd);

[[nodiscard]] std::vector<std::byte> objectBlockBytes(std::span<const ObjectRecord> objects);
// `firstId` is the id of the block's first object: parents come before their children.
[[nodiscard]] std::string parseObjectBlock(std::span<const std::byte> bytes, uint32_t firstId,
                                           uint32_t count, const Lattice& lattice,
                                           std::vector<ObjectRecord>& objects);

[[nodiscard]] std::vector<std::byte> materialBytes(std::span<const MaterialRecord> materials);
[[nodiscard]] std::string parseMaterials(std::span<const std::byte> bytes, uint64_t count,
                                         std::vector<MaterialRecord>& materials);

}  // namespace pagoda::ooc
