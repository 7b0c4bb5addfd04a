#include "ooc/readers/ply_reader.h"

#include "ooc/readers/ply_faces.h"
#include "ooc/readers/ply_header.h"
#include "ooc/readers/ply_sampler.h"
#include "ooc/readers/ply_values.h"
#include "ooc/readers/ply_vertices.h"
#include "ooc/readers/reader_extras.h"

#include <numeric>
#include <optional>
#include <vector>

namespace pagoda::ooc {
namespace {

class PlyReader final : public Reader, public SampledReader {
public:
    PlyReader(const std::filesystem::path& path, const ReaderOptions& options)
        : source_(path), header_(readPlyHeader(source_)), scratchFolder_(options.scratchFolder) {
        places_.resize(header_.elements.size() + 1);
        places_[0] = {header_.dataOffset, header_.dataLine};
    }

    void read(TriangleSink& sink) override;
    [[nodiscard]] bool sample(TriangleSink& sink, uint64_t triangles,
                              const std::function<bool()>& isEnough) override {
        const auto layout = findPlySampleLayout(source_, header_);
        if (layout) samplePly(source_, header_, *layout, sink, triangles, isEnough);
        return layout.has_value();
    }

private:
    // Where an element's data begins; known once all before it has been walked.
    struct Place {
        uint64_t offset = 0, line = 0;
    };

    enum class Role : uint8_t { Other, Vertices, Faces, Strips };
    [[nodiscard]] Role roleOf(const PlyElement& element) const;

    template <typename Visit>
    Place walk(size_t element, ProgressMeter* meter, Visit visit);
    Place loadVertices(size_t element, ProgressMeter& meter);
    Place readFaces(size_t element, PlyFaceReader& faces, ProgressMeter& meter);
    Place pass(size_t element, ProgressMeter* meter);
    void sayWhatIsIgnored(TriangleSink& sink) const;

    SourceFile source_;
    PlyHeader header_;
    std::filesystem::path scratchFolder_;
    std::vector<Place> places_;
    std::optional<PlyVertices> vertices_;
    // Of each element: ASCII lines with more values than the header announces. Kept between
    // readings, as the vertices are.
    std::vector<uint64_t> surplusLines_;
};

PlyReader::Role PlyReader::roleOf(const PlyElement& element) const {
    if (element.name == "vertex") return Role::Vertices;
    if (element.name == "face" && findPlyFaces(element)) return Role::Faces;
    if (element.name == "tristrips" && findPlyFaces(element)) return Role::Strips;
    return Role::Other;
}

// Calls visit(values) with the element's values to read; returns where the next one begins.
template <typename Visit>
PlyReader::Place PlyReader::walk(size_t element, ProgressMeter* meter, Visit visit) {
    const Place place = places_[element];
    if (header_.format == PlyFormat::Ascii) {
        TextStream stream(source_, meter, place.offset, place.line);
        PlyAsciiValues values(stream);
        visit(values);
        surplusLines_[element] = values.ignoredValues();
        return {stream.offset(), stream.nextLineNumber()};
    }
    InputStream stream(source_, meter);
    stream.seek(place.offset);
    PlyBinaryValues values(stream, header_.format);
    visit(values);
    return {stream.offset(), 0};
}

PlyReader::Place PlyReader::loadVertices(size_t element, ProgressMeter& meter) {
    vertices_.emplace(source_, header_.elements[element], header_.dataLine - 1, scratchFolder_);
    if (vertices_->isPlainCopy(header_.format)) {
        InputStream stream(source_, &meter);
        stream.seek(places_[element].offset);
        vertices_->loadPlain(stream);
        return {stream.offset(), 0};
    }
    return walk(element, &meter, [&](auto& values) { vertices_->load(values); });
}

PlyReader::Place PlyReader::readFaces(size_t index, PlyFaceReader& faces, ProgressMeter& meter) {
    const PlyElement& element = header_.elements[index];
    const PlyFaceLayout layout = *findPlyFaces(element);
    if (roleOf(element) == Role::Strips) {
        return walk(index, &meter,
                    [&](auto& values) { faces.readStrips(values, element, layout.cornerList); });
    }
    if (faces.isPlain(header_.format, element)) {
        InputStream stream(source_, &meter);
        stream.seek(places_[index].offset);
        faces.readPlainFaces(stream, header_.format, element, layout);
        return {stream.offset(), 0};
    }
    return walk(index, &meter, [&](auto& values) { faces.readFaces(values, element, layout); });
}

// Moves over an element that is not wanted.
PlyReader::Place PlyReader::pass(size_t index, ProgressMeter* meter) {
    const PlyElement& element = header_.elements[index];
    const Place place = places_[index];
    if (element.properties.empty() || element.count == 0) return place;
    if (header_.format != PlyFormat::Ascii && !element.hasLists()) {
        return {place.offset + element.count * element.leastBytes(), 0};  // the header was checked
    }
    return walk(index, meter, [&](auto& values) {
        for (uint64_t item = 0; item < element.count; ++item) skipItem(values, element);
    });
}

void PlyReader::read(TriangleSink& sink) {
    source_.checkUnchanged();
    ProgressMeter meter(sink, 1);
    const std::vector<PlyElement>& elements = header_.elements;
    surplusLines_.resize(elements.size());
    const auto vertexElement = header_.findElement("vertex");
    if (vertexElement && !vertices_) {
        for (size_t k = 0; k < *vertexElement; ++k) places_[k + 1] = pass(k, nullptr);
        places_[*vertexElement + 1] = loadVertices(*vertexElement, meter);
    }
    bool hasFaceColours = false, hasFaces = false;
    for (const PlyElement& element : elements) {
        const Role role = roleOf(element);
        if (element.count == 0) continue;
        hasFaces |= role == Role::Faces || role == Role::Strips;
        hasFaceColours |= role == Role::Faces && findPlyFaces(element)->colour.isComplete();
    }
    if (hasFaces && !vertices_) {
        source_.failAtLine(header_.dataLine - 1, "there are faces but no vertices",
                           "write the file again");
    }
    if (!hasFaces) return sayWhatIsIgnored(sink);

    PlyFaceReader faces(*vertices_, sink, hasFaceColours && !vertices_->hasColours());
    for (size_t k = 0; k < elements.size(); ++k) {
        if (k == *vertexElement) continue;  // its end is known
        const Role role = roleOf(elements[k]);
        const bool isWanted =
            (role == Role::Faces || role == Role::Strips) && elements[k].count > 0;
        places_[k + 1] = isWanted ? readFaces(k, faces, meter) : pass(k, &meter);
    }
    source_.checkUnchanged();
    faces.finish();
    sayWhatIsIgnored(sink);
}

void PlyReader::sayWhatIsIgnored(TriangleSink& sink) const {
    for (const PlyElement& element : header_.elements) {
        if (element.count == 0 || roleOf(element) != Role::Other) continue;
        if (element.name == "face" || element.name == "tristrips") {
            sink.ignored("faces without a list of vertices", element.count);
        } else {
            sink.ignored("elements that are no vertices, faces or strips", element.count);
        }
    }
    const uint64_t surplus =
        std::accumulate(surplusLines_.begin(), surplusLines_.end(), uint64_t{0});
    if (surplus > 0) sink.ignored("lines with more values than the header announces", surplus);
}

}  // namespace

std::unique_ptr<Reader> openPlyReader(const std::filesystem::path& path,
                                      const ReaderOptions& options) {
    return std::make_unique<PlyReader>(path, options);
}

}  // namespace pagoda::ooc
