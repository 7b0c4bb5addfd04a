#include "ooc/readers/stl_reader.h"

#include "ooc/readers/read_ahead.h"
#include "ooc/readers/reader_extras.h"
#include "ooc/readers/scattered_order.h"
#include "ooc/readers/source_file.h"
#include "ooc/readers/text_scan.h"
#include "ooc/readers/text_stream.h"
#include "ooc/readers/triangle_batcher.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace pagoda::ooc {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is read as it lies");

constexpr uint64_t kHeaderBytes = 84;  // 80 of any text, then the number of facets
constexpr uint64_t kFacetBytes = 50;   // normal, three corners, two bytes of attribute

// Facet normals are not handed on: they say no more than the corners do.
class BinaryStlReader final : public Reader, public SampledReader {
public:
    BinaryStlReader(SourceFile source, uint64_t facets, bool isCountWrong)
        : source_(std::move(source)), facets_(facets), isCountWrong_(isCountWrong) {}

    void read(TriangleSink& sink) override {
        source_.checkUnchanged();
        if (facets_ > 0) readFacets(sink);
        if (isCountWrong_) sink.ignored("wrong number of facets in the header", 1);
        const uint64_t end = kHeaderBytes + facets_ * kFacetBytes;
        if (end < source_.sizeBytes()) {
            sink.ignored("bytes behind the last facet", source_.sizeBytes() - end);
        }
    }
    [[nodiscard]] uint64_t announcedTriangles() const override { return facets_; }
    [[nodiscard]] bool sample(TriangleSink& sink, uint64_t triangles,
                              const std::function<bool()>& isEnough) override;

private:
    void readFacets(TriangleSink& sink) {
        ProgressMeter meter(sink, 1);
        TriangleBatcher batcher(sink, false, false);
        batcher.setTarget(sink.addObject({}), sink.addMaterial({}));
        InputStream stream(source_, &meter);
        stream.seek(kHeaderBytes);
        uint64_t attributes = 0;
        for (uint64_t left = facets_; left > 0;) {
            const std::span<const std::byte> block = stream.ahead(kFacetBytes);
            if (block.size() < kFacetBytes) {
                source_.failCutShort("byte " + std::to_string(stream.offset()),
                                     "the data ends among the facets");
            }
            const uint64_t facets = std::min<uint64_t>(left, block.size() / kFacetBytes);
            for (uint64_t k = 0; k < facets; ++k) {
                attributes += addFacet(block.data() + k * kFacetBytes, batcher);
            }
            stream.take(facets * kFacetBytes);
            left -= facets;
        }
        source_.checkUnchanged();
        batcher.finish();
        if (attributes > 0) sink.ignored("attribute (colour) of a facet", attributes);
    }

    // Returns 1 if the facet has an attribute.
    static uint64_t addFacet(const std::byte* facet, TriangleBatcher& batcher) {
        Vec3f corners[3];
        uint16_t attribute = 0;
        std::memcpy(corners, facet + sizeof(Vec3f), sizeof corners);
        std::memcpy(&attribute, facet + 4 * sizeof(Vec3f), sizeof attribute);
        batcher.add(Vec3d(corners[0]), Vec3d(corners[1]), Vec3d(corners[2]));
        return attribute != 0 ? 1 : 0;
    }

    SourceFile source_;
    uint64_t facets_;
    bool isCountWrong_;
};

bool BinaryStlReader::sample(TriangleSink& sink, uint64_t triangles,
                             const std::function<bool()>& isEnough) {
    if (facets_ == 0) return false;
    TriangleBatcher batcher(sink, false, false);
    batcher.setTarget(sink.addObject({}), sink.addMaterial({}));
    std::vector<std::byte> block;
    readAhead(source_.file());
    BlockSample order(facets_, kFacetBytes);
    BlockSample::Visit visit;
    for (uint64_t taken = 0; taken < triangles && order.next(visit) && !isEnough();) {
        block.resize(visit.rows * kFacetBytes);
        source_.file().readAt(kHeaderBytes + visit.firstRow * kFacetBytes, block);
        for (uint64_t k = visit.phase; k < visit.rows; k += visit.stride, ++taken) {
            addFacet(block.data() + k * kFacetBytes, batcher);
        }
    }
    batcher.finish();
    return true;
}

// Keywords in any case and on any line; each solid is an object.
class TextStlReader final : public Reader {
public:
    explicit TextStlReader(SourceFile source) : source_(std::move(source)) {}

    void read(TriangleSink& sink) override;

private:
    struct State {
        State(const SourceFile& source, TriangleSink& to)
            : sink(to), meter(to, 1), text(source, &meter), batcher(to, false, false) {}

        TriangleSink& sink;
        ProgressMeter meter;
        TextStream text;
        TriangleBatcher batcher;
        std::vector<Vec3d> corners;  // of the facet
        bool isInFacet = false, isInSolid = false, hasSolid = false;
        uint64_t strayWords = 0;
    };
    void readLine(State& state, TextCursor cursor) const;
    static void beginSolid(State& state, std::string name);
    static void endFacet(State& state);

    SourceFile source_;
};

