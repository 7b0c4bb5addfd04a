#include "ooc/codecs/page_codec.h"

#include "ooc/base/bytes.h"
#include "ooc/codecs/draco_geometry.h"
#include "ooc/codecs/geometry.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace pagoda::ooc {
namespace {

constexpr uint32_t tag(const char (&name)[5]) {
    uint32_t value = 0;
    for (unsigned i = 0; i < 4; ++i) {
        value |= static_cast<uint32_t>(static_cast<unsigned char>(name[i])) << (8 * i);
    }
    return value;
}
constexpr uint32_t kMeshTag = tag("MESH");
constexpr uint32_t kZipperTag = tag("ZIPR");
// Reserved, written by nobody yet: CIDX (coarse index range), CLST (clusters of vdr/).

constexpr uint32_t kMaxSections = 4096;
constexpr size_t kSectionEntryBytes = 16;
constexpr size_t kRawRunBytes = 12;
constexpr size_t kLeastPackedRunBytes = 3;

struct Section {
    uint32_t tag = 0;
    Codec codec = Codec::Raw;
    std::vector<std::byte> bytes;
};

uint32_t zigzag(uint32_t difference) {
    return (difference << 1) ^ (0u - (difference >> 31));
}
uint32_t unzigzag(uint32_t value) {
    return (value >> 1) ^ (0u - (value & 1u));
}

void putRuns(const std::vector<MeshRun>& runs, Codec codec, ByteWriter& out) {
    MeshRun last;
    for (const MeshRun& run : runs) {
        if (codec == Codec::Raw) {
            out.put(run.triangleCount);
            out.put(run.object);
            out.put(run.material);
        } else {
            out.putVarint(run.triangleCount);
            out.putVarint(zigzag(run.object - last.object));
            out.putVarint(zigzag(run.material - last.material));
        }
        last = run;
    }
}

std::string getRuns(ByteReader& in, Codec codec, uint32_t runCount, std::vector<MeshRun>& runs) {
    const size_t least = codec == Codec::Raw ? kRawRunBytes : kLeastPackedRunBytes;
    if (uint64_t{runCount} * least > in.remaining()) return "runs cut short";
    runs.resize(runCount);
    MeshRun last;
    for (MeshRun& run : runs) {
        if (codec == Codec::Raw) {
            run.triangleCount = in.get<uint32_t>();
            run.object = in.get<uint32_t>();
            run.material = in.get<uint32_t>();
        } else {
            run.triangleCount = in.getVarint();
            run.object = last.object + unzigzag(in.getVarint());
            run.material = last.material + unzigzag(in.getVarint());
        }
        last = run;
    }
    return in.isOk() ? std::string{} : "runs cut short";
}

// Parts and runs tile the triangles, and no run crosses from one part into the next.
std::string checkRunsAndParts(const PageMesh& mesh) {
    uint64_t sum = 0;
    size_t part = 0;
    if (mesh.partStart[0] != 0) return "first part does not begin at triangle 0";
    for (size_t p = 0; p < kPageParts; ++p) {
        if (mesh.partStart[p] > mesh.partStart[p + 1]) return "parts out of order";
    }
    if (mesh.partStart[kPageParts] != mesh.triangleCount()) return "parts do not sum to the mesh";
    for (const MeshRun& run : mesh.runs) {
        if (run.triangleCount == 0) return "empty run";
        while (part < kPageParts && mesh.partStart[part + 1] <= sum) ++part;
        sum += run.triangleCount;
        if (part == kPageParts || sum > mesh.partStart[part + 1]) return "run crosses parts";
    }
    if (sum != mesh.triangleCount()) return "runs do not sum to the mesh";
    return {};
}

GeometryView viewOf(const PageMesh& mesh) {
    return {mesh.positions, mesh.colours, mesh.normals, mesh.indices};
}

Section encodeMesh(const PageMesh& mesh, Codec codec) {
    assert(checkRunsAndParts(mesh).empty());
    assert(checkIndices(mesh.indices, mesh.positions.size()).empty());
    assert(mesh.colours.empty() || mesh.colours.size() == mesh.positions.size());
    assert(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    ByteWriter out;
    out.put(mesh.constantColour);
    out.put(static_cast<uint32_t>(mesh.runs.size()));
    out.putArray(std::span<const uint32_t>(mesh.partStart));
    putRuns(mesh.runs, codec, out);
    if (codec != Codec::Draco) {
        encodeGeometry(viewOf(mesh), codec, out);
    } else if (!encodeDraco(viewOf(mesh), mesh.runs, out)) {
        return encodeMesh(mesh, Codec::Meshopt);
    }
    return {kMeshTag, codec, out.take()};
}

Section encodeZipper(const Zipper& zipper, Codec codec) {
    ByteWriter out;
    out.put(zipper.neighbour);
    encodeGeometry({zipper.positions, {}, {}, zipper.indices}, codec, out);
    return {kZipperTag, codec, out.take()};
}

std::string decodeMesh(std::span<const std::byte> bytes, Codec codec, PageMesh& mesh) {
    ByteReader in(bytes);
    mesh.constantColour = in.get<uint32_t>();
    const auto runCount = in.get<uint32_t>();
    in.getArray(std::span<uint32_t>(mesh.partStart));
    if (!in.isOk()) return "cut short";
    if (std::string fault = getRuns(in, codec, runCount, mesh.runs); !fault.empty()) return fault;
    Geometry geometry;
    std::string fault = codec == Codec::Draco ? decodeDraco(in, mesh.runs, geometry)
                                              : decodeGeometry(in, codec, geometry);
    if (!fault.empty()) return fault;
    if (in.remaining() != 0) return std::to_string(in.remaining()) + " bytes too many";
    mesh.positions = std::move(geometry.positions);
    mesh.colours = std::move(geometry.colours);
    mesh.normals = std::move(geometry.normals);
    mesh.indices = std::move(geometry.indices);
    return checkRunsAndParts(mesh);
}

std::string decodeZipper(std::span<const std::byte> bytes, Codec codec, Zipper& zipper) {
    ByteReader in(bytes);
    zipper.neighbour = in.get<uint64_t>();
    Geometry geometry;
    if (std::string fault = decodeGeometry(in, codec, geometry); !fault.empty()) return fault;
    if (in.remaining() != 0) return std::to_string(in.remaining()) + " bytes too many";
    if (!geometry.colours.empty() || !geometry.normals.empty()) return "attributes in a zipper";
    zipper.positions = std::move(geometry.positions);
    zipper.indices = std::move(geometry.indices);
    return {};
}

struct SectionEntry {
    uint32_t tag = 0, codec = 0, offset = 0, bytes = 0;
};

// The table of sections, which lie behind it one after the other and fill the page.
std::string readTable(std::span<const std::byte> page, std::vector<SectionEntry>& entries) {
    ByteReader in(page);
    const auto count = in.get<uint32_t>();
    if (!in.isOk() || count > kMaxSections || count * kSectionEntryBytes > in.remaining()) {
        return "section table cut short";
    }
    uint64_t next = sizeof(uint32_t) + count * kSectionEntryBytes;
    entries.resize(count);
    for (SectionEntry& entry : entries) {
        entry.tag = in.get<uint32_t>();
        entry.codec = in.get<uint32_t>();
        entry.offset = in.get<uint32_t>();
        entry.bytes = in.get<uint32_t>();
        if (entry.offset != next) return "sections leave a gap or overlap";
        next += entry.bytes;
    }
    if (next != page.size()) return "sections do not fill the page";
    return {};
}

std::string decodeSection(const SectionEntry& entry, std::span<const std::byte> bytes, Page& page,
                          bool& hasMesh) {
    if (entry.tag != kMeshTag && entry.tag != kZipperTag) return {};  // not ours to know
    if (entry.codec > static_cast<uint32_t>(Codec::Draco)) {
        return "unknown codec " + std::to_string(entry.codec);
    }
    const auto codec = static_cast<Codec>(entry.codec);
    if (entry.tag == kZipperTag) {
        if (codec == Codec::Draco) return "zipper section: no such codec for zippers";
        std::string fault = decodeZipper(bytes, codec, page.zippers.emplace_back());
        return fault.empty() ? fault : "zipper section: " + fault;
    }
    if (hasMesh) return "two mesh sections";
    hasMesh = true;
    std::string fault = decodeMesh(bytes, codec, page.mesh);
    return fault.empty() ? fault : "mesh section: " + fault;
}

}  // namespace

std::string_view codecName(Codec codec) {
    switch (codec) {
        case Codec::Raw:
            return "raw";
        case Codec::Meshopt:
            return "meshopt";
        case Codec::Draco:
            return "draco";
    }
    return "unknown";
}

std::optional<Codec> codecByName(std::string_view name) {
    for (const Codec codec : {Codec::Raw, Codec::Meshopt, Codec::Draco}) {
        if (name == codecName(codec)) return codec;
    }
    return std::nullopt;
}

std::vector<std::byte> encodePage(const Page& page, Codec codec) {
    const Codec simple = codec == Codec::Draco ? Codec::Meshopt : codec;  // zippers are small
    std::vector<Section> sections;
    sections.push_back(encodeMesh(page.mesh, codec));
    for (const Zipper& zipper : page.zippers) sections.push_back(encodeZipper(zipper, simple));
    assert(sections.size() <= kMaxSections);

    ByteWriter out;
    out.put(static_cast<uint32_t>(sections.size()));
    size_t offset = sizeof(uint32_t) + sections.size() * kSectionEntryBytes;
    for (const Section& section : sections) {
        out.put(section.tag);
        out.put(static_cast<uint32_t>(section.codec));
        out.put(static_cast<uint32_t>(offset));
        out.put(static_cast<uint32_t>(section.bytes.size()));
        offset += section.bytes.size();
    }
    for (const Section& section : sections) out.putBytes(section.bytes);
    return out.take();
}

DecodeResult decodePage(std::span<const std::byte> bytes) {
    std::vector<SectionEntry> entries;
    if (std::string fault = readTable(bytes, entries); !fault.empty()) return {{}, fault};
    DecodeResult result{.page = Page{}, .fault = {}};
    bool hasMesh = false;
    for (const SectionEntry& entry : entries) {
        result.fault =
            decodeSection(entry, bytes.subspan(entry.offset, entry.bytes), *result.page, hasMesh);
        if (!result.fault.empty()) return {{}, result.fault};
    }
    if (!hasMesh) return {{}, "no mesh section"};
    return result;
}

}  // namespace pagoda::ooc
