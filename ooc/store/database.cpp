#include "ooc/store/database.h"

#include "ooc/base/error.h"
#include "ooc/store/layout.h"

#include <algorithm>
#include <utility>

namespace pagoda::ooc {
namespace {

constexpr const char* kRemedy = "copy it again or build it again";

std::string named(const char* what, uint64_t number) {
    return std::string(what) + " " + std::to_string(number);
}

constexpr const char* kChecksumDiffers = "checksum differs";

Loaded<std::vector<std::byte>> readBytes(const File& file, uint64_t offset, uint64_t bytes) {
    try {
        std::vector<std::byte> data(bytes);
        file.readAt(offset, data);
        return {std::move(data), {}};
    } catch (const Error& error) {
        return {{}, error.place() + ": " + error.problem()};
    }
}

// Reads a range and holds it against its checksum.
Loaded<std::vector<std::byte>> readChecked(const File& file, uint64_t offset, uint64_t bytes,
                                           uint64_t checksum) {
    auto data = readBytes(file, offset, bytes);
    if (data.value && hash64(*data.value) != checksum) return {{}, kChecksumDiffers};
    return data;
}

std::vector<std::byte> readOrThrow(const File& file, const FileRange& range, const char* place) {
    auto loaded = readChecked(file, range.offset, range.bytes, range.checksum);
    if (!loaded.value) throw Error(file.path(), place, loaded.fault, kRemedy);
    return std::move(*loaded.value);
}

void refuse(const File& file, const char* place, const std::string& fault) {
    if (!fault.empty()) throw Error(file.path(), place, fault, kRemedy);
}

std::vector<Database::Range> toRanges(const std::vector<DirectoryEntry>& entries,
                                      const char* name) {
    std::vector<Database::Range> ranges;
    ranges.reserve(entries.size());
    for (const DirectoryEntry& entry : entries) {
        ranges.push_back({named(name, ranges.size()), entry.offset, entry.bytes, entry.checksum});
    }
    return ranges;
}

std::string checkBlockSizes(const std::vector<DirectoryEntry>& blocks) {
    for (const DirectoryEntry& block : blocks) {
        if (block.count == 0 || block.count > kMaxNodesPerBlock ||
            block.bytes != block.count * kNodeRecordBytes) {
            return "block of " + std::to_string(block.count) + " nodes";
        }
    }
    return {};
}

std::string checkObjectBlockSizes(const std::vector<DirectoryEntry>& blocks) {
    for (const DirectoryEntry& block : blocks) {
        const bool isLast = &block == &blocks.back();
        if (block.count == 0 || block.count > kObjectsPerBlock ||
            block.bytes < block.count * kObjectRecordBytes ||
            (!isLast && block.count != kObjectsPerBlock)) {
            return "block of " + std::to_string(block.count) + " objects";
        }
    }
    return {};
}

uint32_t nodesIn(const Database::Range& block) {
    return static_cast<uint32_t>(block.bytes / kNodeRecordBytes);
}

// What a reference to children may say: a place further on, and in the same block their ids.
std::string checkChildren(const NodeRecord& node, NodeRef self,
                          const std::vector<Database::Range>& blocks,
                          const std::vector<NodeRecord>& nodes) {
    if (node.isLeaf()) return {};
    const NodeRef first{node.childBlock, node.childIndex};
    if (first.block >= blocks.size() || first <= self) return "children out of place";
    const uint64_t end = uint64_t{first.index} + node.childCount();
    if (end > nodesIn(blocks[first.block])) return "children reach beyond their block";
    if (first.block != self.block) return {};
    for (uint32_t k = 0; k < node.childCount(); ++k) {
        if (nodes[first.index + k].id != node.childId(k)) return "children of another node";
    }
    return {};
}

uint16_t flagsOf(const Page& page) {
    const PageMesh& mesh = page.mesh;
    return static_cast<uint16_t>(
        (mesh.colours.empty() ? 0 : kNodeHasColours) |
        (mesh.normals.empty() ? 0 : kNodeHasNormals) |
        (mesh.opaqueTriangleCount() == mesh.triangleCount() ? 0 : kNodeHasTranslucent) |
        (page.zippers.empty() ? 0 : kNodeHasZippers));
}

std::string checkPage(const Page& page, const NodeRecord& node, const Header& header) {
    constexpr uint16_t kOfThePage =
        kNodeHasColours | kNodeHasNormals | kNodeHasTranslucent | kNodeHasZippers;
    const PageMesh& mesh = page.mesh;
    if (mesh.triangleCount() != node.triangleCount || mesh.vertexCount() != node.vertexCount ||
        mesh.opaqueTriangleCount() != node.opaqueTriangleCount) {
        return "counts differ from the node's";
    }
    if ((node.flags & kOfThePage) != flagsOf(page)) return "flags differ from the node's";
    if (!mesh.positions.empty() && !node.box.contains(mesh.box())) {
        return "mesh leaves the node's box";
    }
    for (const MeshRun& run : mesh.runs) {
        if (run.object >= header.objectCount) return named("no such object:", run.object);
        if (run.material >= header.materialCount) return named("no such material:", run.material);
    }
    const int32_t limit = static_cast<int32_t>(1u << header.lattice.extentBits);
    const Box3i root{Vec3i(0), Vec3i(limit)};
    for (const Zipper& zipper : page.zippers) {
        for (const Vec3i& position : zipper.positions) {
            if (!root.contains(position)) return "zipper leaves the lattice";
        }
    }
    return {};
}

}  // namespace

Database Database::open(const std::filesystem::path& path) {
    Database database;
    database.file_ = File::openForReading(path);
    const File& file = database.file_;
    const uint64_t fileBytes = file.sizeBytes();
    if (fileBytes < 2 * kHeaderBytes) {
        throw Error(file.path(), "", "not a Pagoda database", "build one with `pagoda build`");
    }

    std::vector<std::byte> head(kHeaderBytes);
    file.readAt(0, head);
    FileLayout layout;
    database.headerFault_ = parseHeader(head, fileBytes, layout);
    if (!database.headerFault_.empty()) {
        file.readAt(fileBytes - kHeaderBytes, head);
        layout = {};
        if (!parseHeader(head, fileBytes, layout).empty()) {
            throw Error(file.path(), "header", database.headerFault_, kRemedy);
        }
    }
    database.header_ = layout.header;
    database.pagesEnd_ = layout.pagesEnd;

    std::vector<DirectoryEntry> entries;
    refuse(
        file, "index directory",
        parseDirectory(readOrThrow(file, layout.indexDirectory, "index directory"), layout.pagesEnd,
                       layout.indexDirectory.offset, layout.header.nodeCount, entries));
    refuse(file, "index directory", checkBlockSizes(entries));
    database.indexRanges_ = toRanges(entries, "index block");
    refuse(file, "object directory",
           parseDirectory(readOrThrow(file, layout.objectDirectory, "object directory"),
                          layout.indexDirectory.end(), layout.objectDirectory.offset,
                          layout.header.objectCount, entries));
    refuse(file, "object directory", checkObjectBlockSizes(entries));
    database.objectRanges_ = toRanges(entries, "object block");
    refuse(file, "materials",
           parseMaterials(readOrThrow(file, layout.materials, "materials"),
                          layout.header.materialCount, database.materials_));

    const FileRange& metadata = layout.metadata;
    auto text = readChecked(file, metadata.offset, metadata.bytes, metadata.checksum);
    database.metadataFault_ = text.fault;
    if (text.value) {
        database.metadata_.assign(reinterpret_cast<const char*>(text.value->data()),
                                  text.value->size());
    }

    const auto add = [&](const char* name, const FileRange& range) {
        database.otherRanges_.push_back({name, range.offset, range.bytes, range.checksum});
    };
    add("header", {0, kHeaderBytes, hash64(head)});
    add("index directory", layout.indexDirectory);
    add("object directory", layout.objectDirectory);
    add("materials", layout.materials);
    add("metadata", metadata);
    add("footer", {fileBytes - kHeaderBytes, kHeaderBytes, hash64(head)});
    return database;
}

uint32_t Database::blockCount() const noexcept {
    return static_cast<uint32_t>(indexRanges_.size());
}

Loaded<IndexBlock> Database::readBlock(uint32_t block) const {
    if (block >= indexRanges_.size()) return {{}, "no such block"};
    const Range& range = indexRanges_[block];
    auto bytes = readBytes(file_, range.offset, range.bytes);
    if (!bytes.value) return {{}, bytes.fault};
    return decodeBlock(block, *bytes.value);
}

Loaded<IndexBlock> Database::decodeBlock(uint32_t block, std::span<const std::byte> bytes) const {
    if (block >= indexRanges_.size()) return {{}, "no such block"};
    const Range& range = indexRanges_[block];
    if (bytes.size() != range.bytes || hash64(bytes) != range.checksum) {
        return {{}, kChecksumDiffers};
    }
    IndexBlock loaded;
    loaded.nodes.reserve(nodesIn(range));
    ByteReader in(bytes);
    for (uint32_t i = 0; i < nodesIn(range); ++i) loaded.nodes.push_back(getNode(in));
    for (uint32_t i = 0; i < loaded.nodes.size(); ++i) {
        const NodeRecord& node = loaded.nodes[i];
        std::string fault = checkNode(node, header_, pagesEnd_);
        if (fault.empty()) fault = checkChildren(node, {block, i}, indexRanges_, loaded.nodes);
        if (!fault.empty()) return {{}, named("node", i) + ": " + fault};
    }
    if (block == 0 && loaded.nodes[0].id != NodeId::root()) return {{}, "no root"};
    return {std::move(loaded), {}};
}

Loaded<std::vector<std::byte>> Database::readPageBytes(const NodeRecord& node) const {
    if (node.pageOffset > pagesEnd_ || node.pageBytes > pagesEnd_ - node.pageOffset) {
        return {{}, "page lies outside of the pages"};
    }
    return readChecked(file_, node.pageOffset, node.pageBytes, node.pageChecksum);
}

Loaded<Page> Database::readPage(const NodeRecord& node) const {
    if (node.pageOffset > pagesEnd_ || node.pageBytes > pagesEnd_ - node.pageOffset) {
        return {{}, "page lies outside of the pages"};
    }
    const auto bytes = readBytes(file_, node.pageOffset, node.pageBytes);
    if (!bytes.value) return {{}, bytes.fault};
    return decodePage(node, *bytes.value);
}

Loaded<Page> Database::decodePage(const NodeRecord& node, std::span<const std::byte> bytes) const {
    if (bytes.size() != node.pageBytes || hash64(bytes) != node.pageChecksum) {
        return {{}, kChecksumDiffers};
    }
    DecodeResult decoded = ooc::decodePage(bytes);
    if (!decoded.page) return {{}, std::move(decoded.fault)};
    if (std::string fault = checkPage(*decoded.page, node, header_); !fault.empty()) {
        return {{}, std::move(fault)};
    }
    return {std::move(decoded.page), {}};
}

Loaded<ObjectRecord> Database::readObject(uint32_t object) const {
    if (object >= header_.objectCount) return {{}, "no such object"};
    auto block = readObjectBlock(object / kObjectsPerBlock);
    if (!block.value) return {{}, std::move(block.fault)};
    return {std::move((*block.value)[object % kObjectsPerBlock]), {}};
}

uint32_t Database::objectBlockCount() const noexcept {
    return static_cast<uint32_t>(objectRanges_.size());
}

Loaded<std::vector<ObjectRecord>> Database::readObjectBlock(uint32_t block) const {
    if (block >= objectRanges_.size()) return {{}, "no such block"};
    const Range& range = objectRanges_[block];
    const auto bytes = readChecked(file_, range.offset, range.bytes, range.checksum);
    if (!bytes.value) return {{}, bytes.fault};
    const uint64_t firstId = uint64_t{block} * kObjectsPerBlock;
    const uint64_t count = std::min<uint64_t>(header_.objectCount - firstId, kObjectsPerBlock);
    std::vector<ObjectRecord> objects;
    std::string fault = parseObjectBlock(*bytes.value, static_cast<uint32_t>(firstId),
                                         static_cast<uint32_t>(count), header_.lattice, objects);
    if (!fault.empty()) return {{}, std::move(fault)};
    return {std::move(objects), {}};
}

}  // namespace pagoda::ooc
