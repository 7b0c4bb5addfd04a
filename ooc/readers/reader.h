// reader.h: a file of triangles as a stream of batches.
// A reader turns one file into objects, materials and triangle batches, in file order. It is the
// only code that knows the file's format; nothing behind it does. docs/build.md, step 1.
//
// Counting: every triangle of the file (polygons as fans of n - 2, strips and fans expanded,
// instances multiplied) is either in a batch or in one dropped() call, so that
// delivered + dropped = triangles in the file. Degenerate triangles (zero area, repeated corners)
// are delivered as they are: the builder drops and counts them after snapping.
#pragma once

#include "ooc/base/box.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pagoda::ooc {

// Why input did not make it into the database. Names in reports: dropReasonName().
enum class DropReason : uint8_t {
    NonFinite,        // a coordinate is NaN or infinite
    IndexOutOfRange,  // a corner names a vertex that does not exist
    TooFewCorners,    // a face of 1 or 2 corners (counts as one triangle lost)
    Degenerate,       // zero area as given
    Sliver,           // longer than 4 lattice steps, but no area left after snapping
    Collapsed,        // smaller than the lattice resolves
    Count
};
[[nodiscard]] std::string_view dropReasonName(DropReason reason);

// A node of the file's hierarchy that holds triangles or other objects.
struct ObjectInfo {
    std::string name;             // UTF-8, may be empty
    uint32_t parent = kNoParent;  // id of an earlier object
    static constexpr uint32_t kNoParent = UINT32_MAX;
};

struct MaterialInfo {
    std::string name;
    uint32_t colour = 0xFFFFFFFFu;  // RGBA8, sRGB, red in the low byte; alpha is the opacity
    bool isTranslucent = false;     // drawn blended, never an occluder
};

// Triangles of one object and one material. Corners of triangle t are 3t, 3t+1, 3t+2,
// counter-clockwise from outside as the file says (mirrored instances already mended).
struct TriangleBatch {
    std::vector<Vec3d> positions;   // model units of the file, node transforms applied
    std::vector<uint32_t> colours;  // per corner RGBA8 sRGB with the material's colour (and its
                                    // texture) multiplied in; empty: the material's colour
    std::vector<Vec3f> normals;     // per corner, unit length; empty: none in the file
    uint32_t object = 0;
    uint32_t material = 0;

    [[nodiscard]] size_t triangleCount() const { return positions.size() / 3; }
    void clear() {  // keeps object, material and capacity
        positions.clear();
        colours.clear();
        normals.clear();
    }
};

// Batches are best at about this size: big enough to hide the call, small enough for the cache.
inline constexpr size_t kBatchTriangles = 2048;

// Receives what a reader finds. Ids count from 0 in order of the calls.
class TriangleSink {
public:
    virtual ~TriangleSink() = default;
    virtual uint32_t addObject(const ObjectInfo& object) = 0;
    virtual uint32_t addMaterial(const MaterialInfo& material) = 0;
    // The batch is the reader's, valid during the call. Never empty.
    virtual void addTriangles(const TriangleBatch& batch) = 0;
    virtual void dropped(DropReason reason, uint64_t triangleCount) = 0;
    // Something in the file that was ignored or mended without losing triangles (a missing
    // texture, an unknown extension): `what` is a short constant phrase, counted by phrase.
    virtual void ignored(std::string_view what, uint64_t count) = 0;
    // How far in the file the reader is, for progress; also the place to stop at Ctrl-C (throws).
    virtual void advance(uint64_t bytes) = 0;
};

enum class UpAxis : uint8_t { Unknown, Y, Z };

struct ReaderOptions {
    std::filesystem::path scratchFolder = std::filesystem::temp_directory_path();
    uint64_t memoryBytes = uint64_t{2} << 30;   // whole-file formats refuse beyond this
    uint64_t maxTriangles = uint64_t{1} << 33;  // after expansion of instances
};

class Reader {
public:
    virtual ~Reader() = default;
    // Streams the whole file into `sink`. May be called again: the same calls in the same order.
    // Throws Error where the file cannot be understood, or has changed since the first call.
    virtual void read(TriangleSink& sink) = 0;
    [[nodiscard]] virtual UpAxis upAxis() const { return UpAxis::Unknown; }
    // Who made it, as the file says (glTF asset.copyright); known after the first read().
    [[nodiscard]] virtual std::string attribution() const { return {}; }
    // Triangles after expansion where the header tells before reading; 0: not known.
    [[nodiscard]] virtual uint64_t announcedTriangles() const { return 0; }
};

// One row a format: how it is known and who reads it.
struct ReaderFormat {
    std::string_view name;                     // "PLY"
    std::vector<std::string_view> extensions;  // lower case with dot
    std::unique_ptr<Reader> (*open)(const std::filesystem::path&, const ReaderOptions&);
};
[[nodiscard]] const std::vector<ReaderFormat>& readerFormats();

// Picks by extension. Throws Error for an unknown one, naming a converter where the kind is known
// (IFC, STEP, LAS, ...).
[[nodiscard]] std::unique_ptr<Reader> openReader(const std::filesystem::path& path,
                                                 const ReaderOptions& options);

}  // namespace pagoda::ooc
