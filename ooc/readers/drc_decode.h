// drc_decode.h: Draco streams (glTF's KHR_draco_mesh_compression and .drc files), decoded within
// bounds. Draco allocates what a stream announces: the announcement is read and judged first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace draco {
class Mesh;
class PointAttribute;
}  // namespace draco

namespace pagoda::ooc {

struct DracoAnnouncement {
    bool isMesh = false;
    uint64_t faces = 0, points = 0;  // of an edgebreaker mesh: points may grow at seams

    // What decoding takes: corner table, attributes and their copies, measured on edgebreaker.
    [[nodiscard]] uint64_t decodedBytes() const { return 160 * faces + 64 * points; }
};

// Reads a stream's header. Empty, with `problem` set, where that is no Draco stream.
[[nodiscard]] std::optional<DracoAnnouncement> dracoAnnouncement(std::span<const std::byte> bytes,
                                                                 std::string& problem);

// Decodes a mesh whose announcement the caller has judged. Null, with `problem` set, on failure.
// Faces name existing points.
[[nodiscard]] std::unique_ptr<draco::Mesh> decodeDracoMesh(std::span<const std::byte> bytes,
                                                           std::string& problem);

// Reads `components` numbers of point `point`; missing ones are 0. Whole numbers are divided by
// their type's maximum if `isNormalised`. False if the stream maps the point to nothing.
[[nodiscard]] bool readDracoValue(const draco::PointAttribute& attribute, uint32_t point,
                                  int components, bool isNormalised, double* out);

}  // namespace pagoda::ooc