void TextStlReader::read(TriangleSink& sink) {
    source_.checkUnchanged();
    State state(source_, sink);
    sink.addMaterial({});
    std::string_view line;
    while (state.text.next(line)) readLine(state, TextCursor(line));
    if (state.isInFacet) {
        source_.failCutShort("line " + std::to_string(state.text.lineNumber()),
                             "the text ends in the middle of a facet");
    }
    source_.checkUnchanged();
    state.batcher.finish();
    if (state.isInSolid) sink.ignored("missing endsolid", 1);
    if (state.strayWords > 0) sink.ignored("words that mean nothing", state.strayWords);
}

void TextStlReader::readLine(State& state, TextCursor cursor) const {
    while (!cursor.atEnd()) {
        const std::string_view word = cursor.word();
        if (equalsIgnoringCase(word, "vertex")) {
            Vec3d corner;
            if (!cursor.number(corner.x) || !cursor.number(corner.y) || !cursor.number(corner.z)) {
                source_.failAtLine(state.text.lineNumber(),
                                   "vertex without three coordinates that are numbers",
                                   "file cut short? copy or download it again");
            }
            if (!state.isInFacet) {
                source_.failAtLine(state.text.lineNumber(), "vertex outside of a facet");
            }
            state.corners.push_back(corner);
            if (state.corners.size() > kBatchTriangles) {
                source_.failAtLine(state.text.lineNumber(), "a facet of more than 2048 corners");
            }
        } else if (equalsIgnoringCase(word, "facet")) {
            if (state.isInFacet) endFacet(state);        // no endfacet
            if (!state.hasSolid) beginSolid(state, {});  // no word "solid" by itself
            state.isInFacet = true;
            TextCursor ahead = cursor;
            if (equalsIgnoringCase(ahead.word(), "normal")) {
                for (int k = 0; k < 3; ++k) (void)ahead.word();
                cursor = ahead;
            }
        } else if (equalsIgnoringCase(word, "endfacet")) {
            endFacet(state);
        } else if (equalsIgnoringCase(word, "solid")) {
            state.isInSolid = true;
            beginSolid(state, toUtf8(cursor.rest()));
        } else if (equalsIgnoringCase(word, "endsolid")) {
            state.isInSolid = false;
            (void)cursor.rest();
        } else if (!equalsIgnoringCase(word, "outer") && !equalsIgnoringCase(word, "loop") &&
                   !equalsIgnoringCase(word, "endloop")) {
            ++state.strayWords;
        }
    }
}

void TextStlReader::beginSolid(State& state, std::string name) {
    state.hasSolid = true;
    state.batcher.setTarget(state.sink.addObject({std::move(name), ObjectInfo::kNoParent}), 0);
}

void TextStlReader::endFacet(State& state) {
    const std::vector<Vec3d>& corners = state.corners;
    if (corners.size() < 3) state.batcher.drop(DropReason::TooFewCorners);
    for (size_t k = 2; k < corners.size(); ++k) {
        state.batcher.add(corners[0], corners[k - 1], corners[k]);
    }
    state.corners.clear();
    state.isInFacet = false;
}

// Begins like text, and has none of the zeros that binary data is full of.
bool looksLikeText(std::span<const std::byte> start) {
    TextCursor cursor({reinterpret_cast<const char*>(start.data()), start.size()});
    constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";
    if (std::string_view(cursor.at, start.size()).starts_with(kUtf8Mark)) cursor.at += 3;
    while (cursor.at != cursor.end && (isBlank(*cursor.at) || *cursor.at == '\n')) ++cursor.at;
    constexpr std::string_view kSolid = "solid";
    if (cursor.end - cursor.at < static_cast<ptrdiff_t>(kSolid.size())) return false;
    return equalsIgnoringCase({cursor.at, kSolid.size()}, kSolid) &&
           std::ranges::find(start, std::byte{0}) == start.end();
}

}  // namespace

// The size decides: many binary files begin with "solid". Then the text; then what is left can only
// be binary with a wrong count or cut short.
std::unique_ptr<Reader> openStlReader(const std::filesystem::path& path, const ReaderOptions&) {
    SourceFile source(path);
    std::array<std::byte, 1024> start{};
    const size_t got = source.file().readSomeAt(0, start);
    uint32_t facets = 0;
    std::memcpy(&facets, start.data() + kHeaderBytes - sizeof facets, sizeof facets);
    const bool hasHeader = source.sizeBytes() >= kHeaderBytes;
    const uint64_t size = source.sizeBytes();
    if (hasHeader && size == kHeaderBytes + facets * kFacetBytes) {
        return std::make_unique<BinaryStlReader>(std::move(source), facets, false);
    }
    if (looksLikeText(std::span(start).first(got))) {
        return std::make_unique<TextStlReader>(std::move(source));
    }
    if (!hasHeader) {
        source.failAtByte(size, "neither text that begins with \"solid\" nor a binary header",
                          "check that it is an STL file and was copied whole");
    }
    const uint64_t present = (size - kHeaderBytes) / kFacetBytes;
    const bool isCountUnset = facets == 0 || facets == UINT32_MAX;  // writers that stream
    if (isCountUnset && (size - kHeaderBytes) % kFacetBytes == 0) {
        return std::make_unique<BinaryStlReader>(std::move(source), present, true);
    }
    if (present < facets) {
        source.failCutShort("byte " + std::to_string(size),
                            "the header announces " + std::to_string(facets) +
                                " facets, the file holds " + std::to_string(present));
    }
    return std::make_unique<BinaryStlReader>(std::move(source), facets, false);
}

}  // namespace pagoda::ooc
