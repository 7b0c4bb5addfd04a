// mesh_writer.h: triangles to a mesh file, streamed: memory does not grow with the mesh.
// Used by `pagoda extract` and `pagoda generate`. The kind follows the extension: .ply (binary
// little-endian, colours where there are any, no names), .obj (+ .mtl; objects as `o`, materials),
// .glb (objects as nodes, materials; doubles become float about a node translation), .stl (binary).
// A temporary file beside the target, renamed by finish(): a writer destroyed before that leaves
// nothing. One thread. Deterministic.
#pragma once

#include "ooc/readers/reader.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace pagoda::ooc {

class MeshWriter : public TriangleSink {
public:
    // Throws Error for an unknown extension, or when the target exists and not `force`.
    [[nodiscard]] static std::unique_ptr<MeshWriter> create(const std::filesystem::path& target,
                                                            bool force);
    // Completes and publishes the file. Returns its size in bytes.
    virtual uint64_t finish() = 0;

    // Of TriangleSink: a writer drops nothing and is never told of ignored things.
    void dropped(DropReason, uint64_t) override {}
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t) override {}
};

}  // namespace pagoda::ooc
