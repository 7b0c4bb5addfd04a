// node_id.h: the name of a node: its cell's path from the root and a slot.
// Path: a leading 1, then 3 bits a level (bit 0 x, bit 1 y, bit 2 z: the upper half). Slot 0 is the
// cell's own node, slots 1..15 its extra leaves (triangles too large for its children, or too many
// that coincide). 60 bits of path hold 19 levels below the root with the leading 1.
#pragma once

#include <bit>
#include <compare>
#include <cstdint>

namespace pagoda::ooc {

inline constexpr int kMaxDepth = 19;
inline constexpr uint32_t kMaxExtraLeaves = 15;

struct NodeId {
    uint64_t value = 1u << 4;  // the root

    [[nodiscard]] static constexpr NodeId root() { return {}; }
    [[nodiscard]] constexpr uint64_t path() const { return value >> 4; }
    [[nodiscard]] constexpr uint32_t slot() const { return static_cast<uint32_t>(value & 15u); }
    [[nodiscard]] constexpr int depth() const {
        return static_cast<int>((std::bit_width(path()) - 1) / 3);
    }
    [[nodiscard]] constexpr NodeId cell() const { return {value & ~uint64_t{15}}; }
    [[nodiscard]] constexpr NodeId child(uint32_t octant) const {
        return {((path() << 3) | octant) << 4};
    }
    [[nodiscard]] constexpr NodeId extra(uint32_t slot) const { return {cell().value | slot}; }
    // Of the tree that is drawn: an extra leaf's parent is its cell's own node.
    [[nodiscard]] constexpr NodeId parent() const {
        return slot() != 0 ? cell() : NodeId{(path() >> 3) << 4};
    }
    [[nodiscard]] constexpr uint32_t octant() const { return static_cast<uint32_t>(path() & 7u); }
    [[nodiscard]] constexpr auto operator<=>(const NodeId&) const = default;
};

}  // namespace pagoda::ooc
