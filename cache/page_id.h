// page_id.h: the name of a page in a cache that several databases share.
#pragma once

#include "ooc/node_id.h"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace pagoda::cache {

struct PageId {
    uint32_t database = 0;  // its place in the scene
    ooc::NodeId node;
    [[nodiscard]] constexpr auto operator<=>(const PageId&) const = default;
};

struct PageIdHash {
    [[nodiscard]] size_t operator()(const PageId& page) const noexcept {
        // Fibonacci hashing: paths differ in their low bits.
        return static_cast<size_t>((page.node.value + (uint64_t{page.database} << 60)) *
                                   0x9E3779B97F4A7C15ull);
    }
};

}  // namespace pagoda::cache
