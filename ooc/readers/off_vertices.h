// off_vertices.h: vertices of an OFF file in scratch.
#pragma once

#include "ooc/base/file.h"
#include "ooc/readers/text_scan.h"
#include "ooc/readers/triangle_batcher.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>

namespace pagoda::ooc {

// A colour as OFF writes it, to the end of the line: three or four numbers, whole ones 0..255 or
// with a point 0..1. One number is a place in a colour map that no file brings along: no colour.
[[nodiscard]] std::optional<uint32_t> offColour(TextCursor cursor);

class OffVertices {
public:
    OffVertices(const std::filesystem::path& scratchFolder, bool hasColours, bool hasNormals)
        : hasColours_(hasColours),
          hasNormals_(hasNormals),
          scratch_(std::make_unique<ScratchArray>(scratchFolder)) {}

    // One line: x y z, the normal, the colour, as the header has them. False: no three numbers.
    [[nodiscard]] bool add(TextCursor& cursor);
    void finish() { scratch_->seal(); }

    [[nodiscard]] uint64_t count() const noexcept { return count_; }
    [[nodiscard]] Vec3d position(uint64_t index) const { return corner(index).position; }
    [[nodiscard]] Corner corner(uint64_t index) const {
        Corner corner;
        std::memcpy(&corner, scratch_->bytes().data() + index * sizeof corner, sizeof corner);
        return corner;
    }

private:
    bool hasColours_, hasNormals_;
    uint64_t count_ = 0;
    std::unique_ptr<ScratchArray> scratch_;  // of Corner
};

}  // namespace pagoda::ooc
