#include "ooc/writers/corner_welder.h"

#include <bit>

namespace pagoda::ooc {
namespace {

uint64_t mix(uint64_t hash, uint64_t word) {
    hash = (hash ^ word) * 0x9E3779B97F4A7C15ull;
    return hash ^ (hash >> 29);
}

uint64_t hashCorner(const TriangleBatch& batch, size_t corner) {
    const Vec3d& position = batch.positions[corner];
    uint64_t hash = 0;
    // + 0.0 makes -0 the same as 0.
    for (int axis = 0; axis < 3; ++axis) {
        hash = mix(hash, std::bit_cast<uint64_t>(position[axis] + 0.0));
    }
    if (!batch.colours.empty()) hash = mix(hash, batch.colours[corner]);
    if (!batch.normals.empty()) {
        for (int axis = 0; axis < 3; ++axis) {
            hash = mix(hash, std::bit_cast<uint32_t>(batch.normals[corner][axis] + 0.0f));
        }
    }
    return hash;
}

bool sameCorner(const TriangleBatch& batch, size_t a, size_t b) {
    return batch.positions[a] == batch.positions[b] &&
           (batch.colours.empty() || batch.colours[a] == batch.colours[b]) &&
           (batch.normals.empty() || batch.normals[a] == batch.normals[b]);
}

}  // namespace

void CornerWelder::weld(const TriangleBatch& batch) {
    const size_t cornerCount = batch.positions.size();
    const size_t slotCount = std::bit_ceil(cornerCount * 2 + 1);
    slots_.assign(slotCount, 0);
    vertices_.clear();
    indices_.resize(cornerCount);
    for (size_t corner = 0; corner < cornerCount; ++corner) {
        size_t slot = hashCorner(batch, corner) & (slotCount - 1);
        while (slots_[slot] != 0 && !sameCorner(batch, vertices_[slots_[slot] - 1], corner)) {
            slot = (slot + 1) & (slotCount - 1);
        }
        if (slots_[slot] == 0) {
            vertices_.push_back(static_cast<uint32_t>(corner));
            slots_[slot] = static_cast<uint32_t>(vertices_.size());
        }
        indices_[corner] = slots_[slot] - 1;
    }
}

}  // namespace pagoda::ooc
