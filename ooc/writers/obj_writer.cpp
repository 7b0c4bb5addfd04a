// obj_writer.cpp: OBJ with its material library beside it.
// Vertices, normals and faces follow each other batch by batch; an object that comes back later
// repeats its `o` line. OBJ knows no hierarchy: parents are left out.
#include "ooc/base/error.h"
#include "ooc/writers/corner_welder.h"
#include "ooc/writers/float_exact.h"
#include "ooc/writers/target_file.h"
#include "ooc/writers/writer_kinds.h"

#include <fmt/format.h>

#include <iterator>
#include <set>
#include <string>

namespace pagoda::ooc {
namespace {

constexpr uint32_t kNone = UINT32_MAX;

std::filesystem::path libraryPath(std::filesystem::path target) {
    return target.replace_extension(".mtl");
}

double channel(uint32_t colour, int index) {
    return ((colour >> (8 * index)) & 255u) / 255.0;
}

// One line, no control characters, nothing at the ends that a reader would trim.
std::string lineName(const std::string& name, const char* kind, size_t number) {
    std::string clean;
    for (const char letter : name) {
        clean += static_cast<unsigned char>(letter) < 32 || letter == 127 ? '_' : letter;
    }
    const size_t begin = clean.find_first_not_of(' ');
    if (begin == std::string::npos) return fmt::format("{}_{}", kind, number);
    clean = clean.substr(begin, clean.find_last_not_of(' ') - begin + 1);
    // A backslash at the end would join the next line to this one, '#' begin a comment.
    for (char& letter : clean) {
        if (letter == '\\' || letter == '#') letter = '_';
    }
    return clean;
}

class ObjWriter final : public MeshWriter {
public:
    ObjWriter(const std::filesystem::path& target, bool force)
        : file_(target, force), library_(libraryPath(target), force) {
        text_ = fmt::format("# written by Pagoda\nmtllib {}\n",
                            libraryPath(target).filename().string());
        library_.append("# written by Pagoda\n");
    }

    uint32_t addObject(const ObjectInfo& object) override {
        objectNames_.push_back(lineName(object.name, "object", objectNames_.size()));
        return static_cast<uint32_t>(objectNames_.size() - 1);
    }

    uint32_t addMaterial(const MaterialInfo& material) override {
        const size_t number = materialNames_.size();
        std::string name = lineName(material.name, "material", number);
        for (char& letter : name) {
            if (letter == ' ') letter = '_';
        }
        if (!usedNames_.insert(name).second) {
            name += fmt::format("_{}", number);
            usedNames_.insert(name);
        }
        // A translucent material says so by its dissolve alone.
        double dissolve = channel(material.colour, 3);
        if (material.isTranslucent && dissolve == 1.0) dissolve = 254 / 255.0;
        library_.append(fmt::format("newmtl {}\nKd {:.6g} {:.6g} {:.6g}\nd {:.6g}\n", name,
                                    channel(material.colour, 0), channel(material.colour, 1),
                                    channel(material.colour, 2), dissolve));
        materialNames_.push_back(std::move(name));
        return static_cast<uint32_t>(number);
    }

    void addTriangles(const TriangleBatch& batch) override {
        welder_.weld(batch);
        nameGroup(batch);
        writeVertices(batch);
        writeFaces(!batch.normals.empty());
        vertexCount_ += welder_.vertices().size();
        if (!batch.normals.empty()) normalCount_ += welder_.vertices().size();
        file_.append(text_);
        text_.clear();
    }

    uint64_t finish() override {
        file_.append(text_);
        const uint64_t libraryBytes = library_.publish();
        return libraryBytes + file_.publish();
    }

private:
    void nameGroup(const TriangleBatch& batch) {
        if (batch.object != object_ && batch.object < objectNames_.size()) {
            text_ += fmt::format("o {}\n", objectNames_[batch.object]);
            object_ = batch.object;
        }
        if (batch.material != material_ && batch.material < materialNames_.size()) {
            text_ += fmt::format("usemtl {}\n", materialNames_[batch.material]);
            material_ = batch.material;
        }
    }

    void writeVertices(const TriangleBatch& batch) {
        auto out = std::back_inserter(text_);
        for (const uint32_t corner : welder_.vertices()) {
            const Vec3d position = batch.positions[corner] + 0.0;  // no -0
            out = fmt::format_to(out, "v ");
            for (int axis = 0; axis < 3; ++axis) {
                // A coordinate that is a float needs the digits of a float only.
                const float single = static_cast<float>(position[axis]);
                const char* after = axis < 2 ? " " : "";
                out = isFloatExact(position[axis])
                          ? fmt::format_to(out, "{}{}", single, after)
                          : fmt::format_to(out, "{}{}", position[axis], after);
            }
            if (!batch.colours.empty()) {
                const uint32_t colour = batch.colours[corner];
                out = fmt::format_to(out, " {:.6g} {:.6g} {:.6g}", channel(colour, 0),
                                     channel(colour, 1), channel(colour, 2));
            }
            text_ += '\n';
        }
        if (batch.normals.empty()) return;
        for (const uint32_t corner : welder_.vertices()) {
            const Vec3f normal = batch.normals[corner] + 0.0f;
            out = fmt::format_to(out, "vn {:.5g} {:.5g} {:.5g}\n", normal.x, normal.y, normal.z);
        }
    }

    void writeFaces(bool hasNormals) {
        auto out = std::back_inserter(text_);
        const std::span<const uint32_t> indices = welder_.indices();
        for (size_t i = 0; i < indices.size(); ++i) {
            if (i % 3 == 0) text_ += 'f';
            out = fmt::format_to(out, " {}", vertexCount_ + indices[i] + 1);
            if (hasNormals) out = fmt::format_to(out, "//{}", normalCount_ + indices[i] + 1);
            if (i % 3 == 2) text_ += '\n';
        }
    }

    TargetFile file_, library_;
    CornerWelder welder_;
    std::string text_;
    std::vector<std::string> objectNames_, materialNames_;
    std::set<std::string> usedNames_;
    uint32_t object_ = kNone, material_ = kNone;
    uint64_t vertexCount_ = 0, normalCount_ = 0;
};

}  // namespace

std::unique_ptr<MeshWriter> createObjWriter(const std::filesystem::path& target, bool force) {
    return std::make_unique<ObjWriter>(target, force);
}

}  // namespace pagoda::ooc
