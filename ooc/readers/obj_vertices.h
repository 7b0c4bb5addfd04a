// obj_vertices.h: positions, colours and normals of an OBJ file in scratch, for reading in any
// order.
#pragma once

#include "ooc/base/file.h"
#include "ooc/readers/text_scan.h"
#include "ooc/readers/triangle_batcher.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>

namespace pagoda::ooc {

class ObjVertices {
public:
    explicit ObjVertices(const std::filesystem::path& scratchFolder);

    // What follows "v": x y z, maybe w, or r g b (0..1; 0..255 where one is above 1). A coordinate
    // that is missing or no number becomes NaN: the triangles that use it are dropped.
    void addPosition(TextCursor numbers);
    // What follows "vn".
    void addNormal(TextCursor numbers);
    // Notes whether faces use normals; nothing else.
    void lookAtFace(TextCursor corners);
    void finish();

    [[nodiscard]] uint64_t badPositions() const noexcept { return badPositions_; }
    [[nodiscard]] bool hasColours() const noexcept { return colours_ != nullptr; }
    [[nodiscard]] bool hasNormals() const noexcept { return usesNormals_ && normalCount_ > 0; }
    [[nodiscard]] uint64_t positionCount() const noexcept { return positionCount_; }
    [[nodiscard]] uint64_t normalCount() const noexcept { return normalCount_; }

    // Indices from 0, below the counts, after finish().
    [[nodiscard]] Vec3d position(uint64_t index) const { return load<Vec3d>(*positions_, index); }
    [[nodiscard]] uint32_t colour(uint64_t index) const { return load<uint32_t>(*colours_, index); }
    [[nodiscard]] Vec3f normal(uint64_t index) const { return load<Vec3f>(*normals_, index); }

private:
    template <typename Item>
    static Item load(const ScratchArray& array, uint64_t index) {
        Item item;
        std::memcpy(&item, array.bytes().data() + index * sizeof(Item), sizeof item);
        return item;
    }
    void addColour(const Vec3d& colour);

    std::filesystem::path scratchFolder_;
    std::unique_ptr<ScratchArray> positions_, normals_, colours_;
    uint64_t positionCount_ = 0, normalCount_ = 0, badPositions_ = 0;
    uint64_t plainVertices_ = 0;  // before the first with a colour
    bool usesNormals_ = false;
};

}  // namespace pagoda::ooc
