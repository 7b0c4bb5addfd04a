// What reader.h promises of any file: either Error with path and problem, or batches that agree
// with themselves, twice the same.
#include "ooc/base/error.h"
#include "ooc/base/hash.h"
#include "ooc/readers/reader.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/targets.h"

#include <cmath>
#include <cstring>

namespace pagoda::fuzz {
namespace {

// A small file may ask for many triangles (instances); more than this only costs time here.
constexpr uint64_t kMaxTriangles = 1u << 18;
constexpr uint64_t kMemoryBytes = 64u << 20;

class EnoughSeen {};

// Checks every call and keeps a fingerprint of all of them.
class CheckingSink final : public ooc::TriangleSink {
public:
    uint32_t addObject(const ooc::ObjectInfo& object) override {
        require(object.parent == ooc::ObjectInfo::kNoParent || object.parent < objectCount_,
                "an object's parent comes before it");
        mix(std::as_bytes(std::span(object.name)));
        mixValue(object.parent);
        return objectCount_++;
    }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override {
        mix(std::as_bytes(std::span(material.name)));
        mixValue(material.colour);
        mixValue(uint32_t{material.isTranslucent ? 1u : 0u});
        return materialCount_++;
    }
    void addTriangles(const ooc::TriangleBatch& batch) override {
        require(!batch.positions.empty(), "a batch is never empty");
        require(batch.positions.size() % 3 == 0, "a batch holds whole triangles");
        require(batch.colours.empty() || batch.colours.size() == batch.positions.size(),
                "a colour a corner or none");
        require(batch.normals.empty() || batch.normals.size() == batch.positions.size(),
                "a normal a corner or none");
        require(batch.object < objectCount_, "a batch's object was added before");
        require(batch.material < materialCount_, "a batch's material was added before");
        for (const Vec3d& position : batch.positions) {
            require(
                std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z),
                "positions are finite");
        }
        mix(std::as_bytes(std::span(batch.positions)));
        mix(std::as_bytes(std::span(batch.colours)));
        mix(std::as_bytes(std::span(batch.normals)));
        mixValue(batch.object);
        mixValue(batch.material);
        triangleCount_ += batch.triangleCount();
        if (triangleCount_ > kMaxTriangles) throw EnoughSeen();
    }
    void dropped(ooc::DropReason reason, uint64_t triangleCount) override {
        require(reason < ooc::DropReason::Count, "a reason is one of the list");
        mixValue(static_cast<uint32_t>(reason));
        mixValue(triangleCount);
    }
    void ignored(std::string_view what, uint64_t count) override {
        require(!what.empty(), "what is ignored has a name");
        mix(std::as_bytes(std::span(what)));
        mixValue(count);
    }
    void advance(uint64_t) override {}

    [[nodiscard]] uint64_t fingerprint() const { return fingerprint_; }

private:
    void mix(std::span<const std::byte> bytes) { fingerprint_ = hash64(bytes, fingerprint_); }
    template <typename Value>
    void mixValue(Value value) {
        mix(std::as_bytes(std::span(&value, 1)));
    }

    uint32_t objectCount_ = 0, materialCount_ = 0;
    uint64_t triangleCount_ = 0, fingerprint_ = 0;
};

// The fingerprint of all calls of one pass.
uint64_t passOver(ooc::Reader& reader) {
    CheckingSink sink;
    reader.read(sink);
    return sink.fingerprint();
}

void readAs(std::span<const std::byte> input, std::string_view extension) {
    const std::filesystem::path path = writeInput(input, extension);
    try {
        const auto reader = ooc::openReader(path, {.scratchFolder = inputFolder(),
                                                   .memoryBytes = kMemoryBytes,
                                                   .maxTriangles = kMaxTriangles});
        const uint64_t first = passOver(*reader);
        require(passOver(*reader) == first, "a second read() makes the same calls");
    } catch (const Error& error) {
        require(!error.path().empty() && !error.problem().empty(), "an error has path and problem");
    } catch (const EnoughSeen&) {
        return;  // nobody reads on after a sink has thrown
    }
}

}  // namespace

void readPly(std::span<const std::byte> input) {
    readAs(input, ".ply");
}
void readObj(std::span<const std::byte> input) {
    readAs(input, ".obj");
}
void readStl(std::span<const std::byte> input) {
    readAs(input, ".stl");
}
void readOff(std::span<const std::byte> input) {
    readAs(input, ".off");
}
void readDrc(std::span<const std::byte> input) {
    readAs(input, ".drc");
}

void readGltf(std::span<const std::byte> input) {
    const bool isBinary = input.size() >= 4 && std::memcmp(input.data(), "glTF", 4) == 0;
    readAs(input, isBinary ? ".glb" : ".gltf");
}

}  // namespace pagoda::fuzz
