#include "ooc/readers/off_reader.h"

#include "ooc/readers/indexed_faces.h"
#include "ooc/readers/off_vertices.h"
#include "ooc/readers/source_file.h"
#include "ooc/readers/text_scan.h"
#include "ooc/readers/text_stream.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace pagoda::ooc {
namespace {

// What the first word says of the vertices: [ST][C][N]OFF. 4OFF and nOFF have other dimensions.
struct OffHeader {
    bool hasTexture = false, hasColours = false, hasNormals = false;
    uint64_t vertices = 0, faces = 0;
};

// Lines without comments, blank ones left out.
class OffLines {
public:
    OffLines(const SourceFile& source, ProgressMeter* meter, uint64_t offset, uint64_t line)
        : text_(source, meter, offset, line) {}

    TextCursor next(const char* wanted) {
        std::string_view line;
        while (text_.next(line)) {
            TextCursor cursor(line.substr(0, line.find('#')));
            if (!cursor.atEnd()) return cursor;
        }
        text_.source().failCutShort(
            "line " + std::to_string(std::max<uint64_t>(1, text_.lineNumber())),
            std::string("the file ends among the ") + wanted);
    }
    [[nodiscard]] const TextStream& text() const { return text_; }

private:
    TextStream text_;
};

class OffReader final : public Reader {
public:
    OffReader(const std::filesystem::path& path, const ReaderOptions& options)
        : source_(SourceFile::openText(path, options.scratchFolder)),
          scratchFolder_(options.scratchFolder) {
        parseHeader();
    }

    void read(TriangleSink& sink) override;

private:
    void parseHeader();
    void parseKind(std::string_view kind);
    void loadVertices(ProgressMeter& meter);
    void readFaces(TriangleSink& sink, ProgressMeter& meter);
    void readFace(IndexedFaces<OffVertices>& faces, TextCursor& cursor, uint64_t line);

