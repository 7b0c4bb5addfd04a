#include "ooc/store/layout.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pagoda::ooc {
namespace {

// Steps outside of this leave double for any coordinate that fits 30 bits.
constexpr int kLeastStepExponent = -1000, kGreatestStepExponent = 900;
constexpr uint32_t kMaxLevels = kMaxDepth + 2;  // the root, 19 below, and extra leaves of the last

void putRange(const FileRange& range, ByteWriter& out) {
    out.put(range.offset);
    out.put(range.bytes);
    out.put(range.checksum);
}

FileRange getRange(ByteReader& in) {
    FileRange range;
    range.offset = in.get<uint64_t>();
    range.bytes = in.get<uint64_t>();
    range.checksum = in.get<uint64_t>();
    return range;
}

void putBox(const Box3i& box, ByteWriter& out) {
    for (int axis = 0; axis < 3; ++axis) out.put(box.min[axis]);
    for (int axis = 0; axis < 3; ++axis) out.put(box.max[axis]);
}

Box3i getBox(ByteReader& in) {
    Box3i box;
    for (int axis = 0; axis < 3; ++axis) box.min[axis] = in.get<int32_t>();
    for (int axis = 0; axis < 3; ++axis) box.max[axis] = in.get<int32_t>();
    return box;
}

bool liesIn(const Box3i& box, const Lattice& lattice) {
    const Box3i root{Vec3i(0), Vec3i(static_cast<int32_t>(1u << lattice.extentBits))};
    return !box.isEmpty() && root.contains(box);
}

std::string checkLattice(const Lattice& lattice) {
    const bool isFinite = std::isfinite(lattice.origin.x) && std::isfinite(lattice.origin.y) &&
                          std::isfinite(lattice.origin.z);
    if (!isFinite) return "lattice origin is not finite";
    if (lattice.stepExponent < kLeastStepExponent || lattice.stepExponent > kGreatestStepExponent) {
        return "lattice step 2^" + std::to_string(lattice.stepExponent);
    }
    if (lattice.extentBits < 1 || lattice.extentBits > kMaxExtentBits) {
        return "lattice of " + std::to_string(lattice.extentBits) + " bits";
    }
    return {};
}

std::string checkCounts(const Header& header) {
    if (header.nodeCount == 0) return "no nodes";
    if (header.leafCount == 0 || header.leafCount > header.nodeCount) return "leaf count";
    if (header.levelCount == 0 || header.levelCount > kMaxLevels) return "level count";
    if (header.objectCount > UINT32_MAX) return "object count";
    if (header.materialCount > UINT32_MAX) return "material count";
    return {};
}

// The parts follow each other without a gap and fill the file.
std::string checkTiling(const FileLayout& layout, uint64_t fileBytes) {
    const uint64_t bounds[] = {kHeaderBytes,
                               layout.pagesEnd,
                               layout.indexDirectory.offset,
                               layout.indexDirectory.end(),
                               layout.objectDirectory.offset,
                               layout.objectDirectory.end(),
                               layout.metadata.end(),
                               fileBytes};
    if (!std::is_sorted(std::begin(bounds), std::end(bounds))) return "parts out of order";
    for (const FileRange* range :
         {&layout.indexDirectory, &layout.objectDirectory, &layout.materials, &layout.metadata}) {
        if (range->offset > fileBytes || range->bytes > fileBytes - range->offset) {
            return "a part reaches beyond the file";
        }
    }
    if (layout.materials.offset != layout.objectDirectory.end() ||
        layout.metadata.offset != layout.materials.end() ||
        layout.metadata.end() + kHeaderBytes != fileBytes) {
        return "parts leave a gap or overlap";
    }
    const uint64_t indexBytes = layout.indexDirectory.offset - layout.pagesEnd;
    if (indexBytes % kNodeRecordBytes != 0 ||
        indexBytes / kNodeRecordBytes != layout.header.nodeCount) {
        return "index blocks of another size than the nodes";
    }
    return {};
}

bool isNodeId(NodeId id) {
    const uint64_t path = id.path();
    return path != 0 && (std::bit_width(path) - 1) % 3 == 0 && id.depth() <= kMaxDepth;
}

}  // namespace

