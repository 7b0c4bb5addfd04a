#include "ooc/readers/obj_reader.h"

#include "ooc/readers/obj_faces.h"
#include "ooc/readers/obj_lines.h"
#include "ooc/readers/obj_materials.h"
#include "ooc/readers/obj_vertices.h"
#include "ooc/readers/reader_extras.h"
#include "ooc/readers/source_file.h"

#include <array>
#include <optional>
#include <vector>

namespace pagoda::ooc {
namespace {

class ObjReader final : public Reader, public CompanionReader {
public:
    ObjReader(const std::filesystem::path& path, const ReaderOptions& options)
        : source_(SourceFile::openText(path, options.scratchFolder)),
          folder_(path.parent_path()),
          scratchFolder_(options.scratchFolder) {}

    void read(TriangleSink& sink) override {
        source_.checkUnchanged();
        const bool isFirst = !vertices_;
        ProgressMeter meter(sink, isFirst ? 2 : 1);
        if (isFirst) loadVertices(meter);
        readFaces(sink, meter);
        source_.checkUnchanged();
        sayWhatIsIgnored(sink);
    }

    [[nodiscard]] std::vector<std::filesystem::path> companions() const override {
        return {materials_.lookedAt().begin(), materials_.lookedAt().end()};
    }

private:
    // First sweep: what faces refer to, and the material libraries, which may come late.
    void loadVertices(ProgressMeter& meter);
    void readFaces(TriangleSink& sink, ProgressMeter& meter);
    void sayWhatIsIgnored(TriangleSink& sink) const;

    SourceFile source_;
    std::filesystem::path folder_, scratchFolder_;
    std::optional<ObjVertices> vertices_;
    ObjMaterials materials_;
    std::array<uint64_t, static_cast<size_t>(ObjKeyword::Unknown) + 1> lines_{};  // by keyword
};

void ObjReader::loadVertices(ProgressMeter& meter) {
    ObjVertices vertices(scratchFolder_);
    lines_.fill(0);
    materials_ = {};
    ObjLines lines(source_, &meter);
    ObjKeyword keyword{};
    TextCursor rest;
    while (lines.next(keyword, rest)) {
        ++lines_[static_cast<size_t>(keyword)];
        switch (keyword) {
            case ObjKeyword::Position:
                vertices.addPosition(rest);
                break;
            case ObjKeyword::Normal:
                vertices.addNormal(rest);
                break;
            case ObjKeyword::Face:
                vertices.lookAtFace(rest);
                break;
            case ObjKeyword::MaterialLibrary:
                materials_.addLibraries(folder_, rest.rest());
                break;
            default:
                break;
        }
    }
    vertices.finish();
    vertices_.emplace(std::move(vertices));
}

void ObjReader::readFaces(TriangleSink& sink, ProgressMeter& meter) {
    ObjFaces faces(*vertices_, materials_, sink);
    ObjLines lines(source_, &meter);
    ObjKeyword keyword{};
    TextCursor rest;
    uint64_t positions = 0, normals = 0;  // so far: faces count back from here
    while (lines.next(keyword, rest)) {
        switch (keyword) {
            case ObjKeyword::Position:
                ++positions;
                break;
            case ObjKeyword::Normal:
                ++normals;
                break;
            case ObjKeyword::Face:
                faces.face(rest, positions, normals);
                break;
            case ObjKeyword::Object:
                faces.setObject(rest.rest());
                break;
            case ObjKeyword::Group:
                faces.setGroup(rest.rest());
                break;
            case ObjKeyword::UseMaterial:
                faces.setMaterial(rest.rest());
                break;
            default:
                break;
        }
    }
    faces.finish();
}

void ObjReader::sayWhatIsIgnored(TriangleSink& sink) const {
    const auto say = [&](std::string_view what, uint64_t count) {
        if (count > 0) sink.ignored(what, count);
    };
    const auto count = [&](ObjKeyword keyword) { return lines_[static_cast<size_t>(keyword)]; };
    say("lines (l)", count(ObjKeyword::Line));
    say("points (p)", count(ObjKeyword::Point));
    say("free-form curves and surfaces", count(ObjKeyword::FreeForm));
    say("text lines with an unknown keyword", count(ObjKeyword::Unknown));
    say("vertex with a coordinate that is no number", vertices_->badPositions());
    say("missing material library", materials_.missingLibraries());
    say("full transparency of a material", materials_.invisibleMaterials());
}

}  // namespace

std::unique_ptr<Reader> openObjReader(const std::filesystem::path& path,
                                      const ReaderOptions& options) {
    return std::make_unique<ObjReader>(path, options);
}

}  // namespace pagoda::ooc