    SourceFile source_;
    std::filesystem::path scratchFolder_;
    OffHeader header_;
    uint64_t dataOffset_ = 0, dataLine_ = 0, facesOffset_ = 0, facesLine_ = 0;
    std::optional<OffVertices> vertices_;
    std::vector<uint64_t> corners_;
    bool facesHaveColours_ = false;
    uint64_t fannedPolygons_ = 0, lateColours_ = 0;
};

void OffReader::parseKind(std::string_view kind) {
    if (kind.starts_with("ST")) {
        header_.hasTexture = true;
        kind.remove_prefix(2);
    }
    if (kind.starts_with('C')) {
        header_.hasColours = true;
        kind.remove_prefix(1);
    }
    if (kind.starts_with('N')) {
        header_.hasNormals = true;
        kind.remove_prefix(1);
    }
    if (!kind.empty()) {
        source_.failAtLine(1, "OFF of the kind \"" + printable(kind) + "\" is not read",
                           "write it as OFF, COFF or NOFF in three dimensions");
    }
}

// "OFF", then the counts: on the same line, glued to it or on the next.
void OffReader::parseHeader() {
    OffLines lines(source_, nullptr, 0, 1);
    TextCursor cursor = lines.next("header lines");
    TextCursor ahead = cursor;
    const std::string_view first = ahead.word();
    const size_t kindEnd = first.find("OFF");
    if (kindEnd != first.npos) {
        parseKind(first.substr(0, kindEnd));
        cursor.at = first.data() + kindEnd + 3;
        if (TextCursor binary = cursor; equalsIgnoringCase(binary.word(), "binary")) {
            source_.failAtLine(lines.text().lineNumber(), "binary OFF is not read",
                               "write it as text, or as PLY");
        }
        if (cursor.atEnd()) cursor = lines.next("header lines");
    }
    const uint64_t line = lines.text().lineNumber();
    if (!parseCount(cursor.word(), header_.vertices) || !parseCount(cursor.word(), header_.faces)) {
        source_.failAtLine(line,
                           kindEnd == first.npos ? "does not begin with \"OFF\""
                                                 : "the numbers of vertices and faces are "
                                                   "missing",
                           "check that it is an OFF file");
    }
    dataOffset_ = lines.text().offset();
    dataLine_ = lines.text().nextLineNumber();
    // Three digits and their separators a vertex, one and its a face.
    const uint64_t left = source_.sizeBytes() - dataOffset_ + 1;
    if (header_.vertices > left / 6 || header_.faces > (left - 6 * header_.vertices) / 2) {
        source_.failAtLine(line,
                           "the header announces " + std::to_string(header_.vertices) +
                               " vertices and " + std::to_string(header_.faces) +
                               " faces, more than the file can hold",
                           "file cut short? copy or download it again");
    }
}

void OffReader::loadVertices(ProgressMeter& meter) {
    OffVertices vertices(scratchFolder_, header_.hasColours, header_.hasNormals);
    OffLines lines(source_, &meter, dataOffset_, dataLine_);
    for (uint64_t k = 0; k < header_.vertices; ++k) {
        TextCursor cursor = lines.next("vertices");
        if (!vertices.add(cursor)) {
            source_.failAtLine(lines.text().lineNumber(),
                               "vertex without three coordinates that are numbers",
                               "check the number of vertices in the header");
        }
    }
    vertices.finish();
    facesOffset_ = lines.text().offset();
    facesLine_ = lines.text().nextLineNumber();
    vertices_.emplace(std::move(vertices));
    if (header_.faces == 0) return;
    // Whether faces have colours shows only where they stand: the first speaks for all.
    TextCursor face = lines.next("faces");
    uint64_t corners = 0;
    if (!parseCount(face.word(), corners) || corners > kMaxCutCorners) return;
    for (uint64_t k = 0; k < corners; ++k) (void)face.word();
    facesHaveColours_ = offColour(face).has_value();
}

void OffReader::read(TriangleSink& sink) {
    source_.checkUnchanged();
    ProgressMeter meter(sink, 1);
    if (!vertices_) loadVertices(meter);
    if (header_.faces > 0) readFaces(sink, meter);
    source_.checkUnchanged();
    if (header_.hasTexture) sink.ignored("texture coordinates", header_.vertices);
}

void OffReader::readFaces(TriangleSink& sink, ProgressMeter& meter) {
    const bool hasColours = header_.hasColours || facesHaveColours_;
    IndexedFaces<OffVertices> faces(*vertices_, sink, hasColours, header_.hasNormals);
    lateColours_ = 0;
    OffLines lines(source_, &meter, facesOffset_, facesLine_);
    fannedPolygons_ = 0;
    for (uint64_t k = 0; k < header_.faces; ++k) {
        TextCursor cursor = lines.next("faces");
        readFace(faces, cursor, lines.text().lineNumber());
    }
    faces.finish();
    if (lateColours_ > 0) {
        sink.ignored("colour of a face where the first face has none", lateColours_);
    }
    if (fannedPolygons_ > 0) {
        sink.ignored("concavity of a polygon of more than 1024 corners", fannedPolygons_);
    }
}

void OffReader::readFace(IndexedFaces<OffVertices>& faces, TextCursor& cursor, uint64_t line) {
    uint64_t count = 0;
    if (!parseCount(cursor.word(), count)) {
        source_.failAtLine(line, "face without a number of corners",
                           "check the numbers in the header");
    }
    const auto corner = [&] {
        int64_t index = 0;
        if (!cursor.integer(index)) {
            source_.failAtLine(line, "face with fewer corners than it announces",
                               "file cut short? copy or download it again");
        }
        return static_cast<uint64_t>(index);  // negative ones are out of range
    };
    corners_.clear();
    if (count > kMaxCutCorners) {  // as it streams: its colour, behind it, is not known
        ++fannedPolygons_;
        faces.setFaceColour(std::nullopt);
        const uint64_t first = corner();
        uint64_t last = corner();
        for (uint64_t k = 2; k < count; ++k) {
            const uint64_t next = corner();
            faces.triangle(first, last, next);
            last = next;
        }
        return;
    }
    for (uint64_t k = 0; k < count; ++k) corners_.push_back(corner());
    const std::optional<uint32_t> colour = offColour(cursor);
    if (colour && !facesHaveColours_) ++lateColours_;
    faces.setFaceColour(facesHaveColours_ ? colour : std::nullopt);
    faces.face(corners_);
}

}  // namespace

std::unique_ptr<Reader> openOffReader(const std::filesystem::path& path,
                                      const ReaderOptions& options) {
    return std::make_unique<OffReader>(path, options);
}

}  // namespace pagoda::ooc
