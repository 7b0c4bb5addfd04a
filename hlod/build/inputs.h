// inputs.h: what the user names as input, and the one stream of triangles made of it.
#pragma once

#include "ooc/readers/reader.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace pagoda::hlod {

// One file and how it is placed: model = matrix * (unit * turned to the database's up axis).
struct InputSpec {
    std::filesystem::path path;
    ooc::UpAxis up = ooc::UpAxis::Unknown;  // Unknown: as the format says, else as the database
    double unit = 1.0;                      // factor from the file's units to the database's
    glm::dmat4 transform{1.0};
    bool isTransformed = false;  // transform is not the identity
};

// "model.ply", "folder", "scans/*.ply", each with an optional suffix "@up=z,unit=0.001,move=1:2:3,
// matrix=16 numbers by row, separated by ':'" (unit also mm, cm, m, km, in, ft). Folders give the
// files of known formats in them and below. The result is sorted by path; doubles are kept.
// Throws Error for what does not exist, a folder without models, an unknown option.
[[nodiscard]] std::vector<InputSpec> expandInputs(const std::vector<std::string>& arguments);

// All inputs as one: turns, scales and places the triangles of each, numbers objects and materials
// through, and hangs each file's objects under one object with the file's name when there are
// several.
class InputSet {
public:
    InputSet(std::vector<InputSpec> specs, const ooc::ReaderOptions& options,
             ooc::UpAxis databaseUp);

    // The same calls in the same order every time. Progress in bytes of the files.
    void read(ooc::TriangleSink& sink);
    // SampledReader::sample(), placed; of a single input alone.
    [[nodiscard]] bool sample(ooc::TriangleSink& sink, uint64_t triangles,
                              const std::function<bool()>& isEnough);
    // Of all readers, after read(): CompanionReader::companions().
    [[nodiscard]] std::vector<std::filesystem::path> companions() const;

    [[nodiscard]] uint64_t totalBytes() const noexcept { return totalBytes_; }
    [[nodiscard]] ooc::UpAxis databaseUp() const noexcept { return databaseUp_; }

    struct Source {
        std::string name, format, attribution;
        ooc::UpAxis up = ooc::UpAxis::Unknown;
        double unit = 1.0;
        glm::dmat4 transform{1.0};
        uint64_t trianglesIn = 0;  // delivered and dropped, after read()
    };
    [[nodiscard]] const std::vector<Source>& sources() const noexcept { return sources_; }
    // Which source an object came from, after read().
    [[nodiscard]] uint32_t sourceOfObject(uint32_t object) const;

private:
    struct Entry {
        InputSpec spec;
        std::unique_ptr<ooc::Reader> reader;
        glm::dmat4 placement{1.0};
        bool isPlaced = false;
    };
    std::vector<Entry> entries_;
    std::vector<Source> sources_;
    std::vector<uint32_t> firstObject_;  // a source's first object id, after read()
    uint64_t totalBytes_ = 0;
    ooc::UpAxis databaseUp_;
};

}  // namespace pagoda::hlod
