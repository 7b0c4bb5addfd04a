// page_codec.h: a node's mesh as bytes and back. Bytes: ooc/FORMAT.md.
// A page is a table of tagged sections. Encoding is deterministic; decoding trusts nothing: sizes
// are checked before memory is taken and indices before they are used. All functions are free of
// shared state: call them from any thread.
#pragma once

#include "ooc/page_mesh.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pagoda::ooc {

enum class Codec : uint8_t { Raw = 0, Meshopt = 1, Draco = 2 };
[[nodiscard]] std::string_view codecName(Codec codec);
[[nodiscard]] std::optional<Codec> codecByName(std::string_view name);

struct Page {
    PageMesh mesh;
    std::vector<Zipper> zippers;
};

// `page` may come back in another order of vertices, and of triangles within a run (Draco
// reorders): decodePage(encodePage(p)) holds the same triangles in the same runs and parts, with
// the same corner order up to rotation. `mesh` is valid (asserted).
[[nodiscard]] std::vector<std::byte> encodePage(const Page& page, Codec codec);

struct DecodeResult {
    std::optional<Page> page;
    std::string
        fault;  // why not, when there is no page: "mesh section: index 70000 of 12 vertices"
};
[[nodiscard]] DecodeResult decodePage(std::span<const std::byte> bytes);

}  // namespace pagoda::ooc