std::vector<std::byte> headerBytes(const FileLayout& layout) {
    const Header& header = layout.header;
    ByteWriter out;
    out.putArray(std::span<const char>(kMagic));
    out.put(kFormatVersion);
    out.put(static_cast<uint32_t>(kHeaderBytes));
    out.put(uint32_t{0});  // features that a reader must know: none yet
    for (int axis = 0; axis < 3; ++axis) out.put(header.lattice.origin[axis]);
    out.put(static_cast<int32_t>(header.lattice.stepExponent));
    out.put(static_cast<uint32_t>(header.lattice.extentBits));
    out.put(static_cast<uint32_t>(header.codec));
    out.put(header.levelCount);
    out.put(header.nodeTriangles);
    out.put(uint32_t{0});
    out.put(header.nodeCount);
    out.put(header.leafCount);
    out.put(header.triangleCount);
    out.put(header.triangleSum.low);
    out.put(header.triangleSum.high);
    out.put(header.objectCount);
    out.put(header.materialCount);
    out.put(header.fileBytes);
    out.put(layout.pagesEnd);
    for (const FileRange* range :
         {&layout.indexDirectory, &layout.objectDirectory, &layout.materials, &layout.metadata}) {
        putRange(*range, out);
    }
    while (out.size() < kHeaderBytes - sizeof(uint64_t)) out.put(uint8_t{0});
    out.put(hash64(out.bytes()));
    return out.take();
}

std::string parseHeader(std::span<const std::byte> bytes, uint64_t fileBytes, FileLayout& layout) {
    if (bytes.size() != kHeaderBytes) return "cut short";
    if (std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0) return "not a Pagoda database";
    ByteReader in(bytes.subspan(sizeof kMagic));
    const auto version = in.get<uint16_t>();
    ByteReader end(bytes.last(sizeof(uint64_t)));
    if (end.get<uint64_t>() != hash64(bytes.first(kHeaderBytes - sizeof(uint64_t)))) {
        return version == kFormatVersion ? "checksum differs"
                                         : "version " + std::to_string(version) + ", not 1";
    }
    if (version != kFormatVersion) return "version " + std::to_string(version) + ", not 1";
    if (in.get<uint32_t>() != kHeaderBytes) return "header of another size";
    if (in.get<uint32_t>() != 0) return "needs features that this reader does not know";

    Header& header = layout.header;
    for (int axis = 0; axis < 3; ++axis) header.lattice.origin[axis] = in.get<double>();
    header.lattice.stepExponent = in.get<int32_t>();
    header.lattice.extentBits = in.get<int32_t>();
    const auto codec = in.get<uint32_t>();
    header.levelCount = in.get<uint32_t>();
    header.nodeTriangles = in.get<uint32_t>();
    if (in.get<uint32_t>() != 0) return "reserved bytes in use";
    header.nodeCount = in.get<uint64_t>();
    header.leafCount = in.get<uint64_t>();
    header.triangleCount = in.get<uint64_t>();
    header.triangleSum.low = in.get<uint64_t>();
    header.triangleSum.high = in.get<uint64_t>();
    header.objectCount = in.get<uint64_t>();
    header.materialCount = in.get<uint64_t>();
    header.fileBytes = in.get<uint64_t>();
    layout.pagesEnd = in.get<uint64_t>();
    for (FileRange* range :
         {&layout.indexDirectory, &layout.objectDirectory, &layout.materials, &layout.metadata}) {
        *range = getRange(in);
    }
    if (header.fileBytes != fileBytes) {
        return std::to_string(header.fileBytes) + " bytes announced, " + std::to_string(fileBytes) +
               " there";
    }
    if (codec > static_cast<uint32_t>(Codec::Draco)) return "codec " + std::to_string(codec);
    header.codec = static_cast<Codec>(codec);
    if (std::string fault = checkLattice(header.lattice); !fault.empty()) return fault;
    if (std::string fault = checkCounts(header); !fault.empty()) return fault;
    return checkTiling(layout, fileBytes);
}

