// mesh_codec.h: which codec a page's mesh has, from the table of its sections alone
// (ooc/FORMAT.md): for statistics. Any thread.
#pragma once

#include "ooc/codecs/page_codec.h"

#include <cstddef>
#include <optional>
#include <span>

namespace pagoda::ooc {

// Nothing when there is no mesh section in the table, or one of a codec that is not known.
[[nodiscard]] std::optional<Codec> meshCodecOf(std::span<const std::byte> page);

}  // namespace pagoda::ooc
