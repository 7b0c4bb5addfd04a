// gltf_reader.h: glTF 2.0 and GLB, through tinygltf.
// Draws the default scene (else scene 0, else all roots): node transforms in double, mirrored nodes
// mended, EXT_mesh_gpu_instancing expanded, Draco and meshopt (EXT, KHR) decoded, sparse and
// quantised accessors, strips and fans, base colours. Textures become corner colours: one sample at
// each corner, so detail inside a triangle is lost. Skins, morph targets and animations are not
// applied; points and lines are not drawn: both are counted by ignored().
//
// Memory: the JSON stays from open to end; during read() the buffers and the largest primitive, all
// under ReaderOptions::memoryBytes, beyond which the file is refused. Each mesh is decoded once and
// then transformed for each node and instance that draws it, so batches come mesh by mesh.
#pragma once

#include "ooc/readers/reader.h"

#include <filesystem>
#include <memory>

namespace pagoda::ooc {

// Reads and checks the JSON; counts what the scene draws. Throws Error for what is not glTF, for a
// broken document (place: a path in the JSON, "meshes[3].primitives[0]"), a node graph that is no
// tree, and more triangles than options.maxTriangles. The reader belongs to one thread.
[[nodiscard]] std::unique_ptr<Reader> openGltfReader(const std::filesystem::path& path,
                                                     const ReaderOptions& options);

}  // namespace pagoda::ooc