std::vector<std::byte> directoryBytes(std::span<const DirectoryEntry> entries) {
    ByteWriter out;
    for (const DirectoryEntry& entry : entries) {
        out.put(entry.offset);
        out.put(entry.bytes);
        out.put(entry.count);
        out.put(entry.checksum);
    }
    return out.take();
}

std::string parseDirectory(std::span<const std::byte> bytes, uint64_t begin, uint64_t end,
                           uint64_t count, std::vector<DirectoryEntry>& entries) {
    if (bytes.size() % kDirectoryEntryBytes != 0) return "not a whole number of entries";
    entries.resize(bytes.size() / kDirectoryEntryBytes);
    if (entries.size() > UINT32_MAX) return "too many blocks";
    ByteReader in(bytes);
    uint64_t next = begin, sum = 0;
    for (DirectoryEntry& entry : entries) {
        entry.offset = in.get<uint64_t>();
        entry.bytes = in.get<uint32_t>();
        entry.count = in.get<uint32_t>();
        entry.checksum = in.get<uint64_t>();
        if (entry.offset != next || entry.bytes > end - next)
            return "blocks leave a gap or overlap";
        next += entry.bytes;
        sum += entry.count;
    }
    if (next != end) return "blocks do not fill their part of the file";
    if (sum != count) return "blocks hold another number of records than the header says";
    return {};
}

void putNode(const NodeRecord& node, ByteWriter& out) {
    out.put(node.id.value);
    putBox(node.box, out);
    out.put(node.errorModelUnits);
    out.put(node.pageOffset);
    out.put(node.pageChecksum);
    out.put(node.subtreeTriangles);
    out.put(node.pageBytes);
    out.put(node.triangleCount);
    out.put(node.opaqueTriangleCount);
    out.put(node.vertexCount);
    out.put(node.childBlock);
    out.put(node.childIndex);
    out.put(node.childMask);
    out.put(node.flags);
    out.put(uint32_t{0});
}

NodeRecord getNode(ByteReader& in) {
    NodeRecord node;
    node.id.value = in.get<uint64_t>();
    node.box = getBox(in);
    node.errorModelUnits = in.get<double>();
    node.pageOffset = in.get<uint64_t>();
    node.pageChecksum = in.get<uint64_t>();
    node.subtreeTriangles = in.get<uint64_t>();
    node.pageBytes = in.get<uint32_t>();
    node.triangleCount = in.get<uint32_t>();
    node.opaqueTriangleCount = in.get<uint32_t>();
    node.vertexCount = in.get<uint32_t>();
    node.childBlock = in.get<uint32_t>();
    node.childIndex = in.get<uint32_t>();
    node.childMask = in.get<uint16_t>();
    node.flags = in.get<uint16_t>();
    (void)in.get<uint32_t>();
    return node;
}

std::string checkNode(const NodeRecord& node, const Header& header, uint64_t pagesEnd) {
    if (!isNodeId(node.id)) return "id names no cell";
    if (node.id.slot() != 0 && !node.isLeaf()) return "extra leaf with children";
    if (!liesIn(node.box, header.lattice)) return "box leaves the lattice";
    if (!std::isfinite(node.errorModelUnits) || node.errorModelUnits < 0) return "error";
    if (node.pageOffset < kHeaderBytes || node.pageOffset > pagesEnd ||
        node.pageBytes > pagesEnd - node.pageOffset || node.pageBytes > kMaxPageBytes) {
        return "page lies outside of the pages";
    }
    if ((node.childMask & 0xF000u) != 0) return "child mask";
    if (node.isLeaf() && (node.childBlock != 0 || node.childIndex != 0))
        return "leaf with children";
    if (!node.isLeaf() && node.id.depth() == kMaxDepth && (node.childMask & 0xFFu) != 0) {
        return "children below the deepest level";
    }
    if (node.opaqueTriangleCount > node.triangleCount)
        return "more opaque triangles than triangles";
    if (node.subtreeTriangles > header.triangleCount) return "triangles below";
    if (node.isLeaf() && node.subtreeTriangles != node.triangleCount) return "triangles below";
    return {};
}

