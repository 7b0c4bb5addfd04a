// mesh_writer.h: triangles to a mesh file, streamed: memory does not grow with the mesh.
// Used by `pagoda extract` and `pagoda generate`. The kind follows the extension: .ply (binary
// little-endian, colours where there are any, no names), .obj (+ .mtl; objects as `o`, materials),
// .glb (objects as nodes, materials; doubles become float about a node translation), .stl (binary).
// A temporary file beside the target, renamed by finish(): a writer destroyed before that leaves
// nothing. One thread. Deterministic.
//
// Positions: .ply keeps them exactly (float while every coordinate is one, else double), .obj too
// (shortest digits), .glb to a float about the object's own translation, .stl to a float.
// Errors: Error when the format cannot hold the mesh (.glb beyond 4 GiB, .stl and .ply beyond
// 2^32), or the disk fails.
#pragma once

#include "ooc/readers/reader.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace pagoda::ooc {

class MeshWriter : public TriangleSink {
public:
    // Throws Error for an unknown extension, or when the target exists and not `force`.
    // `up`: glTF says y is up, so a .glb of a model whose z is up gets a turn in its root nodes;
    // the other kinds write positions as they come.
    [[nodiscard]] static std::unique_ptr<MeshWriter> create(const std::filesystem::path& target,
                                                            bool force,
                                                            UpAxis up = UpAxis::Unknown);
    // Completes and publishes the file. Returns its size in bytes.
    virtual uint64_t finish() = 0;

    // Of TriangleSink: a writer drops nothing and is never told of ignored things.
    void dropped(DropReason, uint64_t) override {}
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t) override {}
};

}  // namespace pagoda::ooc
