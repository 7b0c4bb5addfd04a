#include "ooc/codecs/mesh_codec.h"

#include "ooc/base/bytes.h"

#include <cstdint>
#include <cstring>

namespace pagoda::ooc {

std::optional<Codec> meshCodecOf(std::span<const std::byte> page) {
    ByteReader in(page);
    const auto count = in.get<uint32_t>();
    for (uint32_t i = 0; i < count && in.isOk(); ++i) {
        const auto tag = in.getBytes(4);
        const auto codec = in.get<uint32_t>();
        if (in.getBytes(8).empty()) break;  // where the section lies
        if (std::memcmp(tag.data(), "MESH", 4) != 0) continue;
        if (codec > static_cast<uint32_t>(Codec::Draco)) return std::nullopt;
        return static_cast<Codec>(codec);
    }
    return std::nullopt;
}

}  // namespace pagoda::ooc