namespace {

// Names lie behind the records, one after the other.
std::string takeName(std::span<const std::byte> names, uint32_t offset, uint32_t bytes,
                     uint64_t& next, std::string& name) {
    if (offset != next || bytes > kMaxNameBytes || bytes > names.size() - next) return "name";
    name.assign(reinterpret_cast<const char*>(names.data()) + next, bytes);
    next += bytes;
    return {};
}

}  // namespace

std::vector<std::byte> objectBlockBytes(std::span<const ObjectRecord> objects) {
    ByteWriter out;
    uint32_t nameOffset = 0;
    for (const ObjectRecord& object : objects) {
        const auto nameBytes = static_cast<uint32_t>(object.name.size());
        out.put(object.parent);
        out.put(object.source);
        putBox(object.box, out);
        out.put(object.triangleCount);
        out.put(nameOffset);
        out.put(nameBytes);
        nameOffset += nameBytes;
    }
    for (const ObjectRecord& object : objects) out.putArray(std::span<const char>(object.name));
    return out.take();
}

std::string parseObjectBlock(std::span<const std::byte> bytes, uint32_t firstId, uint32_t count,
                             const Lattice& lattice, std::vector<ObjectRecord>& objects) {
    if (uint64_t{count} * kObjectRecordBytes > bytes.size()) return "cut short";
    const auto names = bytes.subspan(count * kObjectRecordBytes);
    ByteReader in(bytes);
    objects.resize(count);
    uint64_t next = 0;
    for (uint32_t i = 0; i < count; ++i) {
        ObjectRecord& object = objects[i];
        object.parent = in.get<uint32_t>();
        object.source = in.get<uint32_t>();
        object.box = getBox(in);
        object.triangleCount = in.get<uint64_t>();
        const auto nameOffset = in.get<uint32_t>();
        const auto nameBytes = in.get<uint32_t>();
        const std::string who = "object " + std::to_string(firstId + i) + ": ";
        if (object.parent != UINT32_MAX && object.parent >= firstId + i) {
            return who + "parent does not come before it";
        }
        if (object.triangleCount != 0 && !liesIn(object.box, lattice)) {
            return who + "box leaves the lattice";
        }
        if (object.triangleCount == 0) object.box = Box3i{};
        if (!takeName(names, nameOffset, nameBytes, next, object.name).empty()) {
            return who + "name reaches beyond its block";
        }
    }
    return next == names.size() ? std::string{} : "names do not fill their block";
}

std::vector<std::byte> materialBytes(std::span<const MaterialRecord> materials) {
    ByteWriter out;
    uint32_t nameOffset = 0;
    for (const MaterialRecord& material : materials) {
        const auto nameBytes = static_cast<uint32_t>(material.name.size());
        out.put(material.colour);
        out.put(uint32_t{material.isTranslucent ? 1u : 0u});
        out.put(nameOffset);
        out.put(nameBytes);
        nameOffset += nameBytes;
    }
    for (const MaterialRecord& material : materials) {
        out.putArray(std::span<const char>(material.name));
    }
    return out.take();
}

std::string parseMaterials(std::span<const std::byte> bytes, uint64_t count,
                           std::vector<MaterialRecord>& materials) {
    if (count > bytes.size() / kMaterialRecordBytes) return "cut short";
    const auto names = bytes.subspan(count * kMaterialRecordBytes);
    ByteReader in(bytes);
    materials.resize(count);
    uint64_t next = 0;
    for (MaterialRecord& material : materials) {
        material.colour = in.get<uint32_t>();
        const auto flags = in.get<uint32_t>();
        const auto nameOffset = in.get<uint32_t>();
        const auto nameBytes = in.get<uint32_t>();
        if (flags > 1) return "unknown material flags";
        material.isTranslucent = flags != 0;
        if (!takeName(names, nameOffset, nameBytes, next, material.name).empty()) {
            return "a name reaches beyond the table";
        }
    }
    return next == names.size() ? std::string{} : "names do not fill the table";
}

}  // namespace pagoda::ooc
