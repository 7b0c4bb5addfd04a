// corner_welder.h: corners of one batch that agree in every attribute become one vertex.
// Only within the batch, so that memory stays flat: vertices on the border of two batches are
// written twice, bit-equal, and a reader that welds by position closes the mesh again.
#pragma once

#include "ooc/readers/reader.h"

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::ooc {

class CornerWelder {
public:
    // Numbers the vertices in order of first use. O(corners); memory is kept for the next batch.
    void weld(const TriangleBatch& batch);

    // The corner that stands for each vertex.
    [[nodiscard]] std::span<const uint32_t> vertices() const noexcept { return vertices_; }
    // A vertex for each corner.
    [[nodiscard]] std::span<const uint32_t> indices() const noexcept { return indices_; }

private:
    std::vector<uint32_t> vertices_, indices_;
    std::vector<uint32_t> slots_;  // open addressing: vertex + 1, 0 free
};

}  // namespace pagoda::ooc
